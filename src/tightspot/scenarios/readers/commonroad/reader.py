"""From a CommonRoad scenario and one of its planning problems to a scene."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot import vehicles
from tightspot.errors import Problem, SceneError, VehicleError
from tightspot.geometry import wrap_angle
from tightspot.problems import join, prefixed, shortened, shown
from tightspot.scenarios.readers.commonroad import remainder
from tightspot.scenarios.readers.commonroad.goal import read_goal
from tightspot.scenarios.readers.commonroad.lanelets import (
    Lanelet,
    Lanelets,
    beside_the_road,
    checked_lanelets,
    read_lanelet,
)
from tightspot.scenarios.readers.commonroad.obstacles import (
    Moving,
    checked_moving,
    exact,
    pose_of,
    read_obstacles,
)
from tightspot.scenarios.readers.commonroad.origin import Origin
from tightspot.scenarios.readers.commonroad.reference import (
    Reference,
    checked_reference,
    reference_offset,
    to_rear_axle,
)
from tightspot.scenarios.readers.commonroad.xml_tree import Node, parse
from tightspot.scenarios.readers.files import refuse
from tightspot.scenarios.scenario import Scenario
from tightspot.vehicles import VehicleModel, load_vehicle

Array = NDArray[np.float64]

VERSIONS = ("2020a", "2018b")
VEHICLE = "commonroad-bmw-320i"
"""Whose problem it is if nobody says: CommonRoad's vehicle 2."""
_NO_STEERING_BELOW = 0.1
"""Below this speed a yaw rate says nothing about the steering angle, m/s."""
_OTHER_ROOTS = {
    "CommonRoadSolution": "is a CommonRoad solution, not a scenario; give the scenario it solves",
    "osm": "is an OpenStreetMap or Lanelet2 file; convert it to a CommonRoad scenario first",
}


def read_commonroad(
    path: str | Path,
    *,
    problem: int | None = None,
    vehicle: VehicleModel | str | None = None,
    reference: Reference | None = None,
    moving: Moving = "refuse",
    lanelets: Lanelets = "ignore",
) -> Scenario:
    """The scene in a CommonRoad scenario file (2020a or 2018b).

    Args:
        path: The file.
        problem: Id of the planning problem; default: the first in the file.
        vehicle: Whose reference point the positions are of, and who shall drive: a vehicle, a catalogue's name or a
            vehicle file; default: what :func:`write_commonroad` noted in the file, else ``commonroad-bmw-320i``.
        reference: What a position in the file is of, ``"centre"`` or ``"rear-axle"``; default: what was noted, else
            ``"centre"``, as CommonRoad's own checkers take it.
        moving: What to do if obstacles move: ``"refuse"`` the file, read them at their ``"initial"`` state or
            ``"ignore"`` them.
        lanelets: Whether the road's ``"boundary"`` must not be crossed; by default the vehicle may leave the road.

    Returns:
        The scene; its ``description`` says what was chosen or left out.

    Raises:
        SceneError: With all problems, each with its place in the file.
        InputError: An argument that is not one of those above; a vehicle that is none.
        TightspotError: defusedxml is not installed.
    """
    moving, lanelets = checked_moving(moving), checked_lanelets(lanelets)
    path = Path(path)
    root = parse(path)
    dt = header(path, root)
    known = remainder.from_comments(root)
    car, described = _vehicle(vehicle, known)
    noted = known.get("reference")
    offset = reference_offset(car, checked_reference(reference or (noted if isinstance(noted, str) else "centre")))
    blocks, notes, problems = read_obstacles(root, moving)
    road = _road(root, problems)
    mission = None
    try:
        chosen, chosen_notes = chosen_problem(path, root, problem)
        mission = _mission(chosen, known, offset, car, road, dt)
        notes = chosen_notes + mission.notes + notes
    except SceneError as error:
        problems += error.problems
    if problems or mission is None:
        raise SceneError(shortened(problems))
    origin = Origin(root.attribute("benchmarkID")[:200] or path.stem[:200], mission.number, dt)
    data: dict[str, Any] = {"name": origin.benchmark, "source": str(origin)}
    data |= remainder.plain_fields(known) | {"vehicle": described} | mission.fields
    workspace, blocks = remainder.confirmed_workspace(known, root, blocks)
    obstacles, paths = remainder.obstacles(known, blocks)
    if workspace is not None:
        data["workspace"] = workspace
    elif lanelets == "boundary":
        obstacles += _boundary(data, list(road.values()))
    elif road:
        notes.append(f"The {len(road)} lanelets are no boundary here: the vehicle may leave the road.")
    data.setdefault("description", " ".join(notes))
    return _scenario(data | {"obstacles": obstacles}, paths, path.stem)


@dataclass(frozen=True)
class _Mission:
    """A planning problem's number, the scene's fields that it fills, and sentences on what was chosen."""

    number: int
    fields: dict[str, Any]
    notes: list[str]


def header(path: Path, root: Node) -> float:
    """The time step, s, after root and version have been checked."""
    if root.tag != "commonRoad":
        sentence = f"holds <{root.tag[:40]}>, not a CommonRoad scenario (<commonRoad>)"
        raise refuse(path, _OTHER_ROOTS.get(root.tag, sentence))
    version = root.attribute("commonRoadVersion")
    if version not in VERSIONS:
        raise refuse(path, f"is of CommonRoad version {version[:40]!r}; {' and '.join(VERSIONS)} are read")
    text = root.attribute("timeStepSize")
    dt = float(text) if re.fullmatch(r"\d{0,9}\.?\d{1,30}", text) else 0.0
    if not dt > 0:
        raise SceneError(Problem("timeStepSize", f"{shown(text)} is not a time above 0 s"))
    return dt


