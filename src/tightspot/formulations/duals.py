"""Multipliers of half-planes: what the dual members share, and their closed-form values from geometry.

For a polygon ``{q: A q <= b}`` and a direction n the support value ``max n.q`` equals ``min b.lam`` over ``lam >= 0``
with ``A^T lam = n`` (linear programming duality). The minimum is attained on the two edges that meet in the vertex
farthest along n, so that it can be written down.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from tightspot.errors import InputError, Problem
from tightspot.formulations.base import Array
from tightspot.formulations.lines import line_of_guess
from tightspot.geometry.polygon import ConvexPolygon
from tightspot.geometry.transforms import rotation, transform

STRICT = 1e-4
"""What stands for "> 0" where multipliers have no scale: small, yet far above a solver's tolerance."""


class Multipliers(NamedTuple):
    """Start values for a batch of pairs.

    Attributes:
        lam: Of the obstacle's half-planes, (M, N_O), ``A^T lam = n``.
        mu: Of the body's half-planes, (M, N_B), ``C^T mu = -n``.
        clearance: ``-b.lam - d.mu``, the signed distance, m, (M,).
    """

    lam: Array
    mu: Array
    clearance: Array


def support_multipliers(polygon: ConvexPolygon, normal: Array) -> Array:
    """``lam >= 0`` with ``A^T lam = n`` and ``b.lam = max n.q``, (M, N), for directions n (M, 2).

    Only the edges i and i+1 that meet in the farthest vertex i have multipliers: n lies in the cone of their normals.
    """
    farthest = (normal @ polygon.vertices.T).argmax(axis=1)
    edges = np.column_stack([farthest, (farthest + 1) % len(polygon.b)])
    values = np.linalg.solve(polygon.A[edges].transpose(0, 2, 1), normal[:, :, None])[:, :, 0]
    multipliers = np.zeros((len(normal), len(polygon.b)))
    np.put_along_axis(multipliers, edges, np.maximum(values, 0.0), axis=1)
    return multipliers


def multipliers_of_guess(poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> Multipliers:
    """The multipliers of the best separating line at the poses (M, 1, 3)."""
    normal, _ = line_of_guess(poses, body, obstacle)
    pose = poses[:, 0]
    in_body_frame = np.einsum("mji,mj->mi", rotation(pose[:, 2]), normal)
    lam, mu = support_multipliers(obstacle, normal), support_multipliers(body, -in_body_frame)
    nearest = np.einsum("mvi,mi->mv", transform(body.vertices, pose), normal).min(axis=1)
    return Multipliers(lam, mu, nearest - (obstacle.vertices @ normal.T).max(axis=0))


def scale_for(clearance: Array) -> Array:
    """Factor that makes ``clearance / 2`` at least :data:`STRICT`; 1 if it is, and for polygons that overlap."""
    apart = np.maximum(clearance, 1e-9)
    return np.where(clearance > 0, np.maximum(1.0, 2 * STRICT / apart), 1.0)


def copies_of(auxiliary: Any, copies: int, n_obstacle: int, n_body: int) -> list[tuple[Any, Any]]:
    """``(lam, mu)`` of each copy; the variables are lam, mu of the first copy, then of the second, and so on."""
    size = n_obstacle + n_body
    parts = [auxiliary[size * copy : size * (copy + 1)] for copy in range(copies)]
    return [(part[:n_obstacle], part[n_obstacle:]) for part in parts]


def check_copies(copies: int) -> None:
    """Raises :class:`InputError` unless there is at least one copy."""
    if copies < 1:
        raise InputError(Problem("formulation.copies", f"{copies} is too few; give 1, or 4 for the paper's variant"))


def length(vector: Any) -> Any:
    """Euclidean norm, smoothed at 0, where it is 1e-4 too large; at length 1 the excess is 5e-9."""
    return ca.sqrt(ca.sumsqr(vector) + 1e-8)
