"""Hybrid A*: a collision-free path by search, given times."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar

from tightspot.guesses.base import Guess, GuessResult, as_single_track, known
from tightspot.guesses.lifting import Lift, checked_lift, lift_path
from tightspot.guesses.perturbed import perturbed
from tightspot.scenarios.bottleneck import is_closed
from tightspot.scenarios.scenario import Scenario
from tightspot.search import HybridAStarOptions, SearchResult, search
from tightspot.vehicles.base import VehicleModel

MORE_THAN_MARGIN = (0.05, 0.02, 0.0)


def margins_for(margin: float) -> tuple[float, ...]:
    """Clearances to search for, the largest first, where ``margin`` is demanded, m."""
    return tuple(dict.fromkeys((*(margin + more for more in MORE_THAN_MARGIN), margin / 2)))


@lru_cache(maxsize=64)
def options_for(margin: float) -> HybridAStarOptions:
    """How to search where ``margin`` (m) is demanded, unless told otherwise."""
    return HybridAStarOptions(margins=margins_for(margin))


@dataclass(frozen=True)
class HybridAStar(Guess):
    """A path of arcs that keeps clear of the obstacles, lifted to a trajectory that the vehicle can drive.

    The search asks for somewhat more than the demanded margin first, then for the margin, then for half of it: the
    optimiser can still find the room that the search's resolution hides. If the first resolution is in vain and the way
    is provably closed for the demanded margin, that is all.

    Attributes:
        options: The search's; its margins are relative to the demanded one here if ``None``.
        seed: If given, what gear changes, reverse and steering cost, the tightest turn and the end to begin at are
            drawn at random: another course of the same scene, the same for the same seed.
        lift: ``rolling`` steers while it drives; ``standing`` is exact and steers at standstill.

    Raises:
        InputError: If there is no such lift.

    Reference: Dolgov, Thrun, Montemerlo, Diebel: Path planning for autonomous vehicles in unknown semi-structured
    environments, IJRR 2010; the paper's third guess.
    """

    name: ClassVar[str] = "hybrid-astar"
    collision_free: ClassVar[bool] = True
    options: HybridAStarOptions | None = None
    seed: int | None = None
    lift: Lift = "rolling"

    def __post_init__(self) -> None:
        checked_lift(self.lift)

    def make(self, scenario: Scenario, vehicle: VehicleModel, *, margin: float) -> GuessResult:
        car = as_single_track(vehicle, self.name)
        options = self.options or options_for(margin)
        if self.seed is not None:
            options = perturbed(options, self.seed)
        obstacles = scenario.obstacle_polygons
        start, goal = known(scenario.start), known(scenario.goal)
        result = search(
            scenario.workspace,
            obstacles,
            car,
            start[:3],
            goal[:3],
            options,
            is_hopeless=lambda: is_closed(scenario, car, margin),
        )
        if result.path is None:
            return GuessResult(None, result.explain(), report_of(result), result)
        trajectory = lift_path(result.path, scenario, car, self.lift)
        return GuessResult(trajectory, result.explain(), report_of(result), result)


def report_of(result: SearchResult) -> dict[str, Any]:
    """What was tried, as plain data."""
    return {
        "status": result.status.name,
        "expansions": result.expansions,
        "search_seconds": result.seconds,
        "path_length": result.path.length if result.path else None,
        "gear_changes": result.path.gear_changes if result.path else None,
        "attempts": [attempt.describe() for attempt in result.attempts],
    }
