"""The paper's (16): a gap between two parallel lines, their normal a free vector."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np

from tightspot.formulations.base import Array, Formulation, Pair, Rows, at_least, at_most, free
from tightspot.formulations.lines import line_of_guess
from tightspot.geometry.polygon import ConvexPolygon
from tightspot.geometry.transforms import transform


@dataclass(frozen=True)
class SeparatingGap(Formulation):
    """The body above the line ``lam.q = mu_1``, the obstacle below ``lam.q = mu_2``, and a gap between the lines.

    Maths, for the body's vertices V, the obstacle's O and the demanded clearance d::

        lam.V_i >= mu_1 for all i    lam.O_j <= mu_2 for all j    mu_1 - mu_2 >= d    |lam|^2 <= 1

    As |lam| <= 1, the gap makes the distance at least d, and every distance of at least d leaves room for such a
    gap. At d = 0 the rows hold for lam = 0 whatever the polygons do, so d is at least ``smallest_margin``.

    Auxiliary variables: lam (2), mu_1 (m), mu_2 (m). Rows: N_B + N_O + 2. Holds at the knots only.

    Reference: paper, Proposition 4, eq. (16); NOTES.md, errata 4 and 5 (Table V counts four variables for (17)
    instead).
    """

    name: ClassVar[str] = "separating-gap"
    equation: ClassVar[str] = "paper (16)"
    holds: ClassVar[Literal["knots", "interval"]] = "knots"
    is_exact: ClassVar[bool] = True
    expresses_margin: ClassVar[bool] = True
    smallest_margin: ClassVar[float] = 1e-3

    def auxiliary_bounds(self, n_body: int, n_obstacle: int) -> tuple[Array, Array]:
        return free(4)

    def rows(self, auxiliary: Any, pair: Pair) -> Sequence[Rows]:
        lam, mu_1, mu_2 = auxiliary[:2], auxiliary[2], auxiliary[3]
        return [
            at_least(pair.body_vertices(0) @ lam - mu_1),
            at_most(pair.O @ lam - mu_2),
            at_least(mu_1 - mu_2 - pair.margins[0]),
            Rows(ca.sumsqr(lam), np.array([-np.inf]), np.array([1.0])),
        ]

    def start(self, poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> Array:
        """The widest gap along the normal: its lines touch the body and the obstacle."""
        normal, _ = line_of_guess(poses, body, obstacle)
        nearest = np.einsum("mvi,mi->mv", transform(body.vertices, poses[:, 0]), normal).min(axis=1)
        farthest = (obstacle.vertices @ normal.T).max(axis=0)
        return np.column_stack([normal, nearest, farthest])
