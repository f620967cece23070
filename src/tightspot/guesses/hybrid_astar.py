"""Hybrid A*: a collision-free path by search, driven exactly."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from tightspot.guesses.base import Guess, GuessResult, as_single_track, known
from tightspot.guesses.lift import Arc, lift_arcs
from tightspot.scenarios.bottleneck import is_closed
from tightspot.scenarios.scenario import Scenario
from tightspot.search import HybridAStarOptions, SearchResult, search
from tightspot.vehicles.base import VehicleModel

MORE_THAN_MARGIN = (0.05, 0.02, 0.0)


@dataclass(frozen=True)
class HybridAStar(Guess):
    """A path of arcs that keeps clear of the obstacles, lifted to a trajectory that the vehicle can drive.

    The search asks for somewhat more than the demanded margin first, then for the margin, then for half of it: the
    optimiser can still find the room that the search's resolution hides. If the first resolution is in vain and the way
    is provably closed for the demanded margin, that is all.

    Attributes:
        options: The search's; its margins are relative to the demanded one here if ``None``.

    Reference: Dolgov, Thrun, Montemerlo, Diebel: Path planning for autonomous vehicles in unknown semi-structured
    environments, IJRR 2010; the paper's third guess.
    """

    name: ClassVar[str] = "hybrid-astar"
    collision_free: ClassVar[bool] = True
    options: HybridAStarOptions | None = None

    def make(self, scenario: Scenario, vehicle: VehicleModel, *, margin: float) -> GuessResult:
        car = as_single_track(vehicle, self.name)
        options = self.options
        if options is None:
            margins = (*(margin + more for more in MORE_THAN_MARGIN), margin / 2)
            options = replace(HybridAStarOptions(), margins=tuple(dict.fromkeys(margins)), time_limit=10.0)
        obstacles = [polygon for _, polygon in scenario.obstacle_parts]
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
            return GuessResult(None, result.explain(), _report(result), result)
        arcs = [Arc(float(length), float(curvature)) for length, curvature in result.path.arcs]
        trajectory = lift_arcs(arcs, np.asarray(scenario.start), float(scenario.goal[4]), car)
        return GuessResult(trajectory, result.explain(), _report(result), result)


def _report(result: SearchResult) -> dict[str, Any]:
    return {
        "status": result.status.name,
        "expansions": result.expansions,
        "search_seconds": result.seconds,
        "path_length": result.path.length if result.path else None,
        "gear_changes": result.path.gear_changes if result.path else None,
        "attempts": [attempt.describe() for attempt in result.attempts],
    }
