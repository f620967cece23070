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
    """One line ``{q: lam.q = mu}`` shared by all poses of an interval.

    Maths, for the poses tau_0 < ... < tau_P that cover the interval, V(tau) the body's vertices and d(tau) the
    demanded clearance at a pose::

        lam.O_j <= mu - d(tau_0)/2              for all j
        lam.V_i(tau_p) >= mu + d(tau_p) - d(tau_0)/2    for all i, p           |lam|^2 <= 1

    Why it holds between the poses: for a body point p(t) the function ``f(t) = lam.p(t)`` has ``|f''| <= P``, the
    body's largest acceleration, so between two poses h apart f is above its chord minus ``P h^2 / 8``. The caller
    puts that cover into d(tau) at the poses (see :mod:`tightspot.transcription`), and the clearance is then at
    least the demanded one on the whole interval. As |lam| <= 1, the gap between the two sides is at most the
    distance. The proof is in docs/formulations/swept-line.md.

    Auxiliary variables: lam (2), mu (m). Rows: (P + 1) N_B + N_O + 1. Holds on the interval.

    Reference: the line is the paper's (17); that one line serves a whole interval is this project's.
    """

    name: ClassVar[str] = "swept-line"
    equation: ClassVar[str] = "(17) shared by an interval"
    holds: ClassVar[Literal["knots", "interval"]] = "interval"
    is_exact: ClassVar[bool] = True
    expresses_margin: ClassVar[bool] = True
    smallest_margin: ClassVar[float] = 1e-3

    def auxiliary_bounds(self, n_body: int, n_obstacle: int) -> tuple[Array, Array]:
        return free(3)

    def rows(self, auxiliary: Any, pair: Pair) -> Sequence[Rows]:
        lam, mu = auxiliary[:2], auxiliary[2]
        unit = Rows(ca.sumsqr(lam), np.array([-np.inf]), np.array([1.0]))
        return [*rows_of_line(lam, mu, pair), unit]

    def start(self, poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> Array:
        normal, offset = line_of_guess(poses, body, obstacle)
        return np.column_stack([normal, offset])


@dataclass(frozen=True)
class SweptUnitNormalLine(Formulation):
    """:class:`SweptLine` with a unit normal ``n = (cos phi, sin phi)`` in place of ``|lam| <= 1``.

    The same set of motions with one variable and one row fewer, for solvers that cannot cope with a normal whose
    length is free where the pair is far apart (fatrop, the stagewise solver). IPOPT needs a few iterations more.

    Auxiliary variables: phi (rad), mu (m). Rows: (P + 1) N_B + N_O. Holds on the interval.
    """

    name: ClassVar[str] = "swept-unit-normal-line"
    equation: ClassVar[str] = "unit normal shared by an interval"
    holds: ClassVar[Literal["knots", "interval"]] = "interval"
    is_exact: ClassVar[bool] = True
    expresses_margin: ClassVar[bool] = True

    def auxiliary_bounds(self, n_body: int, n_obstacle: int) -> tuple[Array, Array]:
        return free(2)

    def rows(self, auxiliary: Any, pair: Pair) -> Sequence[Rows]:
        return rows_of_line(ca.vertcat(ca.cos(auxiliary[0]), ca.sin(auxiliary[0])), auxiliary[1], pair)

    def start(self, poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> Array:
        normal, offset = line_of_guess(poses, body, obstacle)
        return np.column_stack([np.arctan2(normal[:, 1], normal[:, 0]), offset])


def rows_of_line(normal: Any, offset: Any, pair: Pair) -> list[Rows]:
    """The obstacle's side, then the body's at each pose; half the first pose's demand lies on either side."""
    base = pair.margins[0] / 2
    body = [
        at_least(pair.body_vertices(index) @ normal - offset - (demand - base))
        for index, demand in enumerate(pair.margins)
    ]
    return [at_most(pair.O @ normal - offset + base), *body]
