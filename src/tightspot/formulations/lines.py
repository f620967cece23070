"""The closed-form separating line of a guess, from which every line-like member starts."""

from __future__ import annotations

import numpy as np

from tightspot.formulations.base import Array
from tightspot.geometry.polygon import ConvexPolygon
from tightspot.geometry.separation import best_line
from tightspot.geometry.transforms import transform


def line_of_guess(poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> tuple[Array, Array]:
    """Unit normal (M, 2) and offset (M,) of the line between body and obstacle.

    The normal is the best one at the middle pose, pointing from the obstacle to the body; the offset is midway
    between the obstacle and the body over all poses.

    Args:
        poses: (M, P, 3).
        body: The body part in its own frame.
        obstacle: The obstacle part.
    """
    middle = poses[:, poses.shape[1] // 2]
    normal = best_line(transform(body.vertices, middle), obstacle.vertices).normal
    V = transform(body.vertices, poses)
    nearest = np.einsum("mpvi,mi->mpv", V, normal).min(axis=(1, 2))
    farthest = (obstacle.vertices @ normal.T).max(axis=0)
    return normal, (nearest + farthest) / 2
