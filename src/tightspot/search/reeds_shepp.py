"""Reeds-Shepp curves: the shortest paths of a car without obstacles.

J. A. Reeds, L. A. Shepp: Optimal paths for a car that goes both forwards and backwards, Pacific Journal of
Mathematics 145(2), 1990.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tightspot.errors import InputError, Problem
from tightspot.search.core import compiled_core
from tightspot.search.path import Path, pose_of

Array = NDArray[np.float64]
_CURVATURE_SIGN = {"L": 1.0, "S": 0.0, "R": -1.0}


@dataclass(frozen=True)
class Segment:
    """A stretch of full left lock, straight wheels or full right lock.

    Attributes:
        kind: ``"L"``, ``"S"`` or ``"R"``.
        length: m, negative when driven in reverse.
    """

    kind: str
    length: float


@dataclass(frozen=True, eq=False)
class ReedsSheppPath:
    """One word of at most five segments that leads from ``start`` to ``goal``.

    Attributes:
        start: Pose, shape (3,).
        goal: Pose, shape (3,).
        radius: Turning radius of the ``L`` and ``R`` segments, m.
        segments: In order of driving; empty if the poses coincide.
    """

    start: Array
    goal: Array
    radius: float
    segments: tuple[Segment, ...]

    @cached_property
    def length(self) -> float:
        """Way driven, m: the sum of the segments' absolute lengths."""
        return float(sum(abs(segment.length) for segment in self.segments))

    @property
    def word(self) -> str:
        """The segments' kinds with ``+`` (forwards) or ``-`` (in reverse), for example ``"L+R-L+"``."""
        return "".join(f"{segment.kind}{'-' if segment.length < 0 else '+'}" for segment in self.segments)

    @property
    def arcs(self) -> Array:
        """Signed length in m and curvature in 1/m of each segment, shape (m, 2)."""
        rows = [(segment.length, _CURVATURE_SIGN[segment.kind] / self.radius) for segment in self.segments]
        return np.array(rows, dtype=float).reshape(-1, 2)

    def sample(self, spacing: float = 0.1) -> Path:
        """Poses at most ``spacing`` m apart, the segments' ends among them."""
        return Path.from_arcs(self.start, self.arcs, spacing, self.goal)


def shortest_path(start: ArrayLike, goal: ArrayLike, radius: float) -> ReedsSheppPath:
    """The shortest path between two poses for a car that turns on circles of ``radius`` m or more.

    Args:
        start: (x m, y m, theta rad).
        goal: (x m, y m, theta rad).
        radius: Smallest turning radius, m.

    Raises:
        InputError: A pose is not three finite numbers, or the radius is not positive.

    >>> shortest_path((0, 0, 0), (3, 0, 0), radius=5.0).word
    'S+'
    """
    start, goal, radius = _checked(start, goal, radius)
    return _path(start, goal, radius, *compiled_core().reeds_shepp_shortest(start, goal, radius))


def all_paths(start: ArrayLike, goal: ArrayLike, radius: float) -> tuple[ReedsSheppPath, ...]:
    """Every Reeds-Shepp word that joins the two poses, shortest first, each once.

    Arguments and errors as for :func:`shortest_path`.
    """
    start, goal, radius = _checked(start, goal, radius)
    words = compiled_core().reeds_shepp_all(start, goal, radius)
    return tuple(_path(start, goal, radius, kinds, lengths) for kinds, lengths in words)


def _checked(start: ArrayLike, goal: ArrayLike, radius: float) -> tuple[Array, Array, float]:
    if not (np.isfinite(radius) and radius > 0):
        raise InputError(Problem("radius", f"{radius} m is not a turning radius; give a positive, finite length"))
    return pose_of(start, "start"), pose_of(goal, "goal"), float(radius)


def _path(start: Array, goal: Array, radius: float, kinds: str, lengths: Array) -> ReedsSheppPath:
    segments = tuple(Segment(kind, float(length)) for kind, length in zip(kinds, lengths, strict=True))
    return ReedsSheppPath(start, goal, radius, segments)
