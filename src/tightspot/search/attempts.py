"""One attempt of hybrid A*: arguments into the core's form, its answer into ours."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from tightspot.errors import InputError, Problem
from tightspot.geometry.polygon import ConvexPolygon
from tightspot.geometry.stack import PolygonStack
from tightspot.search.core import compiled_core
from tightspot.search.options import Direction, HybridAStarOptions
from tightspot.search.path import Array
from tightspot.search.resolution import Resolution
from tightspot.search.result import Attempt, SearchStatus
from tightspot.vehicles.base import BodyPart

if TYPE_CHECKING:
    from tightspot import _core

_OUTCOMES = {
    "found": SearchStatus.FOUND,
    "exhausted": SearchStatus.EXHAUSTED,
    "disconnected": SearchStatus.EXHAUSTED,
    "expansion_limit": SearchStatus.LIMIT_REACHED,
    "time_limit": SearchStatus.TIME_LIMIT,
    "start_blocked": SearchStatus.START_BLOCKED,
    "goal_blocked": SearchStatus.GOAL_BLOCKED,
}
_BLOCKED = (SearchStatus.START_BLOCKED, SearchStatus.GOAL_BLOCKED)


class Scene:
    """What stays the same in all attempts of a search; see :func:`tightspot.search.search`.

    Raises:
        InputError: A body part is not fixed to the rear-axle frame.
    """

    def __init__(
        self,
        workspace: ConvexPolygon,
        obstacles: Sequence[ConvexPolygon],
        parts: Sequence[BodyPart],
        radius: float,
        start: Array,
        goal: Array,
        options: HybridAStarOptions,
    ) -> None:
        moving = [part.name for part in parts if part.frame != 0]
        if moving:
            raise InputError(
                Problem("vehicle", f"hybrid A* needs a rigid body, but {', '.join(moving)} turns on its own")
            )
        self.parts = [np.ascontiguousarray(part.polygon.vertices) for part in parts]
        self.workspace = np.ascontiguousarray(workspace.vertices)
        self.obstacles = PolygonStack.of(obstacles)
        self.curvature = options.curvature_factor / radius
        self.start, self.goal, self.options = start, goal, options

    def attempt(
        self, resolution: Resolution, margin: float, direction: Direction, seconds: float
    ) -> tuple[Attempt, Array, Array]:
        """One search: its record, the path's arcs (m, 2) if any, the poses expanded (n, 3) if kept."""
        core = compiled_core()
        solids = self.obstacles
        checker = core.CollisionChecker(self.parts, self.workspace, solids.vertices, solids.first, margin)
        direction = self._resolved(direction, checker)
        settings = self._settings(resolution, checker.narrowest)
        settings.backward = direction is Direction.BACKWARD
        settings.time_limit = seconds
        answer: _core.SearchAnswer = core.search(checker, self.start, self.goal, settings, self.options.shortcuts)
        return _record(resolution, margin, direction, answer), answer["arcs"], answer["closed"]

    def _resolved(self, direction: Direction, checker: _core.CollisionChecker) -> Direction:
        if direction in (Direction.FORWARD, Direction.BACKWARD):
            return direction
        start_is_tight = self._room(checker, self.start) < self._room(checker, self.goal)
        begins_at_start = start_is_tight == (direction is Direction.TIGHT_END)
        return Direction.FORWARD if begins_at_start else Direction.BACKWARD

    def _room(self, checker: _core.CollisionChecker, pose: Array) -> float:
        """How far the car gets from a pose on full left, straight and full right, both ways, all added, m."""
        far = 3 * checker.narrowest
        curvatures = (-self.curvature, 0.0, self.curvature)
        return sum(abs(checker.free_length(pose, way, k)) for way in (-far, far) for k in curvatures)

    def _settings(self, resolution: Resolution, width: float) -> _core.SearchOptions:
        core, options = compiled_core(), self.options
        cost: _core.MotionCost = core.MotionCost()
        cost.gear_change = options.gear_change
        cost.reverse = options.reverse
        cost.steering = options.steering
        cost.steering_change = options.steering_change
        cost.full_curvature = self.curvature
        settings: _core.SearchOptions = core.SearchOptions()
        settings.cost = cost
        settings.full_curvature = self.curvature
        settings.cell = resolution.cell * width
        settings.step = resolution.step * width
        settings.heading_bins = resolution.heading_bins
        settings.halvings = resolution.halvings
        settings.patience = resolution.patience
        settings.gears = (options.gears.first, options.gears.last)
        settings.tolerance = options.tolerance
        settings.max_expansions = min(resolution.max_expansions, options.max_expansions)
        settings.steering = _steering(resolution, options)
        settings.heuristic_weight = options.heuristic_weight
        settings.max_words = options.max_words
        settings.extra_expansions = options.extra_expansions
        settings.keep_closed = options.keep_closed
        return settings


def _steering(resolution: Resolution, options: HybridAStarOptions) -> Sequence[float]:
    """Curvatures to try, parts of the largest."""
    if not resolution.steering_halvings:
        return _evenly_spaced(options.steering_levels)
    left = [0.5**halved for halved in range(resolution.steering_halvings + 1)]
    return sorted([*left, 0.0, *(-part for part in left)])


@cache
def _evenly_spaced(levels: int) -> tuple[float, ...]:
    return tuple(np.linspace(-1.0, 1.0, levels).tolist())


def _record(resolution: Resolution, margin: float, direction: Direction, answer: _core.SearchAnswer) -> Attempt:
    outcome = _OUTCOMES[answer["outcome"]]
    is_blocked = outcome in _BLOCKED
    return Attempt(
        resolution=resolution,
        margin=margin,
        direction=direction,
        outcome=outcome,
        is_final=is_blocked or answer["outcome"] == "disconnected",
        expansions=answer["expansions"],
        nodes=answer["nodes"],
        pose_checks=answer["pose_checks"],
        pair_tests=answer["pair_tests"],
        seconds=answer["seconds"],
        cost=answer["cost"] if outcome is SearchStatus.FOUND else None,
        blocking=answer["blocking"] if is_blocked else None,
        clearance=answer["clearance"] if is_blocked else None,
    )
