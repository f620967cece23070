"""The paper's (14): no vertex of one polygon inside the other. Necessary, not sufficient."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np

from tightspot.formulations.base import Array, Formulation, Pair, Rows, at_least, not_negative
from tightspot.formulations.duals import STRICT, length, scale_for, support_multipliers
from tightspot.geometry.polygon import ConvexPolygon
from tightspot.geometry.separation import best_line
from tightspot.geometry.transforms import rotation, transform


@dataclass(frozen=True)
class VertexExclusion(Formulation):
    """Multipliers of its own for every vertex, which prove that it is outside the other polygon.

    Maths, for the body's vertices V_i and half-planes C = C0 R^T, d = d0 + C T in the world, the obstacle's O_j and
    A, b, the columns Lambda_j and Omega_i, and the demanded clearance m::

        Lambda, Omega >= 0    (C O_j - d).Lambda_j - m |C^T Lambda_j| >= eps    for all j
                              (A V_i - b).Omega_i - m |A^T Omega_i| >= eps      for all i

    One row a vertex is what the proof needs and what the paper counts (NOTES.md, erratum 2). The multipliers have no
    scale, so eps > 0 is any number, and the term with m makes the vertices' distance larger than m.

    **Two crossing bars overlap with no vertex of either inside the other**, so the paper's Proposition 2 is wrong in
    one direction (NOTES.md, erratum 1): a plan needs the judge, as always. With one column for all vertices it is
    right: :class:`SharedVertexExclusion`.

    Auxiliary variables: Lambda (N_B x N_O), Omega (N_O x N_B), column by column. Rows: N_B + N_O. Holds at the knots
    only.

    Reference: paper, Proposition 2, eq. (14).
    """

    name: ClassVar[str] = "vertex-exclusion"
    equation: ClassVar[str] = "paper (14)"
    holds: ClassVar[Literal["knots", "interval"]] = "knots"
    is_exact: ClassVar[bool] = False
    expresses_margin: ClassVar[bool] = False

    def auxiliary_bounds(self, n_body: int, n_obstacle: int) -> tuple[Array, Array]:
        return not_negative(2 * n_body * n_obstacle)

    def rows(self, auxiliary: Any, pair: Pair) -> Sequence[Rows]:
        n_body, n_obstacle = len(pair.d0), pair.A.shape[0]
        size = n_body * n_obstacle
        Lambda = ca.reshape(auxiliary[:size], n_body, n_obstacle)
        Omega = ca.reshape(auxiliary[size:], n_obstacle, n_body)
        C, d = pair.body_halfplanes(0)
        return [
            outside(pair.O, C, d, Lambda, pair.margins[0]),
            outside(pair.body_vertices(0), pair.A, pair.b, Omega, pair.margins[0]),
        ]

    def start(self, poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> Array:
        """For every vertex the direction of its own signed distance from the other polygon."""
        pose = poses[:, 0]
        V, R = transform(body.vertices, pose), rotation(pose[:, 2])
        columns = []
        for corner in obstacle.vertices:
            normal, _, clearance = best_line(np.stack([corner, corner]), V)
            normal = np.einsum("mji,mj->mi", R, normal)
            columns.append(support_multipliers(body, normal) * scale_for(clearance)[:, None])
        for index in range(V.shape[1]):
            normal, _, clearance = best_line(V[:, [index, index]], obstacle.vertices)
            columns.append(support_multipliers(obstacle, normal) * scale_for(clearance)[:, None])
        return np.hstack(columns)


def outside(points: Any, A: Any, b: Any, multipliers: Any, margin: Any) -> Rows:
    """``(A q - b).w - margin |A^T w| >= eps`` for each point q (a row of ``points``) and its column w."""
    values = []
    for index in range(points.shape[0]):
        w = multipliers[:, index]
        values.append(ca.dot(A @ points[index, :].T - b, w) - margin * length(A.T @ w))
    return at_least(ca.vertcat(*values), STRICT)
