"""The paper's (19): Farkas' lemma with bounded multipliers, so that the certificate measures the distance."""

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
class NormalisedFarkasDual(Formulation):
    """Multipliers as in (18), scaled by ``|A^T lam| <= 1``.

    Maths, for the obstacle's half-planes A, b, the body's C = C0 R^T, d = d0 + C T in the world, and the demanded
    clearance m::

        lam, mu >= 0      -b.lam - d.mu >= m      A^T lam + C^T mu = 0      |A^T lam|^2 <= 1

    By duality the largest left side is the distance of disjoint polygons, so the rows say "distance >= m". At m = 0
    they hold for lam = mu = 0 whatever the polygons do, so m is at least ``smallest_margin``.

    Auxiliary variables: lam (N_O), mu (N_B), times ``copies``. Rows: 4 a copy. Holds at the knots only.

    Attributes:
        copies: Redundant copies of variables and rows; 4 gives the paper's 32 variables a pair (NOTES.md, "Counts").

    Reference: paper, eq. (19).
    """

    name: ClassVar[str] = "normalised-farkas-dual"
    equation: ClassVar[str] = "paper (19)"
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
        C, d = pair.body_halfplanes(0)
        rows = []
        for lam, mu in copies_of(auxiliary, self.copies, pair.A.shape[0], len(pair.d0)):
            normal = pair.A.T @ lam
            rows.append(at_least(-ca.dot(pair.b, lam) - ca.dot(d, mu) - pair.margins[0]))
            rows.append(zero(normal + C.T @ mu))
            rows.append(at_most(ca.sumsqr(normal), 1.0))
        return rows

    def start(self, poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> Array:
        lam, mu, _ = multipliers_of_guess(poses, body, obstacle)
        return np.tile(np.hstack([lam, mu]), self.copies)
