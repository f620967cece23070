"""The paper's (18): a certificate of disjointness by Farkas' lemma."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np

from tightspot.formulations.base import Array, Formulation, Pair, Rows, at_least, not_negative, zero
from tightspot.formulations.duals import (
    STRICT,
    check_copies,
    copies_of,
    length,
    multipliers_of_guess,
    scale_for,
)
from tightspot.geometry.polygon import ConvexPolygon


@dataclass(frozen=True)
class FarkasDual(Formulation):
    """Multipliers that prove that ``A q <= b`` and ``C q <= d`` have no common point.

    Maths, for the obstacle's half-planes A, b, the body's C = C0 R^T, d = d0 + C T in the world, and the demanded
    clearance m::

        lam, mu >= 0      -b.lam - d.mu - m |A^T lam| >= eps      A^T lam + C^T mu = 0

    Multipliers have no scale here: with m = 0 any eps > 0 says "disjoint" and none says how far (NOTES.md,
    erratum 3), so that the paper's d_safe in the place of eps is vacuous as a distance. The term ``m |A^T lam|``,
    the support function of a disc of radius m, has the same scale as the others; with it the rows say that the
    obstacle grown by m is disjoint from the body: "distance > m" exactly. The distance m itself is approached as the
    multipliers grow, and not attained: the optimum has no finite multipliers, which is why this member is slower
    than :class:`NormalisedFarkasDual`.

    Auxiliary variables: lam (N_O), mu (N_B), times ``copies``. Rows: 3 a copy. Holds at the knots only.

    Attributes:
        copies: Redundant copies of variables and rows; 4 gives the paper's 32 variables a pair (NOTES.md, "Counts").

    Reference: paper, eq. (18).
    """

    name: ClassVar[str] = "farkas-dual"
    equation: ClassVar[str] = "paper (18)"
    holds: ClassVar[Literal["knots", "interval"]] = "knots"
    is_exact: ClassVar[bool] = True
    expresses_margin: ClassVar[bool] = True
    copies: int = 1

    def __post_init__(self) -> None:
        check_copies(self.copies)

    def auxiliary_bounds(self, n_body: int, n_obstacle: int) -> tuple[Array, Array]:
        return not_negative(self.copies * (n_obstacle + n_body))

    def rows(self, auxiliary: Any, pair: Pair) -> Sequence[Rows]:
        C, d = pair.body_halfplanes(0)
        rows = []
        for lam, mu in copies_of(auxiliary, self.copies, pair.A.shape[0], len(pair.d0)):
            normal = pair.A.T @ lam
            rows.append(at_least(-ca.dot(pair.b, lam) - ca.dot(d, mu) - pair.margins[0] * length(normal), STRICT))
            rows.append(zero(normal + C.T @ mu))
        return rows

    def start(self, poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> Array:
        lam, mu, clearance = multipliers_of_guess(poses, body, obstacle)
        return np.tile(np.hstack([lam, mu]) * scale_for(clearance)[:, None], self.copies)
