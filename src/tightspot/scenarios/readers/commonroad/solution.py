"""Reading CommonRoad solution files: a motion of the kinematic single-track model, sampled at equal steps."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem, SceneError
from tightspot.scenarios.readers.commonroad import remainder
from tightspot.scenarios.readers.commonroad.reference import (
    Reference,
    checked_reference,
    reference_offset,
    to_rear_axle,
)
from tightspot.scenarios.readers.commonroad.xml_tree import Node, parse
from tightspot.scenarios.readers.files import refuse
from tightspot.trajectory import Trajectory
from tightspot.vehicles import VehicleModel, vehicle
from tightspot.vehicles.commonroad import VEHICLE_TYPES

Array = NDArray[np.float64]

_BENCHMARK = re.compile(r"\[?(?P<vehicles>[^:\]]+)\]?:\[?(?P<costs>[^:\]]+)\]?:(?P<scenario>[^:]+):(?P<version>\w+)")


@dataclass(frozen=True)
class CommonRoadSolution:
    """One planning problem's solution.

    Attributes:
        scenario: Benchmark id of the scenario that it solves.
        problem: The planning problem's id.
        vehicle_type: CommonRoad's number of the vehicle, 1 to 4.
        vehicle: Our vehicle of that type.
        cost: Name of the cost function.
        trajectory: Rear-axle states at the file's times, in its coordinates, headings without jumps. The inputs are the
            differences of speed and steering angle over each step: constant ones that lead from one to the next.
    """

    scenario: str
    problem: int
    vehicle_type: int
    vehicle: VehicleModel
    cost: str
    trajectory: Trajectory


def read_commonroad_solution(
    path: str | Path, *, dt: float | None = None, problem: int | None = None, reference: Reference | None = None
) -> CommonRoadSolution:
    """The solution of one planning problem in a CommonRoad solution file.

    Args:
        path: The file.
        dt: The scenario's time step, s, which solution files do not hold; needless for files that tightspot wrote.
        problem: Id of the planning problem; default: the first in the file.
        reference: What its positions are of, ``"centre"`` or ``"rear-axle"``; default: what tightspot noted, else
            ``"centre"``.

    Raises:
        SceneError: The file cannot be read, or holds no trajectory of the kinematic single-track model.
        InputError: ``dt`` is not known or no time.
        TightspotError: defusedxml is not installed.
    """
    path = Path(path)
    root = parse(path)
    if root.tag != "CommonRoadSolution":
        raise refuse(path, f"holds <{root.tag[:40]}>, not a CommonRoad solution (<CommonRoadSolution>)")
    node, index = _trajectory(path, root, problem)
    vehicles, costs, scenario = _benchmark(root)
    name = vehicles[min(index, len(vehicles) - 1)]
    kind = re.fullmatch(r"KS([1-4])", name)
    if not kind:
        raise refuse(
            path, f"is for vehicle {name[:20]!r}; solutions of the kinematic single-track model (KS1 to KS4) are read"
        )
    number = int(kind[1])
    car = vehicle(VEHICLE_TYPES[number])
    noted = remainder.from_comments(root)
    point = checked_reference(reference or str(noted.get("reference", "centre")))
    step = _step(dt, noted.get("dt"))
    trajectory = _read(node, step, reference_offset(car, point))
    return CommonRoadSolution(
        scenario, int(node.attribute("planningProblem")), number, car, costs[min(index, len(costs) - 1)], trajectory
    )


def _trajectory(path: Path, root: Node, wanted: int | None) -> tuple[Node, int]:
    there = list(root.children())
    numbers = [node.attribute("planningProblem") for node in there]
    if not there or not all(re.fullmatch(r"\d{1,18}", number) for number in numbers):
        raise refuse(path, "has no trajectory with the number of its planning problem")
    if wanted is not None and str(wanted) not in numbers:
        raise refuse(path, f"solves no planning problem {wanted}; it solves {', '.join(numbers[:10])}")
    index = 0 if wanted is None else numbers.index(str(wanted))
    if there[index].tag != "ksTrajectory":
        raise there[index].refuse("is not read; a ksTrajectory, states of the kinematic single-track model, is")
    return there[index], index


def _benchmark(root: Node) -> tuple[list[str], list[str], str]:
    text = root.attribute("benchmark_id").replace(" ", "")
    found = _BENCHMARK.fullmatch(text)
    if not found:
        raise SceneError(Problem("benchmark_id", f"{text[:60]!r} is none, such as 'KS2:JB1:DEU_Muc-1_1_T-1:2020a'"))
    return found["vehicles"].split(","), found["costs"].split(","), found["scenario"]


def _step(given: float | None, noted: object) -> float:
    step = noted if given is None else given
    if step is None:
        raise InputError(Problem("dt", "is not known: a solution file does not hold it; give the scenario's time step"))
    if isinstance(step, bool) or not isinstance(step, int | float) or not (np.isfinite(step) and step > 0):
        raise InputError(Problem("dt", f"{step} s must be a positive time"))
    return float(step)


def _read(node: Node, dt: float, offset: Array) -> Trajectory:
    rows = [
        [state.child(name).number() for name in ("x", "y", "orientation", "velocity", "steeringAngle")]
        + [state.child("time").integer()]
        for state in node.children("ksState")
    ]
    if len(rows) < 2:
        raise node.refuse(f"has {len(rows)} states; a motion needs at least 2")
    table = np.array(sorted(rows, key=lambda row: row[-1]), float)
    steps = np.diff(table[:, -1])
    if (steps != 1).any():
        k = int(np.argmax(steps != 1))
        raise node.refuse(f"has no state at time step {table[k, -1] + 1:.0f}, or several")
    states = table[:, :5].copy()
    states[:, 2] = np.unwrap(states[:, 2])
    states[:, :2] = to_rear_axle(states[:, :2], states[:, 2], offset)
    times: Array = dt * np.arange(len(states), dtype=np.float64)
    inputs = np.asarray(np.diff(states[:, 3:5], axis=0) / np.diff(times)[:, None])
    return Trajectory(times, states, inputs)
