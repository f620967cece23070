"""The paper's (21), known as OBCA: the dual of the distance, with the body in its own frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np

from tightspot.formulations.base import Array, Formulation, Pair, Rows, at_least, at_most, not_negative, zero
from tightspot.formulations.duals import check_copies, copies_of, multipliers_of_guess
from tightspot.geometry.polygon import ConvexPolygon


@dataclass(frozen=True)
class SignedDistanceDual(Formulation):
    """Multipliers of the obstacle's half-planes A, b and of the body's C0, d0 in the body's frame.

    Maths, with R and T the part's rotation and translation and m the demanded clearance::

        lam, mu >= 0    -d0.mu + (A T - b).lam >= m    C0^T mu + R^T A^T lam = 0    |A^T lam|^2 <= 1

    The same numbers as in (19): mu's half-planes are those of the body, C = C0 R^T, so the left side is that of (19)
    wherever the equation holds; only the derivatives with respect to the pose differ. The rows say "distance >= m".
    At m = 0 they hold for lam = mu = 0 whatever the polygons do, so m is at least ``smallest_margin``. Its soft form
    is :class:`SoftSignedDistance`.

    Auxiliary variables: lam (N_O), mu (N_B), times ``copies``. Rows: 4 a copy. Holds at the knots only.

    Attributes:
        copies: Redundant copies of variables and rows; 4 gives the paper's 32 variables a pair (NOTES.md, "Counts").

    Reference: paper, eq. (21); X. Zhang, A. Liniger, F. Borrelli, Optimization-based collision avoidance, IEEE
    Transactions on Control Systems Technology 29 (2021).
    """

    name: ClassVar[str] = "signed-distance-dual"
    equation: ClassVar[str] = "paper (21)"
    holds: ClassVar[Literal["knots", "interval"]] = "knots"
    is_exact: ClassVar[bool] = True
    expresses_margin: ClassVar[bool] = True
    smallest_margin: ClassVar[float] = 1e-3
    copies: int = 1

    def __post_init__(self) -> None:
        check_copies(self.copies)

    def auxiliary_bounds(self, n_body: int, n_obstacle: int) -> tuple[Array, Array]:
        return not_negative(self.copies * (n_obstacle + n_body))

    def rows(self, auxiliary: Any, pair: Pair) -> Sequence[Rows]:
        rows = []
        for lam, mu in copies_of(auxiliary, self.copies, pair.A.shape[0], len(pair.d0)):
            distance, balance, normal = dual_distance(lam, mu, pair)
            rows += [at_least(distance - pair.margins[0]), zero(balance), at_most(ca.sumsqr(normal), 1.0)]
        return rows

    def start(self, poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> Array:
        lam, mu, _ = multipliers_of_guess(poses, body, obstacle)
        return np.tile(np.hstack([lam, mu]), self.copies)


def dual_distance(lam: Any, mu: Any, pair: Pair) -> tuple[Any, Any, Any]:
    """Of (21): ``-d0.mu + (A T - b).lam`` (m), ``C0^T mu + R^T A^T lam`` (2, 1) and ``A^T lam`` (2, 1)."""
    pose = pair.poses[0]
    c, s = ca.cos(pose.theta), ca.sin(pose.theta)
    normal = pair.A.T @ lam
    turned = ca.vertcat(c * normal[0] + s * normal[1], c * normal[1] - s * normal[0])
    distance = ca.dot(pair.A @ ca.vertcat(pose.x, pose.y) - pair.b, lam) - ca.dot(pair.d0, mu)
    return distance, pair.C0.T @ mu + turned, normal
