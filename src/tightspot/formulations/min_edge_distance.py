"""No auxiliary variable: the best of the edges' own separating lines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np

from tightspot.formulations.base import Array, Formulation, Pair, Rows, at_least, free
from tightspot.geometry.polygon import ConvexPolygon


@dataclass(frozen=True)
class MinEdgeDistance(Formulation):
    """The largest, over all edges of both polygons, of how far the other polygon lies beyond the edge.

    Maths, for the body's vertices V_i and half-planes C, d in the world, the obstacle's O_j and A, b, and the
    demanded clearance m::

        max( max_e min_i (A_e.V_i - b_e),  max_e min_j (C_e.O_j - d_e) ) >= m

    By the separating axis theorem the left side is positive exactly for disjoint polygons. It is the distance where
    an edge takes part in it and less than that where two vertices are nearest, so the row says "distance >= m" or
    more: up to a factor of sqrt(2) between right angles.

    The row has kinks wherever another edge or vertex takes over. Newton-type solvers assume there are none; often
    they get away with it, sometimes they stall. A reference for that, not a choice.

    Auxiliary variables: none. Rows: 1. Holds at the knots only.

    Reference: S. Gottschalk, M. Lin, D. Manocha, OBBTree, SIGGRAPH 1996 (the separating axis theorem for polytopes).
    """

    name: ClassVar[str] = "min-edge-distance"
    equation: ClassVar[str] = "separating axis theorem"
    holds: ClassVar[Literal["knots", "interval"]] = "knots"
    is_exact: ClassVar[bool] = True
    expresses_margin: ClassVar[bool] = False

    def auxiliary_bounds(self, n_body: int, n_obstacle: int) -> tuple[Array, Array]:
        return free(0)

    def rows(self, auxiliary: Any, pair: Pair) -> Sequence[Rows]:
        of_obstacle = _beyond(pair.A, pair.b, pair.body_vertices(0))
        of_body = _beyond(ca.SX(pair.C0), ca.SX(pair.d0), pair.obstacle_in_body_frame(0))
        return [at_least(ca.mmax(ca.vertcat(*of_obstacle, *of_body)) - pair.margins[0])]

    def start(self, poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> Array:
        return np.zeros((len(poses), 0))


def _beyond(A: Any, b: Any, points: Any) -> list[Any]:
    """``min_i A_e.q_i - b_e`` for each edge e."""
    return [ca.mmin(points @ A[edge, :].T) - b[edge] for edge in range(A.shape[0])]
