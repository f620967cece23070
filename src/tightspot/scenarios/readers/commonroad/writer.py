"""From a scene to a CommonRoad scenario file (2020a) that CommonRoad's own programs read."""

from __future__ import annotations

import datetime
from pathlib import Path
from typing import Any, Literal, get_args
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem
from tightspot.files import atomic_write
from tightspot.scenarios.obstacle import Obstacle
from tightspot.scenarios.readers.commonroad import elements, remainder
from tightspot.scenarios.readers.commonroad.origin import PROBLEM, Origin
from tightspot.scenarios.readers.commonroad.reference import Reference, checked_reference, reference_offset
from tightspot.scenarios.scenario import Scenario

Array = NDArray[np.float64]

ObstacleType = Literal["unknown", "parkedVehicle", "constructionZone", "roadBoundary"]
"""What CommonRoad's schema lets a static obstacle be."""
OBSTACLE_TYPES: tuple[ObstacleType, ...] = get_args(ObstacleType)
ROAD = 1
"""Id of the lanelet that is the workspace."""


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
    becomes a lanelet, so that it is a road that must not be left; start and goal become a planning problem. What
    CommonRoad cannot hold is kept in a comment.

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
    root = Element("commonRoad", _header(origin, step, date or datetime.date.today()))
    blocks, noted = _obstacles(data["obstacles"], obstacle_type, taken={ROAD, origin.problem})
    root.append(ElementTree.Comment(remainder.to_comment(_rest(data, noted, reference))))
    _place(root)
    root.append(elements.road(data["workspace"], ROAD if origin.problem != ROAD else PROBLEM))
    root.extend(blocks)
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


def _rest(data: dict[str, Any], noted: list[dict[str, Any]], reference: Reference) -> dict[str, Any]:
    return {
        "reference": reference,
        **remainder.plain_fields(data),
        "tolerance": data["tolerance"],
        "start": data["start"],
        "goal": data["goal"],
        "workspace": data["workspace"],
        "obstacles": noted,
    }


def _obstacles(
    obstacles: list[dict[str, Any]], kind: ObstacleType, taken: set[int]
) -> tuple[list[Element], list[dict[str, Any]]]:
    """Their elements, and what the comment has to say of each."""
    blocks: list[Element] = []
    noted: list[dict[str, Any]] = []
    number = PROBLEM
    for obstacle in obstacles:
        pieces = _pieces(obstacle)
        numbers = []
        for piece in pieces:
            number = next(n for n in range(number + 1, number + 4) if n not in taken)
            numbers.append(number)
            blocks.append(elements.static_obstacle(number, kind, piece))
        entry: dict[str, Any] = {"ids": numbers, "name": obstacle["name"]}
        if len(pieces) > 1 or pieces[0].tolist() != obstacle["vertices"]:
            entry |= {key: obstacle[key] for key in ("vertices", "holes") if key in obstacle}
        noted.append(entry)
    return blocks, noted


def _pieces(obstacle: dict[str, Any]) -> list[Array]:
    """The obstacle's boundary without repeated corners; if it has holes, which CommonRoad's polygons cannot have, the
    boundaries of its convex parts."""
    ring = np.array(obstacle["vertices"], float)
    holes = [np.array(hole, float) for hole in obstacle.get("holes", [])]
    if not holes:
        return [ring[(ring != np.roll(ring, 1, axis=0)).any(axis=1)]]
    near = ring[0].round()
    corners = np.vstack([ring, *holes])
    parts = Obstacle(obstacle["name"], ring - near, tuple(hole - near for hole in holes)).parts
    # The corners of the parts are corners of the obstacle; taken from there they are exact.
    nearest = [np.hypot(*(part.vertices[:, None] + near - corners).transpose(2, 0, 1)).argmin(axis=1) for part in parts]
    return [corners[indices] for indices in nearest]
