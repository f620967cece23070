"""Hybrid A*: a collision-free path for an exact polygonal body, or what was tried in vain.

D. Dolgov, S. Thrun, M. Montemerlo, J. Diebel: Path planning for autonomous vehicles in unknown semi-structured
environments, International Journal of Robotics Research 29(5), 2010.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tightspot.errors import InputError, Problem
from tightspot.geometry.polygon import ConvexPolygon
from tightspot.search.core import compiled_core
from tightspot.search.options import Direction, HybridAStarOptions, Resolution
from tightspot.search.path import Path, pose_of
from tightspot.search.result import Attempt, SearchResult, SearchStatus
from tightspot.vehicles.base import BodyPart

if TYPE_CHECKING:
    from tightspot import _core

Array = NDArray[np.float64]


class Car(Protocol):
    """What the search needs of a vehicle; every :class:`tightspot.vehicles.SingleTrack` has it."""

    @property
    def parts(self) -> tuple[BodyPart, ...]: ...

    @property
    def min_turning_radius(self) -> float: ...


def search(
    workspace: ConvexPolygon,
    obstacles: Sequence[ConvexPolygon],
    vehicle: Car,
    start: ArrayLike,
    goal: ArrayLike,
    options: HybridAStarOptions | None = None,
) -> SearchResult:
    """A path from start to goal on which the body keeps a margin to all obstacles and stays in the workspace.

    Searches with every combination of resolution and margin of the options, the coarsest first, until one finds a
    path. Between samples of an arc the motion is covered by the clearances at its ends, so the path keeps its
    margin to within 2 mm everywhere, not at samples only.

    Args:
        workspace: W; the body stays inside and may touch its border.
        obstacles: Convex, any number of vertices.
        vehicle: Its body (any number of convex parts, all fixed to the rear-axle frame) and its turning radius.
        start: (x m, y m, theta rad) of the rear-axle midpoint.
        goal: The same.
        options: Defaults to :class:`HybridAStarOptions`.

    Returns:
        A result whose ``path`` is ``None`` unless its ``status`` is ``FOUND``; ``attempts`` lists what was tried.

    Raises:
        InputError: A pose is not three finite numbers, or a body part is not fixed to the rear-axle frame.
        BuildError: The compiled core is missing.
    """
    options = options or HybridAStarOptions()
    start, goal = pose_of(start, "start"), pose_of(goal, "goal")
    scene = _Scene(workspace, tuple(obstacles), vehicle, start, goal, options)
    attempts: list[Attempt] = []
    closed: list[Array] = []
    deadline = time.monotonic() + options.time_limit
    hopeless: set[float] = set()
    for resolution, margin, direction in _ladder(options):
        seconds_left = deadline - time.monotonic()
        if margin in hopeless or seconds_left <= 0:
            continue
        answer = scene.attempt(resolution, margin, direction, seconds_left)
        attempt = _attempt(resolution, margin, direction, answer)
        attempts.append(attempt)
        closed.append(answer["closed"])
        if attempt.outcome is SearchStatus.FOUND:
            path = Path.from_arcs(start, answer["arcs"], options.spacing, goal)
            return SearchResult(SearchStatus.FOUND, path, tuple(attempts), _joined(closed))
        if attempt.outcome in (SearchStatus.START_BLOCKED, SearchStatus.GOAL_BLOCKED):
            hopeless.add(margin)
    return SearchResult(_verdict(attempts), None, tuple(attempts), _joined(closed))


class _Scene:
    """The arguments of one search in the core's form."""

    def __init__(
        self,
        workspace: ConvexPolygon,
        obstacles: tuple[ConvexPolygon, ...],
        vehicle: Car,
        start: Array,
        goal: Array,
        options: HybridAStarOptions,
    ) -> None:
        moving = [part.name for part in vehicle.parts if part.frame != 0]
        if moving:
            raise InputError(
                Problem("vehicle", f"hybrid A* needs a rigid body, but {', '.join(moving)} turns on its own")
            )
        self.parts = [np.ascontiguousarray(part.polygon.vertices) for part in vehicle.parts]
        self.workspace = np.ascontiguousarray(workspace.vertices)
        self.obstacles = [np.ascontiguousarray(obstacle.vertices) for obstacle in obstacles]
        self.curvature = options.curvature_factor / vehicle.min_turning_radius
        self.start, self.goal, self.options = start, goal, options

    def attempt(
        self, resolution: Resolution, margin: float, direction: Direction, seconds: float
    ) -> _core.SearchAnswer:
        core, options = compiled_core(), self.options
        checker = core.CollisionChecker(self.parts, self.workspace, self.obstacles, margin)
        cost = core.MotionCost()
        cost.gear_change = options.gear_change
        cost.reverse = options.reverse
        cost.steering = options.steering
        cost.steering_change = options.steering_change
        cost.full_curvature = self.curvature
        settings = core.SearchOptions()
        settings.cost = cost
        settings.full_curvature = self.curvature
        settings.cell = resolution.cell * checker.narrowest
        settings.step = resolution.step * checker.narrowest
        settings.heading_bins = resolution.heading_bins
        settings.max_expansions = min(resolution.max_expansions, options.max_expansions)
        settings.steering_levels = options.steering_levels
        settings.heuristic_weight = options.heuristic_weight
        settings.backward = direction is Direction.BACKWARD
        settings.max_words = options.max_words
        settings.improve = options.improve
        settings.time_limit = seconds
        settings.keep_closed = options.keep_closed
        answer: _core.SearchAnswer = core.search(checker, self.start, self.goal, settings, options.shortcuts)
        return answer


def _ladder(options: HybridAStarOptions) -> Iterator[tuple[Resolution, float, Direction]]:
    for resolution in options.resolutions:
        for margin in options.margins:
            for direction in options.directions:
                yield resolution, margin, direction


_OUTCOMES = {
    "found": SearchStatus.FOUND,
    "exhausted": SearchStatus.EXHAUSTED,
    "expansion_limit": SearchStatus.LIMIT_REACHED,
    "time_limit": SearchStatus.TIME_LIMIT,
    "start_blocked": SearchStatus.START_BLOCKED,
    "goal_blocked": SearchStatus.GOAL_BLOCKED,
}


def _attempt(resolution: Resolution, margin: float, direction: Direction, answer: _core.SearchAnswer) -> Attempt:
    outcome = _OUTCOMES[answer["outcome"]]
    is_blocked = outcome in (SearchStatus.START_BLOCKED, SearchStatus.GOAL_BLOCKED)
    return Attempt(
        resolution=resolution,
        margin=margin,
        direction=direction,
        outcome=outcome,
        expansions=answer["expansions"],
        nodes=answer["nodes"],
        pose_checks=answer["pose_checks"],
        pair_tests=answer["pair_tests"],
        seconds=answer["seconds"],
        cost=answer["cost"] if outcome is SearchStatus.FOUND else None,
        blocking=answer["blocking"] if is_blocked else None,
        clearance=answer["clearance"] if is_blocked else None,
    )


def _verdict(attempts: Sequence[Attempt]) -> SearchStatus:
    """Of attempts that all failed: what stopped them, the least final reason first."""
    outcomes = [attempt.outcome for attempt in attempts]
    for status in (SearchStatus.TIME_LIMIT, SearchStatus.LIMIT_REACHED, SearchStatus.EXHAUSTED):
        if status in outcomes:
            return status
    return outcomes[-1] if outcomes else SearchStatus.TIME_LIMIT


def _joined(closed: Sequence[Array]) -> Array:
    return np.concatenate(closed) if closed else np.empty((0, 3))
