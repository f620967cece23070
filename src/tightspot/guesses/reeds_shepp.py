"""A Reeds-Shepp path: drivable, and blind to obstacles."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar

from tightspot.errors import InputError, Problem
from tightspot.guesses.base import Guess, GuessResult, as_single_track, known
from tightspot.guesses.lifting import Lift, checked_lift, lift_path
from tightspot.scenarios.scenario import Scenario
from tightspot.search import ReedsSheppPath, all_paths
from tightspot.vehicles.base import VehicleModel


@dataclass(frozen=True)
class ReedsShepp(Guess):
    """One of the words of full steering and straight driving that join start and goal, obstacles or not.

    Attributes:
        rank: 0 for the cheapest word, 1 for the next, and so on: other gears, other sides.
        gear_change: Price of a gear change, m of driving; the way itself costs its length.
        curvature_factor: Curvature of the turns, relative to the vehicle's largest.
        lift: How the path is given times.

    Raises:
        InputError: If a number is out of its range.

    Reference: J. A. Reeds, L. A. Shepp: Optimal paths for a car that goes both forwards and backwards, Pacific Journal
    of Mathematics 145(2), 1990.
    """

    name: ClassVar[str] = "reeds-shepp"
    collision_free: ClassVar[bool] = False
    rank: int = 0
    gear_change: float = 2.0
    curvature_factor: float = 0.95
    lift: Lift = "rolling"

    def __post_init__(self) -> None:
        checked_lift(self.lift)
        problems = []
        if not (self.rank >= 0 and self.rank == int(self.rank)):
            problems.append(Problem("guess.rank", f"{self.rank} must be a whole number, 0 or more"))
        if not 0 <= self.gear_change < float("inf"):
            problems.append(Problem("guess.gear_change", f"{self.gear_change} m must be 0 or more"))
        if not 0 < self.curvature_factor <= 1:
            problems.append(Problem("guess.curvature_factor", f"{self.curvature_factor} must be above 0, at most 1"))
        if problems:
            raise InputError(problems)

    def make(self, scenario: Scenario, vehicle: VehicleModel, *, margin: float) -> GuessResult:
        car = as_single_track(vehicle, self.name)
        start, goal = known(scenario.start)[:3], known(scenario.goal)[:3]
        words = sorted(all_paths(start, goal, car.min_turning_radius / self.curvature_factor), key=self._cost)
        if self.rank >= len(words):
            return GuessResult(None, f"There are only {len(words)} Reeds-Shepp words from start to goal.")
        word = words[self.rank]
        path = word.sample()
        reason = (
            f"Reeds-Shepp word {word.word or 'of no length'}, {word.length:.1f} m long with {path.gear_changes} gear "
            "changes; obstacles were not looked at."
        )
        report = {"word": word.word, "words": len(words), "path_length": word.length, "gear_changes": path.gear_changes}
        return GuessResult(lift_path(path, scenario, car, self.lift), reason, report, word)

    def _cost(self, word: ReedsSheppPath) -> float:
        gears = [segment.length < 0 for segment in word.segments]
        changes = sum(before != after for before, after in pairwise(gears))
        return word.length + self.gear_change * changes
