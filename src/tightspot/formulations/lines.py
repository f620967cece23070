"""The closed-form separating line of a guess, from which every line-like member starts."""

from __future__ import annotations

import numpy as np

from tightspot.formulations.base import Array
from tightspot.geometry.separation import best_line
from tightspot.geometry.transforms import transform


def line_of_guess(poses: Array, V0: Array, O: Array) -> tuple[Array, Array]:
    """Unit normal (M, 2) and offset (M,) of the line between body and obstacle.

    The normal is the best one at the middle pose, pointing from the obstacle to the body; the offset is midway
    between the obstacle and the body over all poses.

    Args:
        poses: (M, P, 3).
        V0: Body-frame vertices, (n_B, 2).
        O: Obstacle vertices, (n_O, 2).
    """
    middle = poses[:, poses.shape[1] // 2]
    normal = best_line(transform(V0, middle), O).normal
    body = transform(V0, poses)
    nearest = np.einsum("mpvi,mi->mpv", body, normal).min(axis=(1, 2))
    farthest = (O @ normal.T).max(axis=0)
    return normal, (nearest + farthest) / 2
