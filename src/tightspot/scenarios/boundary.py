"""The region that the body must not leave, if it is not convex: its hull is W, the rest of the hull is obstacles."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from tightspot.errors import GeometryError, Problem
from tightspot.geometry import ConvexPolygon, clean_ring, convex_parts, covers, solid_polygons
from tightspot.geometry.solids import polygons_in
from tightspot.scenarios.filed import in_file, read_only
from tightspot.scenarios.solids import TOLERANCE, Member

Array = NDArray[np.float64]

NAME = "boundary"
MOST_SIDES = 24
"""A hull with more sides than this is replaced by the box around it."""


@dataclass(frozen=True, eq=False)
class Boundary:
    """A simple polygon, with holes or without, inside of which the body must stay.

    Attributes:
        exterior: Corners as they were given, m, shape (n, 2), read-only.
        holes: Rings inside that are *not* free, each (m, 2), read-only.
        originals: Exterior and holes in the file's coordinates if these differ, else empty.

    Raises:
        GeometryError: The polygon is none, or touches itself: then nobody can say whether a cut is a wall.
    """

    exterior: Array
    holes: tuple[Array, ...] = ()
    originals: tuple[Array, ...] = field(default=(), repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "exterior", read_only(self.exterior))
        for key in ("holes", "originals"):
            object.__setattr__(self, key, tuple(map(read_only, getattr(self, key))))
        _refuse_touching(self.rings)
        solid_polygons(self.exterior, self.holes)

    @property
    def rings(self) -> tuple[Array, ...]:
        """The exterior, then the holes."""
        return (self.exterior, *self.holes)

    @cached_property
    def polygon(self) -> shapely.Polygon:
        """What the body may use."""
        return solid_polygons(self.exterior, self.holes)[0]

    def workspace(self) -> ConvexPolygon:
        """W: the hull, or the box around it if it has more than 24 sides."""
        hull = covers.hull(self.exterior)
        if len(hull.vertices) <= MOST_SIDES:
            return hull
        (x_min, y_min), (x_max, y_max) = self.exterior.min(axis=0), self.exterior.max(axis=0)
        return ConvexPolygon.rectangle(x_min, x_max, y_min, y_max)

    def outside(self) -> Member | None:
        """What of W is not inside the boundary, in convex parts; ``None`` if that is nothing."""
        rest = polygons_in(shapely.Polygon(self.workspace().vertices).difference(self.polygon))
        if not rest:
            return None
        return Member(NAME, tuple(part for piece in rest for part in _parts(piece)), tuple(rest))

    def shifted(self, shift: ArrayLike) -> Boundary:
        """The boundary with ``shift`` (m, m) added to all its points."""
        step = np.asarray(shift, dtype=float)
        return Boundary(self.exterior + step, tuple(hole + step for hole in self.holes), self.originals)

    def to_data(self, offset: ArrayLike = (0.0, 0.0)) -> Any:
        """The scene file's ``workspace``: a list of corners, or an object with ``vertices`` and ``holes``."""
        originals = self.originals or (None,) * len(self.rings)
        exterior, *holes = (in_file(r, offset, o).tolist() for r, o in zip(self.rings, originals, strict=True))
        return {"vertices": exterior, "holes": holes} if holes else exterior


def _refuse_touching(rings: tuple[Array, ...]) -> None:
    for j, ring in enumerate(rings):
        path = f"holes[{j - 1}]" if j else ""
        if not shapely.LinearRing(clean_ring(ring, path).vertices).is_simple:
            sentence = (
                "the boundary crosses or touches itself; list its corners once around, and what is cut out as holes"
            )
            raise GeometryError(Problem(path, sentence))


def _parts(piece: shapely.Polygon) -> tuple[ConvexPolygon, ...]:
    """Convex parts of what lies outside; what is as thin as rounding is thickened first."""
    corners = shapely.get_coordinates(piece)
    try:
        parts = convex_parts([piece])
    except GeometryError:
        parts = convex_parts(polygons_in(piece.buffer(TOLERANCE / 8, join_style="mitre", mitre_limit=2)))
    return tuple(covers.reaching(parts, corners))
