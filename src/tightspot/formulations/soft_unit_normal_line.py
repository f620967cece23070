"""The soft forms of the lines with a unit normal: how deep a collision must be if there must be one."""

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
class SoftUnitNormalLine(Formulation):
    """A line with a unit normal that the body may pass by a penetration sigma, which the objective pays for.

    Maths, with n = (cos phi, sin phi), the body's vertices V, the obstacle's O and the demanded clearance d::

        n.O_j <= mu - d/2 for all j      n.V_i >= mu + d/2 - sigma for all i      sigma >= 0

    As n has length 1, ``min_i n.V_i - max_j n.O_j`` is at most the signed distance (minus the penetration depth where
    the two overlap), and the best n attains it: the least sigma is ``max(0, d - signed distance)``, in metres. (With
    ``|n| <= 1`` every overlap could be had for sigma = d, by n = 0.)

    Never infeasible, so a solution says nothing until its penetrations are looked at: use
    :func:`tightspot.planner.minimum_penetration`. Not in the dictionary of members, for the same reason. Unlike
    :class:`SoftSignedDistance`, the stagewise solver takes it.

    Auxiliary variables: phi (rad), mu (m), sigma (m). Rows: N_B + N_O + 1. Holds at the knots only.

    Reference: the paper's (17) with lam = (cos phi, sin phi); the slack is that of X. Zhang, A. Liniger, F. Borrelli,
    Optimization-based collision avoidance, IEEE Transactions on Control Systems Technology 29 (2021), section IV.B.
    """

    name: ClassVar[str] = "soft-unit-normal-line"
    equation: ClassVar[str] = "(17) with a unit normal and a slack"
    holds: ClassVar[Literal["knots", "interval"]] = "knots"
    is_exact: ClassVar[bool] = False
    expresses_margin: ClassVar[bool] = False

    def auxiliary_bounds(self, n_body: int, n_obstacle: int) -> tuple[Array, Array]:
        return free(3)

    def rows(self, auxiliary: Any, pair: Pair) -> Sequence[Rows]:
        return rows_of_soft_line(auxiliary, pair)

    def start(self, poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> Array:
        return start_of_soft_line(poses, body, obstacle)

    def penalty(self, auxiliary: Any) -> Any:
        return auxiliary[2]


@dataclass(frozen=True)
class SoftSweptUnitNormalLine(Formulation):
    """:class:`SoftUnitNormalLine` with one line and one penetration for all poses of an interval.

    Sigma is at least what the demanded clearance exceeds the signed distance by at any of the poses; the obstacle must
    lie on one side of one line with all of them, so it may be more than the deepest of them needs.

    Auxiliary variables: phi (rad), mu (m), sigma (m). Rows: (P + 1) N_B + N_O + 1. Holds on the interval.
    """

    name: ClassVar[str] = "soft-swept-unit-normal-line"
    equation: ClassVar[str] = "unit normal and slack shared by an interval"
    holds: ClassVar[Literal["knots", "interval"]] = "interval"
    is_exact: ClassVar[bool] = False
    expresses_margin: ClassVar[bool] = False

    def auxiliary_bounds(self, n_body: int, n_obstacle: int) -> tuple[Array, Array]:
        return free(3)

    def rows(self, auxiliary: Any, pair: Pair) -> Sequence[Rows]:
        return rows_of_soft_line(auxiliary, pair)

    def start(self, poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> Array:
        return start_of_soft_line(poses, body, obstacle)

    def penalty(self, auxiliary: Any) -> Any:
        return auxiliary[2]


def rows_of_soft_line(auxiliary: Any, pair: Pair) -> list[Rows]:
    """The obstacle's side, then the body's at each pose, then sigma >= 0; (phi, mu, sigma)."""
    normal, offset, sigma = ca.vertcat(ca.cos(auxiliary[0]), ca.sin(auxiliary[0])), auxiliary[1], auxiliary[2]
    base = pair.margins[0] / 2
    body = [
        at_least(pair.body_vertices(index) @ normal - offset - (demand - base) + sigma)
        for index, demand in enumerate(pair.margins)
    ]
    return [at_most(pair.O @ normal - offset + base), *body, at_least(sigma)]


def start_of_soft_line(poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> Array:
    """The best line of the guess; where the two overlap, at the obstacle's edge, and the body's reach beyond."""
    normal, offset = line_of_guess(poses, body, obstacle)
    nearest = np.einsum("mpvi,mi->mpv", transform(body.vertices, poses), normal).min(axis=(1, 2))
    overlap = np.maximum(0.0, 2 * (offset - nearest))
    return np.column_stack([np.arctan2(normal[:, 1], normal[:, 0]), offset + overlap / 2, overlap])
