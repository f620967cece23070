"""What a solution must know of the scenario file that it solves."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import SceneError
from tightspot.scenarios.readers.commonroad.obstacles import pose_of
from tightspot.scenarios.readers.commonroad.origin import Origin
from tightspot.scenarios.readers.commonroad.reader import chosen_problem, header
from tightspot.scenarios.readers.commonroad.xml_tree import Node, parse

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Task:
    """A planning problem in a file.

    Attributes:
        origin: Benchmark id, the problem's id and the time step.
        start: (x m, y m, theta rad) of the reference point at the beginning, as in the file.
        steps: The goal's first and last allowed time step, or ``None``.
    """

    origin: Origin
    start: Array
    steps: tuple[int, int] | None


def read_task(path: str | Path, problem: int | None = None) -> Task:
    """The planning problem of that id, by default the first, of a CommonRoad scenario file.

    Raises:
        SceneError: The file cannot be read, or has no such problem.
    """
    path = Path(path)
    root = parse(path)
    dt = header(path, root)
    node, _ = chosen_problem(path, root, problem)
    origin = Origin(root.attribute("benchmarkID") or path.stem, int(node.attribute("id")), dt)
    return Task(origin, pose_of(node.child("initialState")), _steps(node.find("goalState")))


def _steps(goal: Node | None) -> tuple[int, int] | None:
    time = goal.find("time") if goal else None
    if time is None:
        return None
    try:
        return time.child("intervalStart").integer(), time.child("intervalEnd").integer()
    except SceneError:
        return None
