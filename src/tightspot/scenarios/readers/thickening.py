"""What is drawn without area (a point, a line, a flat ring) becomes a polygon with a thickness: never dropped."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from tightspot.scenarios.schema import LARGEST_COORDINATE

Array = NDArray[np.float64]

THICKNESS = 1e-3
"""A ring without area becomes a rectangle this thick, m."""
_THINNEST = 1e-5
_NOTHING = 1e-100
"""GEOS divides by squares of differences, which less than this would make zero."""


def has_area(ring: Array) -> bool:
    """Whether the ring (n, 2) is wider than 0.01 mm; of what is too large to be a place nobody asks."""
    if np.abs(ring).max() > LARGEST_COORDINATE:
        return True
    box = _box(ring)
    return bool(box.geom_type == "Polygon" and _width(box) > _THINNEST)


def thickened_ring(ring: Array) -> Array:
    """The ring (n, 2) m itself, or a rectangle 1 mm thick about it if it has no area to speak of."""
    if has_area(ring):
        return ring
    box = _box(ring)
    spine = box if box.geom_type != "Polygon" else _longest_edge(box)
    if spine.geom_type == "Point":
        return np.asarray(ring[0] + _SQUARE * THICKNESS / 2)
    corners: Array = shapely.get_coordinates(spine.buffer(THICKNESS / 2, cap_style="square"))[:-1]
    return np.asarray(ring[0] + corners)


def thickened_points(points: Array, width: float) -> tuple[Array, ...]:
    """Exterior and holes of a wall along the points (n, 2) m, ``width`` m thick, or of an octagon about a single one.

    The wall reaches half its width beyond both ends; a closed one has a hole. The octagon contains the disc.
    """
    if np.abs(points).max() > LARGEST_COORDINATE:
        return (points,)
    local = points - points[0]
    if (np.abs(local) <= _THINNEST).all():
        angle = np.pi / 8 + np.arange(8) * np.pi / 4
        octagon = np.stack([np.cos(angle), np.sin(angle)], axis=1) * width / 2 / np.cos(np.pi / 8)
        return (points[0] + octagon,)
    wall = shapely.LineString(local).buffer(width / 2, cap_style="square", join_style="mitre", mitre_limit=2)
    return tuple(points[0] + shapely.get_coordinates(ring)[:-1] for ring in (wall.exterior, *wall.interiors))


_SQUARE = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])


def _box(ring: Array) -> shapely.Geometry:
    local = ring - ring[0]
    local[np.abs(local) < _NOTHING] = 0.0
    return shapely.minimum_rotated_rectangle(shapely.MultiPoint(local))


def _edges(box: shapely.Polygon) -> Array:
    corners: Array = shapely.get_coordinates(box)
    return np.diff(corners, axis=0)


def _width(box: shapely.Polygon) -> float:
    return float(np.hypot(*_edges(box).T).min())


def _longest_edge(box: shapely.Polygon) -> shapely.LineString:
    corners = shapely.get_coordinates(box)
    longest = int(np.hypot(*_edges(box).T).argmax())
    return shapely.LineString(corners[longest : longest + 2])
