"""Obstacles: named polygons, convex or not, with the convex parts that they are cut into."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from tightspot.errors import GeometryError, Problem
from tightspot.geometry import ConvexPolygon, convex_parts, solid_polygons
from tightspot.scenarios.filed import in_file, read_only

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Obstacle:
    """A polygon with holes that the vehicle must not touch.

    Attributes:
        name: Unique in its scenario.
        exterior: Corners as they were given (any winding, open or closed), m, shape (n, 2), read-only.
        holes: Rings inside that are free, each (m, 2), read-only.
        originals: Exterior and holes in the file's coordinates if these differ, else empty.
        parts: Convex parts whose union is the polygon; no corner is invented.
        is_plain: Whether the exterior is convex and clean: it is the one part's ring, and there are no holes.

    Raises:
        GeometryError: The polygon is none; paths start with ``vertices`` or ``holes[j]``.

    >>> len(Obstacle("L", [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]).parts)
    2
    """

    name: str
    exterior: Array
    holes: tuple[Array, ...] = ()
    originals: tuple[Array, ...] = field(default=(), repr=False)
    parts: tuple[ConvexPolygon, ...] = field(init=False, repr=False)
    is_plain: bool = field(init=False, repr=False)

    def __post_init__(self) -> None:
        convex = None if self.holes else ConvexPolygon.if_obvious(self.exterior)
        object.__setattr__(self, "is_plain", convex is not None)
        if convex is not None:
            object.__setattr__(self, "parts", (convex,))
        else:
            self._decompose()
        object.__setattr__(self, "exterior", read_only(self.exterior))
        for key in ("holes", "originals"):
            object.__setattr__(self, key, tuple(map(read_only, getattr(self, key))))

    def _decompose(self) -> None:
        try:
            polygons = tuple(solid_polygons(self.exterior, self.holes))
            parts = convex_parts(polygons)
        except GeometryError as error:
            raise GeometryError([_in_file(problem) for problem in error.problems]) from None
        self.__dict__["polygons"] = polygons
        object.__setattr__(self, "parts", parts)

    @cached_property
    def polygons(self) -> tuple[shapely.Polygon, ...]:
        """What the rings bound, for shapely: valid, one unless the exterior touches itself."""
        return tuple(part.to_shapely() for part in self.parts)  # one convex one; others were kept when it was cut

    @property
    def rings(self) -> tuple[Array, ...]:
        """The exterior, then the holes, as they were given."""
        return (self.exterior, *self.holes)

    def shifted(self, shift: ArrayLike) -> Obstacle:
        """The obstacle with ``shift`` (m, m) added to all its points."""
        step = np.asarray(shift, dtype=float)
        return Obstacle(self.name, self.exterior + step, tuple(hole + step for hole in self.holes), self.originals)

    def rings_in_file(self, offset: ArrayLike = (0.0, 0.0)) -> list[list[list[float]]]:
        """Exterior and holes as lists of points, with ``offset`` (m, m) added, bit for bit as they were read."""
        originals = self.originals or (None,) * len(self.rings)
        rings = zip(self.rings, originals, strict=True)
        return [in_file(ring, offset, original).tolist() for ring, original in rings]

    def to_dict(self, offset: ArrayLike = (0.0, 0.0)) -> dict[str, Any]:
        """The scene file's obstacle, with ``offset`` (m, m) added to all its points."""
        exterior, *holes = self.rings_in_file(offset)
        return {"name": self.name, "vertices": exterior} | ({"holes": holes} if holes else {})


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


def _in_file(problem: Problem) -> Problem:
    path = problem.path
    return problem if path.startswith("holes") else Problem(f"vertices{path}", problem.message)
