"""What rings from a file enclose: valid polygons, or a sentence that says where the rings go wrong."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from tightspot.errors import GeometryError, Problem
from tightspot.geometry.rings import DoublesBackError, as_points, clean_ring, distinct
from tightspot.geometry.windings import edges, enclosed

Array = NDArray[np.float64]

THICKNESS = 1e-3
"""Where a boundary runs back along itself it stands for a wall without thickness, which gets this one, m."""
_SLACK = 1e-3  # m, and no more than 1e-4 of the extent: what overlaps by less is taken to touch


def solid_polygons(exterior: ArrayLike, holes: Sequence[ArrayLike] = (), name: str = "") -> list[shapely.Polygon]:
    """The valid polygons that an exterior ring and holes bound: one, unless the exterior touches itself.

    Where rings are simple, the polygon has their vertices without the repeated and collinear ones. Rings may also
    touch themselves, see :mod:`tightspot.geometry.windings`; what is drawn as a line, because the boundary runs
    back along itself, becomes 1 mm thick.

    Args:
        exterior: Shape (n, 2), m, any winding, open or closed.
        holes: The same for each hole. Holes may touch each other or the exterior in single points.
        name: What the polygon is called in messages.

    Raises:
        GeometryError: Not finite, fewer than three distinct vertices or zero area, a boundary that crosses
            itself, a hole that reaches outside, holes that overlap or cut the polygon into pieces.
    """
    names = [name, *(f"{name}.holes[{j}]".lstrip(".") for j in range(len(holes)))]
    rings = _distinct_rings([exterior, *holes], names)
    if not all(shapely.LinearRing(ring).is_simple for ring in rings):
        return _untangled(rings, names)
    try:
        shell, *inner = (clean_ring(ring, path).vertices for ring, path in zip(rings, names, strict=True))
    except DoublesBackError:
        return _untangled(rings, names)
    _check_inside(shapely.Polygon(shell), [shapely.Polygon(ring) for ring in inner], names[1:])
    polygon = shapely.Polygon(shell, inner)
    if not polygon.is_valid:
        sentence = (
            f"holes share an edge or cut the polygon into pieces{_where(polygon)}; "
            "holes may touch only in single points and must leave the rest connected"
        )
        raise GeometryError(Problem(name, sentence))
    return [polygon]


def polygons_in(geometry: shapely.Geometry) -> list[shapely.Polygon]:
    """The polygons among a geometry's parts, points and lines left out."""
    return [part for part in shapely.get_parts(geometry) if part.geom_type == "Polygon"]


def _distinct_rings(rings: Sequence[ArrayLike], names: Sequence[str]) -> list[Array]:
    found: list[Array] = []
    problems: list[Problem] = []
    for ring, path in zip(rings, names, strict=True):
        try:
            points = as_points(ring, path)
            found.append(points[distinct(points, path)])
        except GeometryError as error:
            problems += error.problems
    if problems:
        raise GeometryError(problems)
    return found


def _untangled(rings: list[Array], names: Sequence[str]) -> list[shapely.Polygon]:
    """What rings that touch themselves bound; refuses those that cross themselves."""
    slack = min(_SLACK, 1e-4 * float(np.ptp(rings[0], axis=0).max()))
    inside = [enclosed(ring, slack) for ring in rings]
    problems = [
        Problem(
            path, f"the boundary crosses itself{_where(shapely.Polygon(ring))}; list the corners once around, in order"
        )
        for ring, pieces, path in zip(rings, inside, names, strict=True)
        if not pieces
    ]
    if problems:
        raise GeometryError(problems)
    solid, *hollow = (shapely.union_all(pieces) for pieces in inside)
    _check_inside(solid, hollow, names[1:])
    rest = solid.difference(shapely.union_all(hollow))
    lines = shapely.union_all(np.concatenate([edges(ring) for ring in rings]))
    walls = lines.difference(rest.buffer(slack / 4))
    thick = walls.buffer(min(THICKNESS / 2, slack), cap_style="square", join_style="mitre")
    return polygons_in(rest.union(thick) if not walls.is_empty else rest)


def _check_inside(solid: shapely.Geometry, hollow: list[shapely.Geometry], names: Sequence[str]) -> None:
    """Refuse holes that reach outside or overlap."""
    problems = []
    for j, hole in enumerate(hollow):
        if not solid.covers(hole):
            problems.append(Problem(names[j], "the hole reaches outside the exterior; move it inside"))
        for k in range(j):
            if hole.intersection(hollow[k]).area > 0:
                problems.append(Problem(names[j], f"the hole overlaps {names[k]}; make one hole of the two"))
    if problems:
        raise GeometryError(problems)


def _where(polygon: shapely.Polygon) -> str:
    """The place that shapely names in its reason for an invalid polygon."""
    match = re.search(r"\[(\S+) (\S+)\]", shapely.is_valid_reason(polygon))
    return f" at ({float(match[1]):g}, {float(match[2]):g})" if match else ""
