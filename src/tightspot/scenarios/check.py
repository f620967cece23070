"""Whether a vehicle can stand at start and goal at all: free, inside the workspace, within its limits."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import Problem, SceneError
from tightspot.geometry import clearance as signed_distance
from tightspot.problems import shortened
from tightspot.scenarios.clearances import (
    Clearance,
    body_vertices,
    clearances,
    workspace_excess,
)
from tightspot.scenarios.scenario import Scenario
from tightspot.scenarios.states import STATE
from tightspot.vehicles import VehicleModel

Array = NDArray[np.float64]

SLACK = 1e-9
"""Rounding that is forgiven, m, m/s, rad."""
FARTHEST = 2.0
"""A better place for a bad pose is sought up to this far away, m."""

_SIDES = {(1, 0): "right (+x)", (-1, 0): "left (-x)", (0, 1): "upper (+y)", (0, -1): "lower (-y)"}


def check(scenario: Scenario, vehicle: VehicleModel, margin: float) -> None:
    """Refuse a scene whose start or goal this vehicle cannot take with this clearance.

    Args:
        scenario: The scene.
        vehicle: The vehicle that shall drive.
        margin: Demanded clearance, m.

    Raises:
        SceneError: With all problems: which obstacle is overlapped and how deep, or is too near; how far the
            body leaves the workspace on which side; where the pose would do; which state is beyond the
            vehicle's limits.
    """
    problems = []
    if not (np.isfinite(margin) and margin >= 0):
        raise SceneError(Problem("margin", f"{margin} m must be a finite clearance of 0 m or more"))
    for key in ("start", "goal"):
        state = getattr(scenario, key)
        problems += _limit_problems(key, state, vehicle)
        pose_problems = _obstacle_problems(key, state, scenario, vehicle, margin)
        pose_problems += _workspace_problems(key, state, scenario, vehicle)
        if pose_problems:
            advice = _advice(state, scenario, vehicle, margin)
            problems += [Problem(problem.path, f"{problem.message}; {advice}") for problem in pose_problems]
    if problems:
        raise SceneError(shortened(problems))


def _limit_problems(key: str, state: Array, vehicle: VehicleModel) -> list[Problem]:
    problems = []
    bounds = zip(vehicle.state_names, vehicle.state_units, *vehicle.state_bounds, strict=True)
    for name, unit, low, high in bounds:
        value = state[STATE.index(name)] if name in STATE else 0.0
        if value < low - SLACK or value > high + SLACK:
            sentence = f"{value:g} {unit} is outside the limits [{low:.4g}, {high:.4g}] of vehicle {vehicle.name!r}"
            problems.append(Problem(f"{key}.{name}", sentence))
    return problems


def _obstacle_problems(
    key: str, state: Array, scenario: Scenario, vehicle: VehicleModel, margin: float
) -> list[Problem]:
    near = clearances(scenario, vehicle, state, reach=margin)
    return [_obstacle_problem(key, found, margin) for found in near if found.value < margin - SLACK]


def _obstacle_problem(key: str, found: Clearance, margin: float) -> Problem:
    body, obstacle = f"the vehicle's {found.part}", f"obstacle {found.obstacle!r}"
    if found.value < 0:
        return Problem(key, f"{body} overlaps {obstacle} by {-found.value:.3f} m")
    sentence = f"{body} is {found.value:.3f} m from {obstacle}, nearer than the margin of {margin:g} m"
    lower = np.floor(found.value * 1000) / 1000
    return Problem(key, f"{sentence}; lower the margin to {lower:g} m" if lower > 0 else sentence)


def _workspace_problems(key: str, state: Array, scenario: Scenario, vehicle: VehicleModel) -> list[Problem]:
    excess, normal = workspace_excess(scenario, vehicle, state)
    if excess <= SLACK:
        return []
    side = _SIDES.get((round(normal[0], 6), round(normal[1], 6)), f"({normal[0]:.2f}, {normal[1]:.2f})")
    return [Problem(key, f"the body reaches {excess:.3f} m out of the workspace on its {side} side")]


def _advice(state: Array, scenario: Scenario, vehicle: VehicleModel, margin: float) -> str:
    """The nearest place with the same heading that would do, as a remedy."""
    steps = _steps()
    allowed = np.ones(len(steps), dtype=bool)
    bodies = body_vertices(vehicle, state)
    W = scenario.workspace
    for _, vertices in bodies:
        moved = vertices + steps[:, None]
        allowed &= (moved @ W.A.T <= W.b + SLACK).all(axis=(1, 2))
    reach = FARTHEST + margin
    names = {found.obstacle for found in clearances(scenario, vehicle, state, reach)}
    parts = [part.vertices for o in scenario.obstacles if o.name in names for part in o.parts]
    for part in parts:
        low, high = part.min(axis=0) - margin, part.max(axis=0) + margin
        for _, vertices in bodies:
            beside = (steps + vertices.max(axis=0) <= low) | (steps + vertices.min(axis=0) >= high)
            rows = np.flatnonzero(allowed & ~beside.any(axis=1))
            allowed[rows] = signed_distance(vertices + steps[rows, None], part) >= margin
    if not allowed.any():
        return f"no place within {FARTHEST:g} m would do with this heading"
    x, y = steps[int(allowed.argmax())]
    return f"moved by ({x:+.2f}, {y:+.2f}) m it would fit"


def _steps() -> Array:
    """Small displacements, nearest first, on a grid of 5 cm, shape (m, 2)."""
    axis = np.arange(-FARTHEST, FARTHEST + 0.025, 0.05)
    grid = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    length = np.hypot(*grid.T)
    order = np.argsort(length, kind="stable")
    steps: Array = grid[order[length[order] <= FARTHEST]]
    return steps
