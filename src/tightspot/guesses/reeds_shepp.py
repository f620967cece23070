"""A Reeds-Shepp path: drivable, and blind to obstacles."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar

from tightspot.errors import InputError, Problem
from tightspot.guesses.base import Guess, GuessResult, as_single_track, known
from tightspot.guesses.lifting import Lift, checked_lift, lift_path
from tightspot.scenarios.scenario import Scenario
from tightspot.search import ReedsSheppPath, all_paths, blocked_shares
from tightspot.vehicles.base import VehicleModel
from tightspot.vehicles.single_track import SingleTrack

SPACING = 0.25
MOST_BLOCKED = 0.3
"""A word that is blocked on more of its way seldom leads anywhere."""


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
        words = self._words(scenario, car)
        if self.rank >= len(words):
            return GuessResult(None, f"There are only {len(words)} Reeds-Shepp words from start to goal.")
        return self._result(words[self.rank], len(words), scenario, car, "obstacles were not looked at")

    def least_blocked(
        self, scenario: Scenario, vehicle: VehicleModel, count: int, *, margin: float, most: float = MOST_BLOCKED
    ) -> list[GuessResult]:
        """The words on whose way least stands: up to ``count``, the least blocked first, of equals the cheapest.

        Every word comes with its mirror images in gear and in side, as far as these join start and goal, too.

        Args:
            scenario: The scene, in its own (recentred) coordinates.
            vehicle: A single-track vehicle.
            count: Most guesses wanted.
            margin: Clearance that a pose needs to be free, m.
            most: Words of whose poses a larger share is blocked are left out.

        Raises:
            InputError: If the vehicle is not of the single-track model.
        """
        car = as_single_track(vehicle, self.name)
        words = self._words(scenario, car)
        obstacles = scenario.obstacle_polygons
        paths = [word.sample(SPACING) for word in words]
        shares = blocked_shares(scenario.workspace, obstacles, car, paths, margin)
        order = sorted((index for index in range(len(words)) if shares[index] <= most), key=lambda index: shares[index])
        return [
            self._result(
                words[index], len(words), scenario, car, f"{100 * shares[index]:.0f} % of its poses are blocked"
            )
            for index in order[:count]
        ]

    def _words(self, scenario: Scenario, car: SingleTrack) -> list[ReedsSheppPath]:
        start, goal = known(scenario.start)[:3], known(scenario.goal)[:3]
        return sorted(all_paths(start, goal, car.min_turning_radius / self.curvature_factor), key=self._cost)

    def _result(self, word: ReedsSheppPath, words: int, scenario: Scenario, car: SingleTrack, note: str) -> GuessResult:
        path = word.sample()
        reason = (
            f"Reeds-Shepp word {word.word or 'of no length'}, {word.length:.1f} m long with {path.gear_changes} gear "
            f"changes; {note}."
        )
        report = {"word": word.word, "words": words, "path_length": word.length, "gear_changes": path.gear_changes}
        return GuessResult(lift_path(path, scenario, car, self.lift), reason, report, word)

    def _cost(self, word: ReedsSheppPath) -> float:
        gears = [segment.length < 0 for segment in word.segments]
        changes = sum(before != after for before, after in pairwise(gears))
        return word.length + self.gear_change * changes
