"""One separating line for a whole interval: separation between the samples, not only at them."""

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
class SweptLine(Formulation):
    """One line with unit normal ``n = (cos phi, sin phi)`` and offset mu shared by all poses of an interval.

    Maths, for the poses tau_0 < ... < tau_P that cover the interval, V(tau) the body's vertices and d(tau) the
    demanded clearance at a pose::

        n.O_j <= mu - d(tau_0)/2 for all j        n.V_i(tau_p) >= mu + d(tau_p) - d(tau_0)/2 for all i, p

    Why it holds between the poses: for a body point p(t) the function ``f(t) = n.p(t)`` has ``|f''| <= P``, the
    body's largest acceleration, so between two poses h apart f is above its chord minus ``P h^2 / 8``. The caller
    puts that cover into d(tau) at the poses (see :mod:`tightspot.transcription`), and the clearance is then at
    least the demanded one on the whole interval.

    Auxiliary variables: phi (rad), mu (m). Rows: (P + 1) N_B + N_O.
    """

    name: ClassVar[str] = "swept-line"
    equation: ClassVar[str] = "(17) shared by an interval"
    holds: ClassVar[Literal["knots", "interval"]] = "interval"
    is_exact: ClassVar[bool] = True
    expresses_margin: ClassVar[bool] = True

    def auxiliary_bounds(self, n_body: int, n_obstacle: int) -> tuple[Array, Array]:
        return free(2)

    def rows(self, auxiliary: Any, pair: Pair) -> Sequence[Rows]:
        normal = ca.vertcat(ca.cos(auxiliary[0]), ca.sin(auxiliary[0]))
        mu, base = auxiliary[1], pair.margins[0] / 2
        rows = [at_most(pair.O @ normal - mu + base)]
        for index in range(len(pair.poses)):
            rows.append(at_least(pair.body_vertices(index) @ normal - mu - (pair.margins[index] - base)))
        return rows

    def start(self, poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> Array:
        normal, offset = line_of_guess(poses, body, obstacle)
        return np.column_stack([np.arctan2(normal[:, 1], normal[:, 0]), offset])
