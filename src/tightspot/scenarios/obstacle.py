"""Obstacles: named polygons, convex or not, with the convex parts that planning and judging work on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tightspot.errors import GeometryError, Problem
from tightspot.geometry import ConvexPolygon, decompose

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Obstacle:
    """A polygon with holes that the vehicle must not touch.

    Attributes:
        name: Unique in its scenario.
        exterior: Corners as they were given (any winding, open or closed), m, shape (n, 2), read-only.
        holes: Rings inside that are free, each (m, 2), read-only.
        parts: Convex parts whose union is the polygon; no corner is invented.

    Raises:
        GeometryError: The polygon is none; paths start with ``vertices`` or ``holes[j]``.

    >>> len(Obstacle("L", [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]).parts)
    2
    """

    name: str
    exterior: Array
    holes: tuple[Array, ...] = ()
    parts: tuple[ConvexPolygon, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        try:
            parts = decompose(self.exterior, self.holes)
        except GeometryError as error:
            raise GeometryError([_in_file(problem) for problem in error.problems]) from None
        object.__setattr__(self, "parts", parts)
        object.__setattr__(self, "exterior", _ring(self.exterior))
        object.__setattr__(self, "holes", tuple(_ring(hole) for hole in self.holes))

    def shifted(self, shift: ArrayLike) -> Obstacle:
        """The obstacle with ``shift`` (m, m) added to all its points."""
        step = np.asarray(shift, dtype=float)
        return Obstacle(self.name, self.exterior + step, tuple(hole + step for hole in self.holes))

    def to_dict(self, offset: ArrayLike = (0.0, 0.0)) -> dict[str, Any]:
        """The scene file's obstacle, with ``offset`` (m, m) added to all its points."""
        step = np.asarray(offset, dtype=float)
        data: dict[str, Any] = {"name": self.name, "vertices": (self.exterior + step).tolist()}
        if self.holes:
            data["holes"] = [(hole + step).tolist() for hole in self.holes]
        return data


def unique_names(names: Sequence[str | None]) -> list[str]:
    """Different names: ``None`` becomes ``obstacle-<index>``, a second ``car`` becomes ``car-2``."""
    taken: set[str] = set()
    counts: dict[str, int] = {}
    unique = []
    for index, name in enumerate(names):
        wanted = name or f"obstacle-{index}"
        candidate = wanted
        while candidate in taken:
            counts[wanted] = counts.get(wanted, 1) + 1
            candidate = f"{wanted}-{counts[wanted]}"
        taken.add(candidate)
        unique.append(candidate)
    return unique


def _ring(points: ArrayLike) -> Array:
    ring = np.array(points, dtype=float)
    ring.setflags(write=False)
    return ring


def _in_file(problem: Problem) -> Problem:
    path = problem.path
    return problem if path.startswith("holes") else Problem(f"vertices{path}", problem.message)
