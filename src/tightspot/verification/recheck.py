"""The checker's own evaluation of the checks that are not about clearance."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tightspot.scenarios import Scenario
from tightspot.trajectory import Trajectory
from tightspot.vehicles import VehicleModel
from tightspot.verification.certificate import Certificate
from tightspot.verification.quadrature import CheckedMotion

Array = NDArray[np.float64]

# The limits of the file format: a file may not grant itself more.
DEFECT, BOUNDS, START, WORKSPACE = 5e-3, 1e-6, 1e-6, -1e-6
# How far the judge's number may be from the checker's: twice the judge's integration tolerance.
_ALLOWED = 2e-7


class _Expected(NamedTuple):
    name: str
    value: float
    limit: float


def reevaluate(
    scenario: Scenario,
    vehicle: VehicleModel,
    trajectory: Trajectory,
    certificate: Certificate,
    motion: CheckedMotion,
) -> Iterator[str]:
    """Every listed check against the checker's own number; yields what is wrong."""
    expected = list(_expected(scenario, vehicle, trajectory, motion))
    names = ["obstacles", "workspace", *(check.name for check in expected)]
    if [check.name for check in certificate.checks] != names:
        yield f"the checks are not {names}"
        return
    obstacles, workspace, *others = certificate.checks
    if not all(check.passed for check in certificate.checks):
        yield "a check did not pass, so the plan cannot be certified"
    if obstacles.value != certificate.clearance or obstacles.limit != certificate.margin:
        yield "the check of the obstacles does not repeat the certificate's clearance and margin"
    proved = min((float(proof.clearance.min()) for proof in certificate.workspace), default=math.inf)
    if not (workspace.value <= proved and workspace.value >= WORKSPACE == workspace.limit):
        yield "the check of the workspace does not follow from its proofs"
    for check, own in zip(others, expected, strict=True):
        if check.limit != own.limit:
            yield f"the limit of {check.name} is {own.limit:g}, not {check.limit:g}"
        too_little = check.value < own.value - _ALLOWED
        # How far a bound is exceeded depends on where one looks: more than the checker sees may be admitted.
        if too_little or not (check.value <= own.value + _ALLOWED or check.name == "state bounds"):
            yield f"{check.name} is {own.value:g}, not {check.value:g}"
        if not (check.value <= own.limit and own.value <= own.limit + _ALLOWED):
            yield f"{check.name} does not pass: {own.value:g} is more than {own.limit:g}"


def _expected(
    scenario: Scenario, vehicle: VehicleModel, trajectory: Trajectory, motion: CheckedMotion
) -> Iterator[_Expected]:
    at_knots = motion.states[np.searchsorted(motion.times, trajectory.t)]
    apart = trajectory.states - at_knots
    yield _Expected("dynamics position", float(np.sqrt((apart[:, :2] ** 2).sum(axis=1)).max()), DEFECT)
    yield _Expected("dynamics heading", max(map(_turn, apart[:, 2].tolist())), DEFECT)
    for place, name in enumerate(vehicle.state_names):
        if place >= 3:
            group = {"v": "speed", "delta": "steering"}.get(name, name)
            yield _Expected(f"dynamics {group}", float(np.abs(apart[:, place]).max()), DEFECT)
    visited = np.vstack([trajectory.states, motion.states])
    yield _Expected("state bounds", _excess(visited, vehicle.state_bounds), BOUNDS)
    yield _Expected("input bounds", _excess(trajectory.inputs, vehicle.input_bounds), BOUNDS)
    names = vehicle.state_names
    for group, value in _apart(names, trajectory.states[0], scenario.start):
        yield _Expected(f"start {group}", value, START)
    for group, value in _apart(names, motion.states[-1], scenario.goal):
        yield _Expected(f"goal {group}", value, float(getattr(scenario.tolerance, group)))


def _excess(values: Array, bounds: tuple[Array, Array]) -> float:
    low, high = bounds
    return max(0.0, float((low - values).max()), float((values - high).max()))


def _apart(names: tuple[str, ...], state: Array, wanted: Array) -> Iterator[tuple[str, float]]:
    known = [i for i in (0, 1) if not math.isnan(wanted[i])]
    if known:
        yield "position", math.sqrt(sum((state[i] - wanted[i]) ** 2 for i in known))
    for group, name, place in (("heading", "theta", 2), ("speed", "v", 3), ("steering", "delta", 4)):
        if name in names and not math.isnan(wanted[place]):
            gap = float(state[names.index(name)] - wanted[place])
            yield group, _turn(gap) if name == "theta" else abs(gap)


def _turn(angle: float) -> float:
    """Smallest absolute value of the angle plus multiples of 2 pi."""
    rest = math.fmod(abs(angle), 2 * math.pi)
    return min(rest, 2 * math.pi - rest)
