"""Scenes from drawings: geometries with a role (start, goal, obstacle, boundary), as GeoJSON and WKT files hold them.

A scene's fields without a place in a drawing (vehicle, margin, tolerance, ...) are properties of the whole, or of a
feature. What is drawn as a line is a wall, what is drawn as a point a post; both get a thickness of at least 2 cm.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import Problem, SceneError
from tightspot.problems import join, shortened, shown
from tightspot.scenarios.readers.given import Given, require_ends
from tightspot.scenarios.readers.thickening import has_area, thickened_points, thickened_ring
from tightspot.scenarios.scenario import Scenario
from tightspot.scenarios.schema import MAX_DRAWN

Array = NDArray[np.float64]

ROLES = ("start", "goal", "obstacle", "boundary")
SCENE_FIELDS = ("name", "description", "source", "vehicle", "margin", "tolerance")
"""Fields of a scene that are no geometry: properties of the whole."""
ANYWHERE = ("vehicle", "margin", "tolerance")
"""Those that a feature may say, too."""
STATE_FIELDS = ("theta", "heading", "v", "delta")
MIN_WIDTH = 0.02
"""Walls drawn as lines and posts drawn as points are at least this thick, m."""
_TINY, _LARGEST_LONGITUDE, _LARGEST_LATITUDE = 0.2, 180.0, 90.0


class Count:
    """Counts the points of a drawing while it is read, so that reading ends where it gets too large."""

    def __init__(self) -> None:
        self.points = 0

    def add(self, shape: Shape) -> Shape:
        """The shape itself; raises :class:`SceneError` if there are too many points."""
        self.points += sum(map(len, shape.rings))
        if self.points > MAX_DRAWN:
            raise SceneError(Problem("", f"the drawing has more than {MAX_DRAWN} points; simplify it, or split it"))
        return shape


class Shape(NamedTuple):
    """A simple geometry.

    Attributes:
        kind: What it is.
        rings: Coordinates (n, 2): of a polygon the exterior and the holes without the closing point, else one array.
    """

    kind: Literal["Point", "LineString", "Polygon"]
    rings: tuple[Array, ...]


@dataclass(frozen=True)
class Feature:
    """A geometry with properties.

    Attributes:
        shapes: Its simple geometries, several for a multi-geometry or a collection.
        properties: By lower-case name; what nobody reads is ignored, since drawings carry styles and numbers.
        where: Its place in the file, for messages.
    """

    shapes: tuple[Shape, ...]
    properties: Mapping[str, Any]
    where: str

    @property
    def role(self) -> Any:
        """The property of that name; areas and lines without one are obstacles."""
        role = self.properties.get("role")
        if role is None or role == "":
            return "obstacle" if all(shape.kind != "Point" for shape in self.shapes) else None
        return role.strip().lower() if isinstance(role, str) else role


@dataclass
class _Draft:
    """A scene object that grows, and what is wrong."""

    data: dict[str, Any]
    places: dict[str, str] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)

    def put(self, key: str, value: Any, where: str) -> None:
        """Set a field that may be said once, or more often in the same words."""
        if key in self.places and self.data.get(key) != value:
            sentence = f"{key} is said twice, here and in {self.places[key]}; remove one of them"
            self.problems.append(Problem(where, sentence))
            return
        self.data[key] = value
        self.places[key] = where


def scene_of(
    features: Sequence[Feature], whole: Mapping[str, Any], given: Given, name: str, *, place: str, title: str
) -> Scenario:
    """The scene that a drawing shows.

    Args:
        features: The geometries.
        whole: Fields of the scene that are no geometry.
        given: What the caller says; it goes before the file.
        name: Of the scene if the file says none.
        place: Where ``whole`` stands in the file, for messages.
        title: What a start or goal looks like in this format, for messages; ROLE stands for the one meant.

    Raises:
        SceneError: With all problems, each with its feature.
    """
    refuse_degrees(features)
    draft = _Draft({"obstacles": []})
    for key, value in whole.items():
        draft.put(key, value, place)
    for feature in features:
        _add(draft, feature)
    if draft.problems:
        raise SceneError(shortened(draft.problems))
    data = given.over(draft.data)
    require_ends(data, title)
    try:
        return Scenario.from_dict(data, name=name)
    except SceneError as error:
        raise SceneError([_placed(problem, draft.places) for problem in error.problems]) from None


def refuse_degrees(features: Iterable[Feature]) -> None:
    """Refuse coordinates that are degrees by all appearance: a scene of 20 cm within +-180 and +-90.

    Raises:
        SceneError: They are.
    """
    rings = [ring for feature in features for shape in feature.shapes for ring in shape.rings if len(ring)]
    if not rings:
        return
    points = np.concatenate(rings)
    extent = float(np.ptp(points, axis=0).max()) if len(points) > 1 else math.inf
    within = (np.abs(points) <= (_LARGEST_LONGITUDE, _LARGEST_LATITUDE)).all()
    if within and extent < _TINY and len(rings) > 1:
        sentence = (
            f"all coordinates lie within {extent:.2g}: these look like degrees of longitude and latitude; {PROJECT}"
        )
        raise SceneError(Problem("coordinates", sentence))


PROJECT = "coordinates must be metres: project them, for example to the UTM zone of the place"


def _add(draft: _Draft, feature: Feature) -> None:
    role = feature.role
    for key in ANYWHERE:
        if feature.properties.get(key) is not None:
            draft.put(key, feature.properties[key], feature.where)
    if role in ("start", "goal"):
        state = _state(draft, feature, role)
        if state is not None:
            draft.put(role, state, feature.where)
    elif role == "boundary":
        region = _region(draft, feature)
        if region is not None:
            draft.put("workspace", region, feature.where)
    elif role == "obstacle":
        for shape in feature.shapes:
            draft.places[f"obstacles[{len(draft.data['obstacles'])}]"] = feature.where
            draft.data["obstacles"].append(_obstacle(draft, feature, shape))
    else:
        sentence = f"has the role {shown(role)}" if role is not None else "is a point without a role"
        draft.problems.append(Problem(feature.where, f"{sentence}; it must be one of {', '.join(ROLES)}"))


def _state(draft: _Draft, feature: Feature, role: str) -> dict[str, Any] | None:
    """The state at a point with ``theta``, or at the beginning of a line that points ahead."""
    said = {key: feature.properties[key] for key in STATE_FIELDS if key in feature.properties}
    shape = feature.shapes[0] if len(feature.shapes) == 1 else None
    if shape is None or shape.kind == "Polygon":
        sentence = f"the {role} must be one point with theta, or a line from the rear axle's midpoint straight ahead"
        draft.problems.append(Problem(feature.where, sentence))
        return None
    (x, y), *rest = shape.rings[0].tolist()
    theta = said["theta"] if said.get("theta") is not None else said.get("heading")
    if theta is None and len(rest) == 1 and rest[0] != [x, y]:
        theta = math.atan2(rest[0][1] - y, rest[0][0] - x)
    if theta is None:
        sentence = (
            f"the {role} has no heading; add the property theta in radians"
            if shape.kind == "Point"
            else f"the {role} must be a line of two different points, from the rear axle's midpoint straight ahead"
        )
        draft.problems.append(Problem(feature.where, sentence))
        return None
    return {"x": x, "y": y, "theta": theta, **{key: said[key] for key in ("v", "delta") if key in said}}


def _region(draft: _Draft, feature: Feature) -> Any:
    shape = feature.shapes[0] if len(feature.shapes) == 1 else None
    if shape is None or shape.kind == "Point":
        draft.problems.append(Problem(feature.where, "the boundary must be one polygon"))
        return None
    rings = [ring.tolist() for ring in shape.rings]
    return {"vertices": rings[0], "holes": rings[1:]} if len(rings) > 1 else rings[0]


def _obstacle(draft: _Draft, feature: Feature, shape: Shape) -> dict[str, Any]:
    name = feature.properties.get("name")
    named = {} if name is None or name == "" else {"name": name if isinstance(name, str) else str(name)}
    rings = shape.rings
    if shape.kind != "Polygon":
        rings = thickened_points(rings[0], _width(draft, feature, shape))
    elif not has_area(rings[0]):
        rings = (thickened_ring(rings[0]),)
    return {**named, "vertices": rings[0].tolist(), "holes": [ring.tolist() for ring in rings[1:]]}


def _width(draft: _Draft, feature: Feature, shape: Shape) -> float:
    """The width of a wall, or twice the radius of a post, at least 2 cm."""
    key = "width" if shape.kind == "LineString" or feature.properties.get("radius") is None else "radius"
    value = feature.properties.get(key)
    if value is None:
        return MIN_WIDTH
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value <= 1e3:
        sentence = f"{shown(value)} must be a number of metres between 0 and 1000"
        draft.problems.append(Problem(join(feature.where, key), sentence))
        return MIN_WIDTH
    return max(float(value) * (2 if key == "radius" else 1), MIN_WIDTH)


def _placed(problem: Problem, places: Mapping[str, str]) -> Problem:
    """The problem with the feature's place in front of the scene's."""
    head = next((key for key in sorted(places, key=len, reverse=True) if problem.path.startswith(key)), None)
    return problem if head is None else Problem(f"{places[head]} ({problem.path})", problem.message)
