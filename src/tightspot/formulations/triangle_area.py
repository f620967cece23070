"""Vertices outside, told by the areas of triangles. Necessary, not sufficient."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np

from tightspot.formulations.base import Array, Formulation, Pair, Rows, at_least, free
from tightspot.geometry.polygon import ConvexPolygon


@dataclass(frozen=True)
class TriangleArea(Formulation):
    """A point is outside a convex polygon if its triangles with the edges have more area than the polygon.

    Maths, for a vertex q of one polygon, the edges (p_e, p_e+1) of the other, its area S and its longest edge l, and
    the demanded clearance m::

        (sum_e |area(q, p_e, p_e+1)| - S) / l >= m

    The left side is 0 inside; outside it is the sum of ``l_e h_e / l`` over the edges that q is beyond, l_e their
    lengths and h_e the heights of q over them. Beyond one edge only, the row says ``h_e >= m l / l_e``: the distance m
    for the longest edge, more than that for others; beyond two edges it may be less. At m = 0 it holds everywhere, so
    m is at least ``smallest_margin``.

    Necessary only: the rows accept two crossing bars, as (14) does. And nonsmooth: the absolute values have a kink
    where q passes the line through an edge, and inside the gradient is zero, so that a guess with a vertex inside an
    obstacle gives a solver no direction to leave. A reference, not a choice.

    Auxiliary variables: none. Rows: N_B + N_O. Holds at the knots only.

    Reference: B. Li, Z. Shao, A unified motion planning method for parking an autonomous vehicle in the presence of
    irregularly placed obstacles, Knowledge-Based Systems 86 (2015).
    """

    name: ClassVar[str] = "triangle-area"
    equation: ClassVar[str] = "triangle-area criterion"
    holds: ClassVar[Literal["knots", "interval"]] = "knots"
    is_exact: ClassVar[bool] = False
    expresses_margin: ClassVar[bool] = False
    smallest_margin: ClassVar[float] = 1e-3

    def auxiliary_bounds(self, n_body: int, n_obstacle: int) -> tuple[Array, Array]:
        return free(0)

    def rows(self, auxiliary: Any, pair: Pair) -> Sequence[Rows]:
        m = pair.margins[0]
        body = ca.SX(pair.V0)
        return [
            at_least(_excess(pair.obstacle_in_body_frame(0), body) - m),
            at_least(_excess(pair.body_vertices(0), pair.O) - m),
        ]

    def start(self, poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> Array:
        return np.zeros((len(poses), 0))


def _excess(points: Any, corners: Any) -> Any:
    """Area by which the triangles exceed the polygon, over its longest edge, m; one for each point."""
    following = ca.vertcat(corners[1:, :], corners[0, :])
    edges = following - corners
    longest = ca.mmax(ca.sqrt(edges[:, 0] ** 2 + edges[:, 1] ** 2))
    twice_area = ca.sum1(corners[:, 0] * following[:, 1] - corners[:, 1] * following[:, 0])
    values = []
    for index in range(points.shape[0]):
        x, y = points[index, 0] - corners[:, 0], points[index, 1] - corners[:, 1]
        values.append((ca.sum1(ca.fabs(edges[:, 0] * y - edges[:, 1] * x)) - twice_area) / (2 * longest))
    return ca.vertcat(*values)
