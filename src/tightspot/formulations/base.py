"""What a formulation of "these two convex polygons do not meet" must say of itself.

A member never sees the horizon. It declares auxiliary variables and rows for one pair (body part, obstacle part)
at one knot or on one interval, and a closed-form start for its variables from the guess's geometry.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from tightspot.geometry.polygon import ConvexPolygon

Array = NDArray[np.float64]


class Pose(NamedTuple):
    """A frame's pose as CasADi expressions: x, y in m, theta in rad."""

    x: Any
    y: Any
    theta: Any


class Rows(NamedTuple):
    """``lower <= expression <= upper``; ``expression`` is a CasADi column, the bounds have its length."""

    expression: Any
    lower: Array
    upper: Array


@dataclass(frozen=True)
class Pair:
    """One body part against one obstacle part, as symbols.

    Attributes:
        poses: The part's poses: one for members that hold at knots; two or more in time order, the first and the
            last at the interval's ends, for members that hold on the interval.
        V0: Body-frame vertices, (n_B, 2) numbers.
        C0: Body-frame half-planes ``C0 q <= d0``, (n_B, 2) numbers.
        d0: (n_B,) numbers.
        O: Obstacle vertices, (n_O, 2) symbols.
        A: Obstacle half-planes ``A q <= b`` with unit rows, (n_O, 2) symbols.
        b: (n_O, 1) symbols.
        margins: Demanded clearance at each pose, m, one expression a pose.
    """

    poses: tuple[Pose, ...]
    V0: Array
    C0: Array
    d0: Array
    O: Any
    A: Any
    b: Any
    margins: tuple[Any, ...]

    def body_vertices(self, index: int) -> Any:
        """World vertices of the part at pose ``index``, (n_B, 2) expression: V0 R^T + T^T."""
        pose = self.poses[index]
        c, s = ca.cos(pose.theta), ca.sin(pose.theta)
        x = self.V0[:, 0] * c - self.V0[:, 1] * s + pose.x
        y = self.V0[:, 0] * s + self.V0[:, 1] * c + pose.y
        return ca.horzcat(x, y)

    def body_halfplanes(self, index: int) -> tuple[Any, Any]:
        """World half-planes ``C q <= d`` of the part at pose ``index``: C = C0 R^T (n_B, 2), d = d0 + C T (n_B, 1)."""
        pose = self.poses[index]
        c, s = ca.cos(pose.theta), ca.sin(pose.theta)
        C = ca.horzcat(self.C0[:, 0] * c - self.C0[:, 1] * s, self.C0[:, 0] * s + self.C0[:, 1] * c)
        return C, self.d0 + C @ ca.vertcat(pose.x, pose.y)

    def obstacle_in_body_frame(self, index: int) -> Any:
        """Obstacle vertices as the part sees them at pose ``index``, (n_O, 2) expression: (O - T^T) R."""
        pose = self.poses[index]
        c, s = ca.cos(pose.theta), ca.sin(pose.theta)
        dx, dy = self.O[:, 0] - pose.x, self.O[:, 1] - pose.y
        return ca.horzcat(dx * c + dy * s, dy * c - dx * s)


class Formulation(ABC):
    """One way to write separation.

    Class attributes:
        name: Used at the edges (command line, files, tables).
        equation: The paper's equation, or where it comes from.
        holds: ``"knots"`` or ``"interval"``: where in time a feasible point promises separation.
        is_exact: True if the rows are satisfiable exactly when the polygons are disjoint.
        expresses_margin: True if the rows say "distance >= margin", no more and no less.
        smallest_margin: Margins below this are raised to it, because the rows would be satisfied vacuously, m.
    """

    name: ClassVar[str]
    equation: ClassVar[str]
    holds: ClassVar[Literal["knots", "interval"]]
    is_exact: ClassVar[bool]
    expresses_margin: ClassVar[bool]
    smallest_margin: ClassVar[float] = 0.0

    @abstractmethod
    def auxiliary_bounds(self, n_body: int, n_obstacle: int) -> tuple[Array, Array]:
        """Bounds of the pair's auxiliary variables, two arrays (n_aux,); their length is the number of variables.

        Args:
            n_body: N_B, the body part's number of edges.
            n_obstacle: N_O, the obstacle part's number of edges.
        """

    @abstractmethod
    def rows(self, auxiliary: Any, pair: Pair) -> Sequence[Rows]:
        """The rows for one pair; ``auxiliary`` is a CasADi column of the declared length."""

    @abstractmethod
    def start(self, poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> Array:
        """Closed-form starting values from the best separating line of the guess.

        Args:
            poses: The guess's poses, (M, P, 3): M pairs in a batch, P poses each.
            body: The body part in its own frame.
            obstacle: The obstacle part.

        Returns:
            Starting values, (M, n_aux).
        """

    def penalty(self, auxiliary: Any) -> Any:
        """What the pair adds to the objective, integrated over time and weighted; 0 but for soft members.

        Args:
            auxiliary: The pair's auxiliary variables, a CasADi column of the declared length.
        """
        return 0.0


def free(count: int) -> tuple[Array, Array]:
    """Bounds of ``count`` free variables."""
    return np.full(count, -np.inf), np.full(count, np.inf)


def not_negative(count: int) -> tuple[Array, Array]:
    """Bounds of ``count`` multipliers: at least 0."""
    return np.zeros(count), np.full(count, np.inf)


def at_least(expression: Any, bound: float = 0.0) -> Rows:
    """``expression >= bound`` entry by entry."""
    count = expression.numel()
    return Rows(ca.vec(expression), np.full(count, bound), np.full(count, np.inf))


def at_most(expression: Any, bound: float = 0.0) -> Rows:
    """``expression <= bound`` entry by entry."""
    count = expression.numel()
    return Rows(ca.vec(expression), np.full(count, -np.inf), np.full(count, bound))


def zero(expression: Any) -> Rows:
    """``expression = 0`` entry by entry."""
    nothing = np.zeros(expression.numel())
    return Rows(ca.vec(expression), nothing, nothing)
