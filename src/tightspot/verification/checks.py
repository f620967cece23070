"""The checks beside clearance: dynamics, limits, start and goal. Each is one number against one limit."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from tightspot.scenarios import Scenario
from tightspot.verification.certificate import Check
from tightspot.verification.replay import Replay

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Limits:
    """What the checks allow; the file format fixes these numbers.

    Attributes:
        defect_position: Knots may differ from the replay by this, m.
        defect_heading: The same for headings, rad.
        defect_state: The same for every other state, in its unit.
        bounds: States and inputs may exceed their bounds by this, in their units.
        start: The first state may differ from the scenario's start by this, in the states' units.
    """

    defect_position: float = 5e-3
    defect_heading: float = 5e-3
    defect_state: float = 5e-3
    bounds: float = 1e-6
    start: float = 1e-6


POSE = 3
"""A model's first states are x, y and theta."""

# Name of the check, the state it is about and its place in a scenario's start and goal, its unit.
_SCALARS = (("heading", "theta", 2, "rad"), ("speed", "v", 3, "m/s"), ("steering", "delta", 4, "rad"))

_GROUPS = {name: group for group, name, _, _ in _SCALARS}


def motion_checks(scenario: Scenario, replay: Replay, limits: Limits) -> list[Check]:
    """All checks that need no geometry, in the certificate's order."""
    return [
        *_dynamics(replay, limits),
        *_bounds(replay, limits),
        *_start(scenario, replay, limits),
        *_goal(scenario, replay),
    ]


def upper(name: str, value: float, limit: float, what: str, unit: str) -> Check:
    """A check that passes if ``value <= limit``."""
    return Check.of(name, bool(value <= limit), float(value), float(limit), partial(_at_most, what, value, unit, limit))


def _at_most(what: str, value: float, unit: str, limit: float) -> str:
    return f"{what} {value:.3g} {unit} (at most {limit:.3g})"


def _dynamics(replay: Replay, limits: Limits) -> Iterator[Check]:
    (position, heading), what = replay.defect, "knots differ from the replayed inputs by"
    yield upper("dynamics position", position, limits.defect_position, what, "m")
    yield upper("dynamics heading", heading, limits.defect_heading, what, "rad")
    names, units = replay.vehicle.state_names, replay.vehicle.state_units
    apart = replay.furthest.tolist()
    for name, unit, distance in list(zip(names, units, apart, strict=True))[POSE:]:
        group = _GROUPS.get(name, name)
        yield upper(f"dynamics {group}", distance, limits.defect_state, f"{group} at the knots: {what}", unit)


def _bounds(replay: Replay, limits: Limits) -> Iterator[Check]:
    """At the knots as stored, and at every node of the replay: between knots, too."""
    vehicle, trajectory = replay.vehicle, replay.trajectory
    states = (trajectory.states, replay.extremes)
    for kind, records, names, units, (low, high) in (
        ("state", states, vehicle.state_names, vehicle.state_units, vehicle.state_bounds),
        ("input", (trajectory.inputs,), vehicle.input_names, vehicle.input_units, vehicle.input_bounds),
    ):
        values = np.concatenate(records)
        excess = np.maximum(low - values, values - high).max(axis=0)
        worst = int(excess.argmax())
        what = f"{kind} {names[worst]} comes nearest to its bound or beyond: excess"
        yield upper(f"{kind} bounds", max(0.0, float(excess[worst])), limits.bounds, what, units[worst])


def _start(scenario: Scenario, replay: Replay, limits: Limits) -> Iterator[Check]:
    for group, unit, distance in _distances(replay, replay.node_states[0], scenario.start):
        yield upper(f"start {group}", distance, limits.start, f"start {group} differs from the scenario's by", unit)


def _goal(scenario: Scenario, replay: Replay) -> Iterator[Check]:
    for group, unit, distance in _distances(replay, replay.node_states[-1], scenario.goal):
        limit = float(getattr(scenario.tolerance, group))
        yield upper(f"goal {group}", distance, limit, f"goal {group} is missed by", unit)


def _distances(replay: Replay, state: Array, wanted: Array) -> Iterator[tuple[str, str, float]]:
    """(group, unit, distance) of the wanted state's entries that are not free (NaN)."""
    names = replay.vehicle.state_names
    there, asked = state.tolist(), wanted.tolist()
    apart = [there[i] - asked[i] for i in (0, 1) if not math.isnan(asked[i])]
    if apart:
        yield "position", "m", math.hypot(*apart)
    for group, name, place, unit in _SCALARS:
        if name not in names or math.isnan(asked[place]):
            continue
        gap = there[names.index(name)] - asked[place]
        yield group, unit, abs(gap - math.tau * round(gap / math.tau)) if name == "theta" else abs(gap)
