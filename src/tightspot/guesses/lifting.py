"""The ways to give a path times."""

from __future__ import annotations

from typing import Literal, get_args

from tightspot.errors import InputError, Problem
from tightspot.guesses.lift import Arc, lift_arcs
from tightspot.guesses.rolling import lift_rolling
from tightspot.scenarios.scenario import Scenario
from tightspot.search import Path
from tightspot.trajectory import Trajectory
from tightspot.vehicles.single_track import SingleTrack

Lift = Literal["rolling", "standing"]
"""Whether the wheels turn while the car rolls (:func:`lift_rolling`) or stands (:func:`lift_arcs`, which is exact)."""

_SHORTEST = 1e-3


def checked_lift(lift: str) -> None:
    """Raises :class:`InputError` if there is no such lift."""
    if lift not in get_args(Lift):
        raise InputError(Problem("guess.lift", f"{lift!r} is not known; choose one of {', '.join(get_args(Lift))}"))


def lift_path(path: Path, scenario: Scenario, vehicle: SingleTrack, lift: Lift) -> Trajectory:
    """The scenario's motion along a path from its start to its goal. Without a way, the car only steers."""
    goal_steering = float(scenario.goal[4])
    if lift == "rolling" and path.length > _SHORTEST:
        return lift_rolling(path, scenario.start, goal_steering, vehicle)
    arcs = [Arc(float(length), float(curvature)) for length, curvature in path.arcs]
    return lift_arcs(arcs, scenario.start, goal_steering, vehicle)
