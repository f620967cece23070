"""WKT geometries as simple shapes. Nesting is bounded before the text is parsed, since parsers recurse."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np
import shapely

from tightspot.problems import shown
from tightspot.scenarios.readers.features import Shape

MAX_DEPTH = 16
_KINDS = "POINT|LINESTRING|LINEARRING|POLYGON|MULTIPOINT|MULTILINESTRING|MULTIPOLYGON|GEOMETRYCOLLECTION"
GEOMETRY = re.compile(rf"(?:{_KINDS})(?:\s*(?:ZM|Z|M))?\s*(?:\(|EMPTY\b)", re.IGNORECASE)
"""What every geometry begins with."""


def shapes_in(text: str) -> Iterator[Shape]:
    """The simple geometries in a WKT text; raises ``ValueError`` with a sentence."""
    if _depth(text) > MAX_DEPTH:
        raise ValueError(f"the geometry is nested more than {MAX_DEPTH} levels deep")
    try:
        with np.errstate(all="ignore"):
            geometry = shapely.from_wkt(text)
    except (shapely.errors.GEOSException, ValueError, TypeError) as error:
        raise ValueError(_sentence(text, str(error))) from None
    yield from _simple(shapely.force_2d(geometry))


def _simple(geometry: shapely.Geometry) -> Iterator[Shape]:
    kind = geometry.geom_type
    if geometry.is_empty:
        return
    if not np.isfinite(shapely.get_coordinates(geometry)).all():
        raise ValueError("a coordinate is not a finite number")
    if kind == "Polygon":
        rings = (geometry.exterior, *geometry.interiors)
        yield Shape("Polygon", tuple(shapely.get_coordinates(ring)[:-1] for ring in rings))
    elif kind == "Point":
        yield Shape("Point", (shapely.get_coordinates(geometry),))
    elif kind in ("LineString", "LinearRing"):
        yield Shape("LineString", (shapely.get_coordinates(geometry),))
    else:
        for part in geometry.geoms:
            yield from _simple(part)


def _depth(text: str) -> int:
    deepest = depth = 0
    for bracket in re.findall(r"[()]", text):
        depth += 1 if bracket == "(" else -1
        deepest = max(deepest, depth)
    return deepest


def _sentence(text: str, reason: str) -> str:
    """What is wrong with a geometry, in our words."""
    if "closed linestring" in reason:
        return "a ring is not closed; repeat its first point at the end"
    if "number of points" in reason.lower() or "size" in reason:
        return "a ring or line has too few points: a ring needs three corners and the first one again, a line two"
    words = reason.removeprefix("ParseException: ").strip()
    return f"{shown(text)} is not readable as WKT: {words[:100]}"