def _vehicle(given: VehicleModel | str | None, known: Mapping[str, Any]) -> tuple[VehicleModel, str | dict[str, Any]]:
    """The vehicle, and how the scene names it: by its catalogue's name or in full."""
    if isinstance(given, VehicleModel):
        return given, given.to_dict()
    if given is not None:
        car = load_vehicle(given)
        return car, given if given == car.name else car.to_dict()
    noted = known.get("vehicle", VEHICLE)
    try:
        return vehicles.vehicle(noted) if isinstance(noted, str) else vehicles.from_dict(noted), noted
    except VehicleError as error:
        raise SceneError(prefixed("vehicle", error.problems)) from None


def _road(root: Node, problems: list[Problem]) -> dict[int, Lanelet]:
    road: dict[int, Lanelet] = {}
    for node in root.children("lanelet"):
        try:
            number = node.attribute("id")
            road[int(number) if number.isdecimal() else -1 - len(road)] = read_lanelet(node)
        except SceneError as error:
            problems += error.problems
    return road


def chosen_problem(path: Path, root: Node, wanted: int | None) -> tuple[Node, list[str]]:
    """The planning problem with that id, or the first with a note on the others."""
    there = list(root.children("planningProblem"))
    if not there:
        raise refuse(path, "has no planningProblem, so neither start nor goal; add one")
    numbers = [node.attribute("id") for node in there]
    for node in there:
        if not re.fullmatch(r"\d{1,18}", node.attribute("id")):
            raise node.refuse(f"has the id {node.attribute('id')[:40]!r}; it must be a whole number above 0")
    if wanted is None:
        first, *others = numbers
        note = f"Planning problem {first} was taken; there are also {', '.join(others[:10])}."
        return there[0], [note] if others else []
    if str(wanted) not in numbers:
        raise SceneError(Problem("planningProblem", f"there is none with the id {wanted}; there are {_some(numbers)}"))
    return there[numbers.index(str(wanted))], []


def _some(numbers: list[str]) -> str:
    return ", ".join(number[:20] for number in numbers[:10]) + (", …" if len(numbers) > 10 else "")


def _mission(
    node: Node, known: Mapping[str, Any], offset: Array, car: VehicleModel, road: Mapping[int, Lanelet], dt: float
) -> _Mission:
    first, goals = node.child("initialState"), list(node.children("goalState"))
    if not goals:
        raise node.refuse("has no goalState; add one")
    start, heading = _start(first, offset, car)
    goal = read_goal(goals[0], heading, offset, road, dt)
    notes = [f"The first of {len(goals)} goal states was taken."] if len(goals) > 1 else []
    fields: dict[str, Any] = {"start": remainder.confirmed_state(known, "start", first, offset) or start}
    kept = remainder.confirmed_state(known, "goal", goals[0], offset)
    if kept is not None:
        return _Mission(int(node.attribute("id")), fields | {"goal": kept, "tolerance": known["tolerance"]}, notes)
    fields["goal"] = _plain(goal.state)
    fields["tolerance"] = {"position": goal.position, "heading": goal.heading, "speed": goal.speed}
    return _Mission(int(node.attribute("id")), fields, notes + goal.notes)


def _start(node: Node, offset: Array, car: VehicleModel) -> tuple[dict[str, float | None], Array]:
    """The scene's start, and the pose of the reference point."""
    pose = pose_of(node)
    pose[2] = float(wrap_angle(pose[2]))
    velocity, steering, yaw_rate = (node.find(name) for name in ("velocity", "steeringAngle", "yawRate"))
    v = exact(velocity) if velocity else 0.0
    delta = exact(steering) if steering else 0.0
    wheelbase = getattr(car, "wheelbase", None)
    if steering is None and yaw_rate is not None and wheelbase and abs(v) > _NO_STEERING_BELOW:
        delta = math.atan(wheelbase * exact(yaw_rate) / v)
    rear = to_rear_axle(pose[:2], pose[2], offset)
    return _plain(np.array([*rear, pose[2], v, delta])), pose


def _plain(state: Array) -> dict[str, float | None]:
    names = ("x", "y", "theta", "v", "delta")
    return {name: None if math.isnan(x) else x for name, x in zip(names, state.tolist(), strict=True)}


def _boundary(data: dict[str, Any], road: list[Lanelet]) -> list[dict[str, Any]]:
    """What is beside the road, as obstacles; the workspace becomes the box around the road."""
    if not road:
        raise SceneError(Problem("lanelet", 'there is none, so there is no road to stay on; use lanelets="ignore"'))
    ends = np.array([[data[key]["x"], data[key]["y"]] for key in ("start", "goal")])
    (low, high), beside = beside_the_road(road, ends)
    data["workspace"] = {"x": [low[0], high[0]], "y": [low[1], high[1]]}
    return [
        {"name": f"beside-the-road-{i}", "vertices": ring.tolist(), "holes": [hole.tolist() for hole in holes]}
        for i, (ring, holes) in enumerate(beside)
    ]


def _scenario(data: dict[str, Any], paths: list[str], name: str) -> Scenario:
    """The scenario; problems of an obstacle are told with its place in the XML file."""
    try:
        return Scenario.from_dict(data, name=name)
    except SceneError as error:
        raise SceneError([_placed(problem, paths) for problem in error.problems]) from None


def _placed(problem: Problem, paths: list[str]) -> Problem:
    found = re.match(r"obstacles\[(\d+)\]\.?(.*)", problem.path)
    if not found or int(found[1]) >= len(paths):
        return problem
    return Problem(join(paths[int(found[1])], found[2]), problem.message)
