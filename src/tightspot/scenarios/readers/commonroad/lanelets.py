"""CommonRoad's lanelets: the road as polygons, and what is beside it as obstacles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
import shapely
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem, SceneError
from tightspot.scenarios.readers.commonroad.shapes import polygon
from tightspot.scenarios.readers.commonroad.xml_tree import Node

Array = NDArray[np.float64]

Lanelets = Literal["ignore", "boundary"]
"""Whether the vehicle may leave the road."""
LANELETS: tuple[Lanelets, ...] = get_args(Lanelets)

GAP = 0.02
"""Gaps between lanelets narrower than this belong to the road, m: neighbours rarely share their border exactly."""
THINNEST = 1e-6
"""What is beside the road but nowhere twice as wide as this is rounding, m."""
MOST_POINTS = 3_000
"""Of the borders of all lanelets near start and goal, if they shall be a boundary."""
MOST_CROSSINGS = 10_000
"""Of these borders with each other and themselves."""
REACH = 50.0
"""Of a road network only what is this near to start or goal is used, m."""


@dataclass(frozen=True)
class Lanelet:
    """A piece of road between two borders with the same number of points, m, each (n, 2), in driving direction."""

    left: Array
    right: Array

    @property
    def outline(self) -> shapely.Polygon:
        """Its area; may cross itself if the borders do."""
        return shapely.Polygon(np.vstack([self.right, self.left[::-1]]))

    def middle(self) -> tuple[Array, float]:
        """The point half way along the centre line, m, (2,), and the heading there, rad."""
        centre = shapely.LineString((self.left + self.right) / 2)
        here, ahead, behind = (
            shapely.get_coordinates(shapely.line_interpolate_point(centre, share, normalized=True))[0]
            for share in (0.5, 0.51, 0.49)
        )
        return here, float(np.arctan2(*(ahead - behind)[::-1]))


def checked_lanelets(lanelets: str) -> Lanelets:
    """The policy if there is such a one; raises :class:`InputError` with those there are."""
    for known in LANELETS:
        if lanelets == known:
            return known
    raise InputError(Problem("lanelets", f"{lanelets!r} is not known; it is {' or '.join(LANELETS)}"))


def read_lanelet(node: Node) -> Lanelet:
    """One lanelet; raises :class:`SceneError` if its borders are none."""
    left, right = (polygon(node.child(name)) for name in ("leftBound", "rightBound"))
    if len(left) != len(right) or len(left) < 2:
        raise node.refuse(f"has borders of {len(left)} and {len(right)} points; both need the same number, at least 2")
    return Lanelet(left, right)


def beside_the_road(road: list[Lanelet], ends: Array) -> tuple[Array, list[tuple[Array, list[Array]]]]:
    """The box around the road near start and goal, and the polygons in it that are not road.

    Args:
        road: All lanelets.
        ends: Positions of start and goal, m, (2, 2).

    Returns:
        ``[[x_min, y_min], [x_max, y_max]]`` and (exterior, holes) of each polygon, m.

    Raises:
        SceneError: There are too many border points, or a long lanelet crosses itself.
    """
    low, high = ends.min(axis=0) - REACH, ends.max(axis=0) + REACH
    reach = shapely.box(*low, *high)
    area = shapely.union_all(_outlines([lanelet for lanelet in road if lanelet.outline.envelope.intersects(reach)]))
    # Mitred, so that straight borders come back where they were.
    closed = area.buffer(GAP / 2, join_style="mitre").buffer(-GAP / 2, join_style="mitre")
    near = closed.intersection(reach)
    box = near.envelope if near.area > 0 else reach
    parts = shapely.get_parts(box.difference(near))
    beside = parts[~shapely.is_empty(shapely.buffer(parts, -THINNEST))]
    bounds = np.array(box.bounds).reshape(2, 2)
    return bounds, [(_ring(part.exterior), [_ring(hole) for hole in part.interiors]) for part in beside]


def _outlines(road: list[Lanelet]) -> list[shapely.Geometry]:
    count = sum(2 * len(lanelet.left) for lanelet in road)
    if count > MOST_POINTS:
        sentence = f"have {count} border points near start and goal; at most {MOST_POINTS} are read as a boundary"
        raise SceneError(Problem("lanelet", f"{sentence}; thin them out, or do not ask for it"))
    crossings = _crossings(road)
    if crossings > MOST_CROSSINGS:
        sentence = f"cross each other or themselves at some {crossings} places; at most {MOST_CROSSINGS} are mended"
        raise SceneError(Problem("lanelet", f"{sentence}: repair the borders, or do not ask for a boundary"))
    return [shapely.make_valid(lanelet.outline) for lanelet in road]


def _crossings(road: list[Lanelet]) -> int:
    """How often border segments touch or cross others than their neighbours."""
    rings = [shapely.get_coordinates(lanelet.outline) for lanelet in road]
    segments = [shapely.linestrings(np.stack([ring[:-1], ring[1:]], axis=1)) for ring in rings]
    lines = np.concatenate(segments) if segments else np.array([])
    pairs = shapely.STRtree(lines).query(lines, predicate="intersects").shape[1] if len(lines) else 0
    return max(0, pairs - 3 * len(lines)) // 2


def _ring(ring: shapely.LinearRing) -> Array:
    return np.asarray(shapely.get_coordinates(ring)[:-1])
