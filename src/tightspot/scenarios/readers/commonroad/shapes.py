"""CommonRoad's shapes as rings of points: rectangles, circles, polygons, groups of them."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import shapely
from numpy.typing import NDArray

from tightspot.errors import SceneError
from tightspot.geometry import transform
from tightspot.scenarios.readers.commonroad.xml_tree import Node
from tightspot.scenarios.schema import LARGEST_COORDINATE

Array = NDArray[np.float64]

CIRCLE_TOLERANCE = 0.01
"""A circle becomes a regular polygon around it whose corners are at most this far outside, m."""
MOST_CORNERS = 128
"""... or, if that would take more corners than this, with so many (from a radius of about 33 m on)."""
SAME_PLACE = 1e-6
"""Corners nearer than this are the same, m."""
_DEEPEST_GROUP = 10

KINDS = ("rectangle", "circle", "polygon", "shapeGroup", "absoluteShapeGroup")


def rings(shape: Node, depth: int = 0) -> list[Array]:
    """The rings of a ``shape`` element, in its own coordinates, m, each (n, 2); groups are flattened.

    Raises:
        SceneError: No shape in it, one of another kind, or numbers that are none.
    """
    found = [ring for part in _parts(shape, depth) for ring in _rings_of(part, depth)]
    if not found:
        raise shape.refuse(f"holds no shape; {', '.join(KINDS[:3])} are read")
    return found


def placed(ring: Array, pose: Array) -> Array:
    """The ring of a body at the pose (x m, y m, theta rad); unchanged bit for bit at (0, 0, 0)."""
    return ring if not pose.any() else transform(ring, pose)


def placements(ring: Array, pose: Array) -> list[Array]:
    """Where an obstacle's shape is at a pose: once, or twice if CommonRoad's own programs disagree.

    A shape that is not centred on its origin is turned about the origin by commonroad-io from 2026.1 on, but about its
    own centroid up to 2024.3, on which the drivability checker builds.
    """
    about_origin = placed(ring, pose)
    centre = shapely.get_coordinates(shapely.Polygon(ring).centroid)[0]
    about_centre = placed(ring - centre, np.array([*(centre + pose[:2]), pose[2]]))
    if not pose[2] or np.abs(about_origin - about_centre).max() < SAME_PLACE:
        return [about_origin]
    return [about_origin, about_centre]


def circle_around(centre: Array, radius: float, tolerance: float = CIRCLE_TOLERANCE) -> Array:
    """A regular polygon that contains the circle: its edges touch it, its corners are ``radius / cos(pi / n)`` out.

    ``n`` is the least number, from 8 to 128, that keeps ``radius / cos(pi / n) - radius`` within the tolerance, m.
    """
    n = 8
    while n < MOST_CORNERS and radius * (1 / math.cos(math.pi / n) - 1) > tolerance:
        n += 1
    angles = 2 * np.pi * np.arange(n) / n
    rounding = 16 * np.finfo(float).eps * (np.abs(centre).max() + radius)
    reach = radius / math.cos(math.pi / n) + rounding  # so that the rounded polygon is still outside
    return np.asarray(centre + reach * np.column_stack([np.cos(angles), np.sin(angles)]))


def rectangle(node: Node) -> tuple[Array, float]:
    """A rectangle's corners, counter-clockwise from its rear right, m, (4, 2), and its orientation, rad."""
    half_length, half_width = (_size(node.child(name)) / 2 for name in ("length", "width"))
    turned, shifted = node.find("orientation"), node.find("originXShift")
    orientation = turned.angle() if turned else 0.0
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * [half_length, half_width]
    corners[:, 0] -= _coordinate(shifted) if shifted else 0.0
    return placed(corners, np.array([*centre_of(node), orientation])), orientation


def circle(node: Node) -> tuple[Array, float]:
    """A circle's centre, m, (2,), and radius, m."""
    return centre_of(node), _size(node.child("radius"))


def polygon(node: Node, name: str = "point") -> Array:
    """The points of a polygon or of a lanelet's bound, m, (n, 2)."""
    return np.array([point(child) for child in node.children(name)], dtype=float).reshape(-1, 2)


def point(node: Node) -> tuple[float, float]:
    """x and y of a point, m; a height is not used."""
    return _coordinate(node.child("x")), _coordinate(node.child("y"))


def _coordinate(node: Node) -> float:
    """The text as a number of metres; raises :class:`SceneError` for what is no place on earth, nor in arithmetic."""
    value = node.number()
    if abs(value) > LARGEST_COORDINATE:
        raise node.refuse(f"{value:g} m is more than {LARGEST_COORDINATE:g} m; are these metres?")
    return value


def _size(node: Node) -> float:
    node.positive()
    return _coordinate(node)


def centre_of(node: Node) -> Array:
    """The ``center`` of a shape, m, (2,); the origin if it is not given."""
    centre = node.find("center")
    return np.array(point(centre)) if centre else np.zeros(2)


def _parts(shape: Node, depth: int) -> Iterator[Node]:
    if depth > _DEEPEST_GROUP:
        raise shape.refuse(f"has groups within groups, more than {_DEEPEST_GROUP} deep")
    for child in shape.children():
        if child.tag not in KINDS and child.tag != "shape":
            raise child.refuse(f"is not a shape that is read; write it as one of {', '.join(KINDS[:3])}")
        yield child


def _rings_of(node: Node, depth: int) -> list[Array]:
    if node.tag == "rectangle":
        return [rectangle(node)[0]]
    if node.tag == "circle":
        return [circle_around(*circle(node))]
    if node.tag == "polygon":
        return [_ring(node)]
    return rings(node, depth + 1)


def _ring(node: Node) -> Array:
    ring = polygon(node)
    if len(ring) < 3:
        raise _too_few(node, len(ring))
    return ring


def _too_few(node: Node, count: int) -> SceneError:
    return node.refuse(f"has {count} points; a polygon needs at least 3")
