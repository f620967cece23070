"""Plans as CommonRoad solution files, for its checkers and its website."""

from __future__ import annotations

import datetime
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem
from tightspot.files import atomic_write
from tightspot.geometry import nearest_angle, wrap_angle
from tightspot.scenarios.readers.commonroad import (
    Origin,
    Reference,
    Task,
    checked_reference,
    decimal,
    read_task,
    reference_offset,
    to_comment,
    to_reference,
)
from tightspot.vehicles import VehicleModel, vehicle
from tightspot.vehicles.commonroad import VEHICLE_TYPES
from tightspot.verification import Plan

Array = NDArray[np.float64]

COSTS = ("JB1", "SA1", "WX1", "SM1", "SM2", "SM3", "MW1", "TR1", "TR2")
STANDING = 1e-6
"""A plan that ends slower than this stands, m/s."""
FAR = 0.1
"""The plan must start this near to where the planning problem does, m; CommonRoad's checkers allow as much."""
_MOST_STEPS = 200_000
_WHOLE_TURN = 2 * np.pi


def write_commonroad_solution(
    plan: Plan,
    path: str | Path,
    *,
    scenario_file: str | Path | None = None,
    problem: int | None = None,
    dt: float | None = None,
    vehicle_type: int | None = None,
    cost: str = "JB1",
    reference: Reference = "centre",
    date: datetime.datetime | None = None,
) -> list[str]:
    """Write the plan as a solution with the kinematic single-track model (``KS``).

    The states are the replayed motion at multiples of ``dt``, not an interpolation of knots. A plan that ends standing
    (slower than 1e-6 m/s) still stands at the first multiple after its end. One that ends moving is driven a little
    slower, by less than ``dt`` in all, so that its end is a multiple: the same path, and no limit is exceeded.

    Args:
        plan: The plan. Whether it is certified is not asked here.
        path: Where to.
        scenario_file: The CommonRoad scenario that is solved: its id, problem and time step are taken from it; its
            coordinates may be the scene's original or its recentred ones. Default: the file that the plan's scene
            was read from, as noted in ``source``; else the one that :func:`write_commonroad` would make of the scene.
        problem: Id of the planning problem, default: the first in the file or the noted one.
        dt: The scenario's time step, s; default: from the same place.
        vehicle_type: CommonRoad's vehicle, 1 to 4. Needed if the plan's is not one of those (catalogue names
            ``commonroad-…``): the checkers judge by the type's dimensions, whatever the plan's vehicle measures.
        cost: Name of the cost function by which the solution shall be ranked.
        reference: What the positions in the file shall be of; CommonRoad's checkers expect ``"centre"``.
        date: Default: now.

    Returns:
        Sentences on what CommonRoad's checkers will object to; empty if nothing is known.

    Raises:
        InputError: An argument that is none, a vehicle that CommonRoad has not, a plan that starts elsewhere than the
            planning problem, or a trajectory that cannot be integrated.
        OSError: The file cannot be written; an old one is then unchanged.
    """
    number = _type(plan.vehicle, vehicle_type)
    if cost not in COSTS:
        raise InputError(Problem("cost", f"{cost!r} is not known; it is one of {', '.join(COSTS)}"))
    task = None if scenario_file is None else read_task(scenario_file, problem)
    noted = task.origin if task else Origin.of(plan.scenario.source, plan.scenario.name)
    origin = Origin(noted.benchmark, noted.problem if problem is None else problem, noted.dt if dt is None else dt)
    offset = reference_offset(vehicle(VEHICLE_TYPES[number]), checked_reference(reference))
    states, slower = sampled(plan, origin.dt)
    states[:, :2] = to_reference(states[:, :3], offset)
    if task is not None:
        states[:, :2] += _shift(states[0, :2], task, plan.scenario.offset)
    states[:, 2] = _headings(states[:, 2], wrap_angle(float(plan.scenario.start[2])) if task is None else task.start[2])
    notes = _notes(states, task, slower)
    root = Element("CommonRoadSolution", _header(plan, number, cost, origin, date or datetime.datetime.now()))
    root.append(ElementTree.Comment(to_comment({"reference": reference, "dt": origin.dt})))
    _trajectory(root, states, origin.problem)
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode")
    atomic_write(path, f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n')
    return notes


def sampled(plan: Plan, dt: float) -> tuple[Array, float]:
    """The motion at 0, dt, 2 dt, ... up to the first multiple at or after its end.

    Args:
        plan: The plan.
        dt: Time step, s.

    Returns:
        (x, y, theta, v, delta) in original coordinates, shape (n, 5), and how many times slower it is driven: 1 if the
        plan ends standing.
    """
    if not (np.isfinite(dt) and dt > 0):
        raise InputError(Problem("dt", f"{dt} s must be a positive time"))
    first, duration = float(plan.trajectory.t[0]), plan.trajectory.duration
    if duration / dt > _MOST_STEPS:
        raise InputError(Problem("dt", f"{dt:g} s gives more than {_MOST_STEPS} states; take a longer one"))
    steps = max(1, int(np.ceil(duration / dt - 1e-9)))
    names = list(plan.vehicle.state_names)
    columns = [names.index(name) for name in ("x", "y", "theta", "v", "delta")]
    final_speed = float(plan.sample(first + duration)[names.index("v")])
    standing = abs(final_speed) < STANDING
    stretch = 1.0 if standing else steps * dt / duration
    states = plan.sample(first + np.minimum(np.arange(steps + 1) * dt / stretch, duration))[:, columns]
    states[:, 3] /= stretch
    if standing:
        states[-1, 3] = 0.0
    return states, stretch


def _type(car: VehicleModel, wanted: int | None) -> int:
    if wanted is None:
        for number, name in VEHICLE_TYPES.items():
            if car.name == name and car.to_dict() == vehicle(name).to_dict():
                return number
        names = ", ".join(f"{number} {name}" for number, name in VEHICLE_TYPES.items())
        raise InputError(
            Problem(
                "vehicle_type",
                f"vehicle {car.name!r} is none of CommonRoad's ({names}); "
                "plan with one of these, or say as which type it shall be judged",
            )
        )
    if wanted not in VEHICLE_TYPES:
        raise InputError(Problem("vehicle_type", f"{wanted} must be one of {', '.join(map(str, VEHICLE_TYPES))}"))
    return wanted


def _headings(headings: Array, start: float) -> Array:
    """Whole turns away so that the first is nearest to ``start`` and none is beyond what CommonRoad allows, 2 pi."""
    first = float(headings[0])
    moved = headings + (nearest_angle(first, float(start)) - first)
    return np.asarray(np.where(np.abs(moved) > _WHOLE_TURN, wrap_angle(moved), moved))


def _shift(start: Array, task: Task, offset: Array) -> Array:
    """What leads from original coordinates to the file's: nothing, or the recentring if the file is recentred."""
    for shift in (np.zeros(2), -offset):
        if np.hypot(*(start + shift - task.start[:2])) <= FAR:
            return shift
    gap = float(np.hypot(*(start - task.start[:2])))
    place = f"({task.start[0]:g}, {task.start[1]:g})"
    sentence = f"planning problem {task.origin.problem} starts at {place}, the plan {gap:.3g} m from there"
    raise InputError(Problem("scenario_file", f"{sentence}; is it a plan of this scenario and this reference point?"))


def _notes(states: Array, task: Task | None, slower: float) -> list[str]:
    notes = []
    if slower > 1:
        notes.append(
            f"the plan ends moving; it is driven {100 * (slower - 1):.2g} % slower to end at a multiple of the step"
        )
    if task is None:
        return notes
    gap = float(np.hypot(*(states[0, :2] - task.start[:2])))
    if gap > FAR:
        place = f"({task.start[0]:g}, {task.start[1]:g})"
        sentence = f"planning problem {task.origin.problem} starts at {place}, the plan {gap:.3g} m from there"
        raise InputError(
            Problem("scenario_file", f"{sentence}; is it a plan of this scenario and this reference point?")
        )
    last = len(states) - 1
    if task.steps and not task.steps[0] <= last <= task.steps[1]:
        low, high = task.steps
        notes.append(f"the goal is reached at time step {last}; the planning problem wants it between {low} and {high}")
    return notes


def _header(plan: Plan, number: int, cost: str, origin: Origin, date: datetime.datetime) -> dict[str, str]:
    header = {
        "benchmark_id": f"KS{number}:{cost}:{origin.benchmark}:2020a",
        "date": date.replace(microsecond=0, tzinfo=None).isoformat(),
    }
    seconds: Any = plan.report.get("seconds")
    if isinstance(seconds, int | float) and np.isfinite(seconds) and seconds > 0:
        header["computation_time"] = decimal(seconds)
    return header


def _trajectory(root: Element, states: Array, problem: int) -> None:
    trajectory = SubElement(root, "ksTrajectory", planningProblem=str(problem))
    for step, (x, y, theta, v, delta) in enumerate(states.tolist()):
        state = SubElement(trajectory, "ksState")
        values = {"x": x, "y": y, "steeringAngle": delta, "velocity": v, "orientation": theta}
        for name, value in values.items():
            SubElement(state, name).text = decimal(value)
        SubElement(state, "time").text = str(step)
