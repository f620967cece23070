"""Motions by another integrator than ours, and CommonRoad's own checkers in a process of their own."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tightspot.verification import Plan

Array = NDArray[np.float64]


def driven(plan: Plan, times: Array, fine: float = 1e-4) -> Array:
    """States of the single-track car at the times, in original coordinates: midpoint rule with small steps.

    v and delta are linear on an interval, so they are exact; x, y, theta are summed up with steps of ``fine`` s.
    """
    wheelbase = plan.vehicle.to_dict()["wheelbase"]
    t, inputs = plan.trajectory.t, plan.trajectory.inputs
    count = int(np.ceil(plan.trajectory.duration / fine))
    grid = np.unique(np.concatenate([np.linspace(t[0], t[-1], count + 1), t, times]))
    ends = np.concatenate([plan.trajectory.states[:1, 3:], np.diff(t)[:, None] * inputs]).cumsum(axis=0)
    v, delta = (np.interp(grid, t, column) for column in ends.T)
    step, middle_v, middle_delta = np.diff(grid), (v[1:] + v[:-1]) / 2, (delta[1:] + delta[:-1]) / 2
    turn = step * middle_v * np.tan(middle_delta) / wheelbase
    theta = plan.trajectory.states[0, 2] + np.concatenate([[0.0], np.cumsum(turn)])
    middle = (theta[1:] + theta[:-1]) / 2
    x, y = (
        start + np.concatenate([[0.0], np.cumsum(step * middle_v * f(middle))])
        for start, f in zip(plan.trajectory.states[0, :2] + plan.scenario.offset, (np.cos, np.sin), strict=True)
    )
    return np.column_stack([x, y, theta, v, delta])[np.searchsorted(grid, times)]


CHECKER = """
import json, sys, warnings
warnings.simplefilter("ignore")
from commonroad.common.file_reader import CommonRoadFileReader
from commonroad.common.solution import CommonRoadSolutionReader
from commonroad_dc.boundary.boundary import create_road_boundary_obstacle
from commonroad_dc.feasibility import solution_checker as checker
results = []
for scenario_file, solution_file in zip(sys.argv[1::2], sys.argv[2::2]):
    scenario, problems = CommonRoadFileReader(scenario_file).open()
    solution = CommonRoadSolutionReader.open(solution_file)
    (answer,) = solution.planning_problem_solutions
    facts = {"benchmark": solution.benchmark_id, "states": len(answer.trajectory.state_list)}
    shapes = [obstacle.occupancy_at_time(0).shape for obstacle in scenario.static_obstacles]
    facts["polygons"] = [s.vertices.tolist() for s in shapes if hasattr(s, "vertices")]
    facts["circles"] = [[*s.center, s.radius] for s in shapes if hasattr(s, "radius")]
    for name, check in {
        "solved": lambda: checker.solved_all_problems(problems, solution),
        "starts": lambda: checker.starts_at_correct_state(solution, problems),
        "reached": lambda: checker.goal_reached(scenario, problems, solution),
        "free": lambda: not checker.obstacle_collision(scenario, problems, solution),
        "alone": lambda: not checker.ego_collision(scenario, problems, solution),
        "feasible": lambda: facts["free"] is True  # it takes its time
        and checker.solution_feasible(solution, scenario.dt, problems)[answer.planning_problem_id][0],
        "on the road": lambda: not create_road_boundary_obstacle(scenario, method="obb_rectangles")[1].collide(
            checker._create_pp_solution_collision_object(problems, answer, scenario.dt)
        ),
    }.items():
        try:
            facts[name] = bool(check())
        except checker.SolutionCheckerException as error:
            facts[name] = str(error)
    results.append(facts)
print("FACTS" + json.dumps(results))
"""
CHECKS = ("solved", "starts", "reached", "free", "alone", "feasible", "on the road")


def checked(*pairs: tuple[Path, Path]) -> list[dict[str, Any]]:
    """What commonroad-drivability-checker says of (scenario, solution) files."""
    probe = [sys.executable, "-W", "ignore", "-c", "import commonroad_dc.feasibility.solution_checker"]
    if subprocess.run(probe, check=False, capture_output=True).returncode:
        pytest.skip("needs commonroad-drivability-checker and a commonroad-io that it works with")
    files = [str(file) for pair in pairs for file in pair]
    command = [sys.executable, "-W", "ignore", "-c", CHECKER, *files]
    done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    facts: list[dict[str, Any]] = json.loads(done.stdout.split("FACTS")[1])
    return facts
