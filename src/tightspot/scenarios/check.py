"""Whether a vehicle can stand at start and goal at all: free, inside the workspace, within its limits."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import BlockedError, Problem, SceneError, is_number, shown
from tightspot.problems import shortened
from tightspot.scenarios.blocked import Blocked, blocked
from tightspot.scenarios.clearances import surely_free
from tightspot.scenarios.remedies import SLACK
from tightspot.scenarios.scenario import Scenario
from tightspot.scenarios.states import STATE
from tightspot.vehicles import VehicleModel

Array = NDArray[np.float64]

ENDS: tuple[Literal["start", "goal"], ...] = ("start", "goal")


def check(scenario: Scenario, vehicle: VehicleModel, margin: float) -> None:
    """Refuse a scene whose start or goal this vehicle cannot take with this clearance.

    Args:
        scenario: The scene.
        vehicle: The vehicle that shall drive.
        margin: Demanded clearance, m.

    Raises:
        BlockedError: With all problems: which obstacle is overlapped and how deep, or is too near; how far the body
            leaves the workspace on which side; which move, turn, width or margin would do; which state is beyond the
            vehicle's limits.
        SceneError: If only the vehicle's limits or the margin are in the way.
    """
    if not (is_number(margin) and 0 <= margin < np.inf):
        raise SceneError(Problem("margin", f"{shown(margin)} m must be a finite clearance of 0 m or more"))
    if _seen_at_once(scenario, vehicle, margin):
        return
    problems: list[Problem] = []
    ends: list[Blocked] = []
    for end in ENDS:
        problems += _limit_problems(end, getattr(scenario, end), vehicle)
        found = blocked(scenario, vehicle, margin, end)
        if found is not None:
            problems += found.problems
            ends.append(found)
    if ends:
        raise BlockedError(shortened(problems), ends)
    if problems:
        raise SceneError(shortened(problems))


def _seen_at_once(scenario: Scenario, vehicle: VehicleModel, margin: float) -> bool:
    """Whether both ends are plainly free and within the limits; false if one has to look closer."""
    if tuple(vehicle.state_names) != STATE:
        return False
    states = np.array([scenario.start, scenario.goal])
    states[np.isnan(states)] = 0.0
    low, high = vehicle.state_bounds
    return bool(((states >= low) & (states <= high)).all()) and surely_free(scenario, vehicle, states, margin, SLACK)


def _limit_problems(key: str, state: Array, vehicle: VehicleModel) -> list[Problem]:
    problems = []
    bounds = zip(vehicle.state_names, vehicle.state_units, *vehicle.state_bounds, strict=True)
    for name, unit, low, high in bounds:
        value = state[STATE.index(name)] if name in STATE else 0.0
        if value < low - SLACK or value > high + SLACK:
            sentence = f"{value:g} {unit} is outside the limits [{low:.4g}, {high:.4g}] of vehicle {vehicle.name!r}"
            problems.append(Problem(f"{key}.{name}", sentence))
    return problems
