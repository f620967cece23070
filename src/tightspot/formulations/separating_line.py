"""The paper's (17): one separating line, its normal a free vector."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np

from tightspot.formulations.base import Array, Formulation, Pair, Rows, at_least, at_most, free
from tightspot.formulations.lines import line_of_guess
from tightspot.geometry.polygon import ConvexPolygon


@dataclass(frozen=True)
class SeparatingLine(Formulation):
    """Line ``{q: lam.q = mu}`` with the body above and the obstacle below, at the knots.

    Maths, for the body's vertices V, the obstacle's O and the demanded clearance d::

        lam.V_i >= mu + d/2 for all i      lam.O_j <= mu - d/2 for all j      |lam|^2 <= 1

    As |lam| <= 1, the gap d between the two sides makes the distance at least d, and no lower bound of |lam| is
    needed (NOTES.md, erratum 4). At d = 0 the rows hold for lam = 0 whatever the polygons do, so d is at least
    ``smallest_margin``.

    Auxiliary variables: lam (2), mu (m). Rows: N_B + N_O + 1. Holds at the knots only.

    Reference: paper, Proposition 5, eq. (17); Table V counts three variables (its columns are swapped).
    """

    name: ClassVar[str] = "separating-line"
    equation: ClassVar[str] = "paper (17)"
    holds: ClassVar[Literal["knots", "interval"]] = "knots"
    is_exact: ClassVar[bool] = True
    expresses_margin: ClassVar[bool] = True
    smallest_margin: ClassVar[float] = 1e-3

    def auxiliary_bounds(self, n_body: int, n_obstacle: int) -> tuple[Array, Array]:
        return free(3)

    def rows(self, auxiliary: Any, pair: Pair) -> Sequence[Rows]:
        lam, mu = auxiliary[:2], auxiliary[2]
        half = pair.margins[0] / 2
        return [
            at_least(pair.body_vertices(0) @ lam - mu - half),
            at_most(pair.O @ lam - mu + half),
            Rows(ca.sumsqr(lam), np.array([-np.inf]), np.array([1.0])),
        ]

    def start(self, poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> Array:
        normal, offset = line_of_guess(poses, body, obstacle)
        return np.column_stack([normal, offset])
