"""CommonRoad's goal regions: a pose in the middle, and how far from it still counts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from tightspot.geometry import wrap_angle
from tightspot.scenarios.readers.commonroad.lanelets import Lanelet
from tightspot.scenarios.readers.commonroad.reference import to_rear_axle
from tightspot.scenarios.readers.commonroad.shapes import circle, polygon, rectangle
from tightspot.scenarios.readers.commonroad.xml_tree import Node

Array = NDArray[np.float64]

SMALLEST = 1e-6
"""A tolerance is never less than this, m, rad, m/s: what no planner can be asked for."""
LARGEST = 10.0
"""Nor more than this, m, m/s."""


@dataclass(frozen=True)
class Region:
    """Where the reference point may be at the goal.

    Attributes:
        centre: m, (2,).
        radius: Of the largest circle about the centre inside the region, m.
        heading: The region's own direction, rad, or ``None``.
    """

    centre: Array
    radius: float
    heading: float | None


@dataclass(frozen=True)
class Goal:
    """A goal for our planner.

    Attributes:
        state: (x, y, theta, v, delta) of the rear axle; delta is NaN: free.
        position, heading, speed: Tolerances, m, rad, m/s: a vehicle within them is inside CommonRoad's goal.
        notes: Sentences on what was chosen.
    """

    state: Array
    position: float
    heading: float
    speed: float
    notes: list[str]


def read_goal(node: Node, start: Array, offset: Array, road: Mapping[int, Lanelet], dt: float) -> Goal:
    """The goal in a ``goalState``.

    Args:
        node: The element.
        start: The start's (x, y, theta): its heading is taken where the file gives none.
        offset: The reference point in the rear-axle frame, m, (2,).
        road: Lanelets by id.
        dt: Time step, s.

    Raises:
        SceneError: No position, a region that is none, an interval that ends before it begins.
    """
    region, notes = _region(node, road)
    given = node.find("orientation")
    natural = float(start[2]) if region.heading is None else region.heading
    low, high = _interval(given, angles=True) if given else (natural - math.pi, natural + math.pi)
    half = min((high - low) / 2, math.pi)
    heading = float(wrap_angle((low + high) / 2 if half < math.pi else natural))
    if half >= math.pi:
        notes.append("The goal's orientation is free in the file; a heading was chosen for it.")
    position, turn = _shares(region.radius, half, float(np.hypot(*offset)))
    rear = to_rear_axle(region.centre, np.array(heading), offset)
    v, speed = _speed(node.find("velocity"))
    notes += _times(node.find("time"), dt)
    return Goal(np.array([*rear, heading, v, np.nan]), position, turn, speed, notes)


def _region(node: Node, road: Mapping[int, Lanelet]) -> tuple[Region, list[str]]:
    position = node.find("position")
    shapes = list(position.children()) if position else []
    if not shapes:
        raise node.refuse("has no position; tightspot plans to a place: add a rectangle, circle, polygon or lanelet")
    notes = [f"The goal has {len(shapes)} regions; the first was taken."] if len(shapes) > 1 else []
    return _region_of(shapes[0], road), notes


def _region_of(shape: Node, road: Mapping[int, Lanelet]) -> Region:
    if shape.tag == "point":
        x, y = shape.child("x").number(), shape.child("y").number()
        return Region(np.array([x, y]), SMALLEST, None)
    if shape.tag == "rectangle":
        corners, orientation = rectangle(shape)
        sides = np.hypot(*(corners[1:3] - corners[:2]).T)
        return Region(corners.mean(axis=0), float(sides.min()) / 2, orientation)
    if shape.tag == "circle":
        centre, radius = circle(shape)
        return Region(centre, radius, None)
    if shape.tag == "lanelet":
        return _lanelet(shape, road)
    if shape.tag != "polygon":
        raise shape.refuse("is not a goal region that is read; write a rectangle, circle, polygon or lanelet")
    ring = polygon(shape)
    area = shapely.Polygon(ring) if len(ring) > 2 else shapely.Polygon()
    if not area.is_valid or area.area == 0:
        raise shape.refuse(
            "is no polygon: it needs at least 3 points, an area and a boundary that does not cross itself"
        )
    centre = area.centroid if area.contains(area.centroid) else area.representative_point()
    return Region(shapely.get_coordinates(centre)[0], float(area.exterior.distance(centre)), None)


def _lanelet(shape: Node, road: Mapping[int, Lanelet]) -> Region:
    number = shape.attribute("ref")
    if not number.isdecimal() or int(number) not in road:
        raise shape.refuse(f"refers to lanelet {number[:40]!r}, which is not in the file")
    lanelet = road[int(number)]
    centre, heading = lanelet.middle()
    return Region(centre, float(lanelet.outline.boundary.distance(shapely.Point(centre))), heading)


def _interval(node: Node, *, angles: bool = False) -> tuple[float, float]:
    exact = node.find("exact")
    ends = exact or node.child("intervalStart"), exact or node.child("intervalEnd")
    low, high = (end.angle() if angles else end.number() for end in ends)
    if high < low:
        raise node.refuse(f"ends at {high:g} before it begins at {low:g}")
    return low, high


def _shares(radius: float, half: float, arm: float) -> tuple[float, float]:
    """Tolerances of rear-axle position, m, and heading, rad, that keep the reference point inside the region.

    A heading wrong by h moves the reference point, which is ``arm`` away, by ``2 arm sin(h / 2)``. At most half of the
    radius is spent on that.
    """
    moved = 2 * arm * math.sin(half / 2)
    if moved > radius / 2:
        half, moved = 2 * math.asin(radius / (4 * arm)), radius / 2
    return _within(radius - moved, LARGEST), _within(half, math.pi)


def _speed(node: Node | None) -> tuple[float, float]:
    """The goal's speed and its tolerance, m/s: standing if the file allows it, else the middle of the interval."""
    if node is None:
        return 0.0, 0.01
    low, high = _interval(node)
    v = 0.0 if low <= 0 <= high else (low + high) / 2
    return v, _within(min(v - low, high - v), LARGEST)


def _times(node: Node | None, dt: float) -> list[str]:
    if node is None:
        return []
    low, high = _interval(node)
    when = f"between {low * dt:g} s and {high * dt:g} s"
    return [f"The goal shall be reached {when}; durations are free here, so compare the plan's own."]


def _within(value: float, most: float) -> float:
    return min(max(value, SMALLEST), most)
