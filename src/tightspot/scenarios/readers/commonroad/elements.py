"""The XML elements that we write: numbers exactly, in the order that CommonRoad's schema asks for."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from decimal import Decimal
from typing import Any
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tightspot.geometry import wrap_angle
from tightspot.scenarios.readers.commonroad.reference import to_reference

Array = NDArray[np.float64]
State = Mapping[str, float | None]

LAST_STEP = 100_000
"""The goal's time interval ends after so many steps: durations are free here, CommonRoad wants an end."""


def decimal(value: float) -> str:
    """The shortest decimal text of a double, without an exponent, which XML Schema's decimals do not have.

    >>> decimal(1e-7), float(decimal(1e-7)) == 1e-7
    ('0.0000001', True)
    """
    return format(Decimal(repr(float(value))), "f")


def polygon(parent: Element, ring: ArrayLike) -> None:
    """A polygon with the corners (n, 2), m."""
    points(SubElement(parent, "polygon"), ring)


def points(parent: Element, coordinates: ArrayLike) -> None:
    """Points (n, 2), m."""
    for x, y in np.asarray(coordinates, float).tolist():
        point = SubElement(parent, "point")
        SubElement(point, "x").text, SubElement(point, "y").text = decimal(x), decimal(y)


def static_obstacle(number: int, kind: str, ring: ArrayLike) -> Element:
    """A polygon that stands where it is: its corners are the file's coordinates, its own pose is (0, 0, 0)."""
    obstacle = Element("staticObstacle", id=str(number))
    SubElement(obstacle, "type").text = kind
    polygon(SubElement(obstacle, "shape"), ring)
    state = SubElement(obstacle, "initialState")
    points(SubElement(state, "position"), [[0.0, 0.0]])
    _exact(state, "orientation", decimal(0.0))
    _exact(state, "time", "0")
    return obstacle


def initial_state(state: State, offset: Array) -> Element:
    """A planning problem's initial state for our start; free entries become 0."""
    element = Element("initialState")
    points(SubElement(element, "position"), [_position(state, offset)])
    for name, value in (
        ("velocity", state["v"] or 0.0),
        ("orientation", _heading(state)),
        ("yawRate", 0.0),
        ("slipAngle", 0.0),
    ):
        _exact(element, name, decimal(value))
    _exact(element, "time", "0")
    return element


def goal_state(state: State, tolerance: Mapping[str, float], offset: Array) -> Element:
    """A goal region that holds every state within our tolerances of our goal.

    A circle for the reference point: it moves by at most ``position + 2 |offset| sin(heading / 2)``.
    """
    element = Element("goalState")
    _interval(element, "time", "0", str(LAST_STEP))
    half = tolerance["heading"]
    circle = SubElement(SubElement(element, "position"), "circle")
    radius = tolerance["position"] + 2 * float(np.hypot(*offset)) * math.sin(min(half, math.pi) / 2)
    SubElement(circle, "radius").text = decimal(radius)
    centre, (x, y) = SubElement(circle, "center"), _position(state, offset)
    SubElement(centre, "x").text, SubElement(centre, "y").text = decimal(x), decimal(y)
    if half < math.pi / 2:  # commonroad-io cannot test a wider interval; without one the heading is free
        heading = _heading(state)
        _interval(element, "orientation", decimal(heading - half), decimal(heading + half))
    if state["v"] is not None:
        slack = tolerance["speed"]
        _interval(element, "velocity", decimal(state["v"] - slack), decimal(state["v"] + slack))
    return element


def road(corners: Sequence[Sequence[float]], number: int) -> Element:
    """The workspace, a convex polygon with counter-clockwise corners (n, 2), m, as one lanelet.

    Its right border is the first half of the boundary, its left border the rest backwards. If the number of corners is
    odd, the middle of the last edge is put in: both borders need the same number of points.
    """
    ring = np.asarray(corners, float)
    half = (len(ring) + 1) // 2
    right, left = ring[:half], ring[half:][::-1]
    if len(left) < half:
        left = np.vstack([(ring[-1] + ring[0]) / 2, left])
    lanelet = Element("lanelet", id=str(number))
    points(SubElement(lanelet, "leftBound"), left)
    points(SubElement(lanelet, "rightBound"), right)
    SubElement(lanelet, "laneletType").text = "unknown"
    return lanelet


def same(one: Element, other: Element) -> bool:
    """Whether two elements say the same, apart from blanks, comments and the kind of an obstacle."""
    children = [[child for child in element if isinstance(child.tag, str)] for element in (one, other)]
    return (
        one.tag == other.tag
        and one.get("id") == other.get("id")
        and (one.tag == "type" or (one.text or "").strip() == (other.text or "").strip())
        and len(children[0]) == len(children[1])
        and all(same(a, b) for a, b in zip(*children, strict=True))
    )


def _position(state: State, offset: Array) -> Array:
    return to_reference(np.array([state["x"], state["y"], state["theta"]], float), offset)


def _heading(state: Mapping[str, Any]) -> float:
    return float(wrap_angle(float(state["theta"])))


def _exact(parent: Element, name: str, text: str) -> None:
    SubElement(SubElement(parent, name), "exact").text = text


def _interval(parent: Element, name: str, start: str, end: str) -> None:
    element = SubElement(parent, name)
    SubElement(element, "intervalStart").text, SubElement(element, "intervalEnd").text = start, end
