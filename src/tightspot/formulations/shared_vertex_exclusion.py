"""The paper's (14) with one column of multipliers for all vertices, which makes it exact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np

from tightspot.formulations.base import Array, Formulation, Pair, Rows, not_negative
from tightspot.formulations.duals import multipliers_of_guess, scale_for
from tightspot.formulations.vertex_exclusion import outside
from tightspot.geometry.polygon import ConvexPolygon


@dataclass(frozen=True)
class SharedVertexExclusion(Formulation):
    """One vector of multipliers for the obstacle's vertices, one for the body's: Table V's size of (14).

    Maths, for the body's vertices V_i and half-planes C = C0 R^T, d = d0 + C T in the world, the obstacle's O_j and
    A, b, and the demanded clearance m::

        w, z >= 0    (C O_j - d).w - m |C^T w| >= eps for all j    (A V_i - b).z - m |A^T z| >= eps for all i

    ``C^T w`` is the normal of a line that has the whole body on one side (``C^T w . q <= d.w`` there) and all of the
    obstacle's vertices on the other, so either half of the rows alone separates the polygons, and the rows can be
    satisfied exactly when the distance is larger than m. That the two halves say the same is the price of the name:
    :class:`FarkasDual` says it once.

    Auxiliary variables: w (N_B), z (N_O). Rows: N_B + N_O. Holds at the knots only.

    Reference: paper, eq. (14) with equal columns; Table V.
    """

    name: ClassVar[str] = "shared-vertex-exclusion"
    equation: ClassVar[str] = "paper (14), equal columns"
    holds: ClassVar[Literal["knots", "interval"]] = "knots"
    is_exact: ClassVar[bool] = True
    expresses_margin: ClassVar[bool] = True

    def auxiliary_bounds(self, n_body: int, n_obstacle: int) -> tuple[Array, Array]:
        return not_negative(n_body + n_obstacle)

    def rows(self, auxiliary: Any, pair: Pair) -> Sequence[Rows]:
        n_body, n_obstacle = len(pair.d0), pair.A.shape[0]
        C, d = pair.body_halfplanes(0)
        w = ca.repmat(auxiliary[:n_body], 1, n_obstacle)
        z = ca.repmat(auxiliary[n_body:], 1, n_body)
        return [
            outside(pair.O, C, d, w, pair.margins[0]),
            outside(pair.body_vertices(0), pair.A, pair.b, z, pair.margins[0]),
        ]

    def start(self, poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> Array:
        lam, mu, clearance = multipliers_of_guess(poses, body, obstacle)
        return np.hstack([mu, lam]) * scale_for(clearance)[:, None]
