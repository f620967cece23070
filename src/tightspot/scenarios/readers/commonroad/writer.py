"""From a scene to a CommonRoad scenario file (2020a) that CommonRoad's own programs read."""

from __future__ import annotations

import datetime
from pathlib import Path
from typing import Any, Literal, get_args
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import numpy as np
import shapely
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem
from tightspot.files import atomic_write
from tightspot.scenarios.obstacle import Obstacle
from tightspot.scenarios.readers.commonroad import elements, remainder
from tightspot.scenarios.readers.commonroad.origin import Origin
from tightspot.scenarios.readers.commonroad.reference import Reference, checked_reference, reference_offset
from tightspot.scenarios.scenario import Scenario

Array = NDArray[np.float64]

ObstacleType = Literal["unknown", "parkedVehicle", "constructionZone", "roadBoundary"]
"""What CommonRoad's schema lets a static obstacle be."""
OBSTACLE_TYPES: tuple[ObstacleType, ...] = get_args(ObstacleType)
_ROUNDING = 1e-6


def write_commonroad(
    scenario: Scenario,
    path: str | Path,
    *,
    reference: Reference = "centre",
    obstacle_type: ObstacleType = "unknown",
    dt: float | None = None,
    date: datetime.date | None = None,
) -> None:
    """Write the scene as a CommonRoad scenario; :func:`read_commonroad` gives it back exactly.

    Each obstacle becomes a static obstacle with a polygon, one with holes several with its convex parts; the workspace
    becomes a lanelet, so that it is a road that must not be left (what a nonconvex one lacks of its hull becomes static
    obstacles, too); start and goal become a planning problem. What CommonRoad cannot hold is kept in a comment.

    Args:
        scenario: The scene.
        path: Where to.
        reference: What the positions of start and goal in the file shall be of.
        obstacle_type: CommonRoad's type of all obstacles.
        dt: The time step, s; default: that of the CommonRoad file which the scene comes from, else 0.1 s.
        date: The file's date; default: today.

    Raises:
        InputError: An argument that is not one of those above.
        OSError: The file cannot be written; an old one is then unchanged.
    """
    atomic_write(path, to_xml(scenario, reference, obstacle_type, dt, date))


def to_xml(
    scenario: Scenario,
    reference: Reference = "centre",
    obstacle_type: ObstacleType = "unknown",
    dt: float | None = None,
    date: datetime.date | None = None,
) -> str:
    """The text of :func:`write_commonroad`."""
    reference = checked_reference(reference)
    if obstacle_type not in OBSTACLE_TYPES:
        raise InputError(Problem("obstacle_type", f"{obstacle_type!r} must be one of {', '.join(OBSTACLE_TYPES)}"))
    origin = Origin.of(scenario.source, scenario.name)
    step = origin.dt if dt is None else dt
    if not (np.isfinite(step) and step > 0):
        raise InputError(Problem("dt", f"{step} s must be a time above 0"))
    data = scenario.to_dict()
    offset = reference_offset(scenario.vehicle_model(), reference)
    corners = (scenario.workspace.vertices + scenario.offset).tolist() if scenario.boundary else data["workspace"]
    numbers = Numbers({origin.problem})
    road = elements.road(corners, numbers.next())
    blocks, noted = _obstacles(scenario, obstacle_type, numbers)
    walls = _walls(scenario, numbers)
    root = Element("commonRoad", _header(origin, step, date or datetime.date.today()))
    rest = _rest(data, noted, [int(wall.attrib["id"]) for wall in walls], reference)
    root.append(ElementTree.Comment(remainder.to_comment(rest)))
    _place(root)
    root.append(road)
    root.extend(blocks + walls)
    problem = SubElement(root, "planningProblem", id=str(origin.problem))
    problem.append(elements.initial_state(data["start"], offset))
    problem.append(elements.goal_state(data["goal"], data["tolerance"], offset))
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def _header(origin: Origin, dt: float, date: datetime.date) -> dict[str, str]:
    return {
        "timeStepSize": elements.decimal(dt),
        "commonRoadVersion": "2020a",
        "author": "tightspot",
        "affiliation": "",
        "source": "tightspot",
        "benchmarkID": origin.benchmark,
        "date": date.isoformat(),
    }


def _place(root: Element) -> None:
    """Location and tags, which the format demands; -999 and 999 are its words for nowhere."""
    location = SubElement(root, "location")
    for name, text in (("geoNameId", "-999"), ("gpsLatitude", "999"), ("gpsLongitude", "999")):
        SubElement(location, name).text = text
    SubElement(root, "scenarioTags")


class Numbers:
    """Ids that nobody has yet."""

    def __init__(self, taken: set[int]) -> None:
        self._taken = taken
        self._last = 0

    def next(self) -> int:
        """The smallest id above the last one given."""
        self._last += 1
        while self._last in self._taken:
            self._last += 1
        return self._last


def _rest(data: dict[str, Any], noted: list[dict[str, Any]], walls: list[int], reference: Reference) -> dict[str, Any]:
    return {
        "reference": reference,
        **remainder.plain_fields(data),
        "tolerance": data["tolerance"],
        "start": data["start"],
        "goal": data["goal"],
        "workspace": data["workspace"],
        "walls": walls,
        "obstacles": noted,
    }


def _obstacles(scenario: Scenario, kind: ObstacleType, numbers: Numbers) -> tuple[list[Element], list[dict[str, Any]]]:
    """Their elements, and what the comment has to say of each."""
    blocks: list[Element] = []
    noted: list[dict[str, Any]] = []
    for obstacle in scenario.obstacles:
        data = obstacle.to_dict(scenario.offset)
        pieces = pieces_of(obstacle, data, scenario.offset)
        entry: dict[str, Any] = {"ids": [numbers.next() for _ in pieces], "name": obstacle.name}
        if len(pieces) > 1 or pieces[0].tolist() != data["vertices"]:
            entry |= {key: data[key] for key in ("vertices", "holes") if key in data}
        blocks += [elements.static_obstacle(n, kind, piece) for n, piece in zip(entry["ids"], pieces, strict=True)]
        noted.append(entry)
    return blocks, noted


def _walls(scenario: Scenario, numbers: Numbers) -> list[Element]:
    """What lies between a boundary that is not convex and the lanelet around it."""
    outside = scenario.boundary.outside() if scenario.boundary else None
    parts = outside.parts if outside else ()
    rings = [part.vertices + scenario.offset for part in parts]
    return [elements.static_obstacle(numbers.next(), "roadBoundary", ring) for ring in rings]


def pieces_of(obstacle: Obstacle, data: dict[str, Any], offset: Array) -> list[Array]:
    """Polygons as CommonRoad knows them, in the file's coordinates: without holes and without repeated corners.

    The obstacle's own boundary if it has no holes and does not touch itself, else the boundaries of its convex parts.
    """
    rings = [np.array(ring, float) for ring in (data["vertices"], *data.get("holes", []))]
    ring = rings[0][(rings[0] != np.roll(rings[0], 1, axis=0)).any(axis=1)]
    if len(rings) == 1 and shapely.Polygon(ring - ring[0]).is_valid:
        return [ring]
    corners = np.vstack(rings)
    return [_at_corners(part.vertices + offset, corners) for part in obstacle.parts]


def _at_corners(ring: Array, corners: Array) -> Array:
    """The ring with points that are a corner but for rounding moved exactly there."""
    distances = np.hypot(*(ring[:, None] - corners).transpose(2, 0, 1))
    nearest = distances.argmin(axis=1)
    close = distances.min(axis=1) < _ROUNDING
    return np.where(close[:, None], corners[nearest], ring)
