"""The soft form of (21): how deep a collision must be if there must be one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np

from tightspot.formulations.base import Array, Formulation, Pair, Rows, at_least, not_negative, zero
from tightspot.formulations.duals import multipliers_of_guess
from tightspot.formulations.signed_distance_dual import dual_distance
from tightspot.geometry.polygon import ConvexPolygon


@dataclass(frozen=True)
class SoftSignedDistance(Formulation):
    """The rows of (21) with a slack s, which the objective pays for.

    Maths, with R and T the part's rotation and translation and m the demanded clearance::

        lam, mu, s >= 0    -d0.mu + (A T - b).lam >= m - s    C0^T mu + R^T A^T lam = 0    |A^T lam|^2 = 1

    With a unit normal the largest left side is the signed distance, minus the penetration depth where the polygons
    overlap, so the least s is ``max(0, m - signed distance)``. (With ``<= 1``, as for separation, lam = mu = 0 would
    make every overlap cost m.) The penalty is s, in metres.

    Never infeasible, so a solution says nothing until its slacks are looked at: use
    :func:`tightspot.planner.minimum_penetration`. Not in the dictionary of members, for the same reason.

    Auxiliary variables: lam (N_O), mu (N_B), s (m). Rows: 4. Holds at the knots only.

    Reference: paper, eq. (21); X. Zhang, A. Liniger, F. Borrelli, Optimization-based collision avoidance, IEEE
    Transactions on Control Systems Technology 29 (2021), Proposition 4 and eq. (18).
    """

    name: ClassVar[str] = "soft-signed-distance"
    equation: ClassVar[str] = "paper (21) with a slack"
    holds: ClassVar[Literal["knots", "interval"]] = "knots"
    is_exact: ClassVar[bool] = False
    expresses_margin: ClassVar[bool] = False

    def auxiliary_bounds(self, n_body: int, n_obstacle: int) -> tuple[Array, Array]:
        return not_negative(n_obstacle + n_body + 1)

    def rows(self, auxiliary: Any, pair: Pair) -> Sequence[Rows]:
        n_obstacle = pair.A.shape[0]
        lam, mu, slack = auxiliary[:n_obstacle], auxiliary[n_obstacle:-1], auxiliary[-1]
        distance, balance, normal = dual_distance(lam, mu, pair)
        return [at_least(distance - pair.margins[0] + slack), zero(balance), zero(ca.sumsqr(normal) - 1.0)]

    def start(self, poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> Array:
        lam, mu, clearance = multipliers_of_guess(poses, body, obstacle)
        return np.column_stack([lam, mu, np.maximum(0.0, -clearance)])

    def penalty(self, auxiliary: Any) -> Any:
        return auxiliary[-1]
