"""Hybrid A*: a collision-free path for an exact polygonal body, or what was tried in vain.

D. Dolgov, S. Thrun, M. Montemerlo, J. Diebel: Path planning for autonomous vehicles in unknown
semi-structured environments, International Journal of Robotics Research 29(5), 2010.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from tightspot.geometry.polygon import ConvexPolygon
from tightspot.search.attempts import Scene
from tightspot.search.options import Direction, HybridAStarOptions
from tightspot.search.path import Array, Path, pose_of
from tightspot.search.resolution import Resolution
from tightspot.search.result import Attempt, SearchResult, SearchStatus
from tightspot.vehicles.base import BodyPart

WINDING = 10
SECONDS_MORE = 0.5
"""For a better path than one that changes gears more than ``WINDING`` times."""


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
    *,
    is_hopeless: Callable[[], bool] | None = None,
) -> SearchResult:
    """A path on which the body keeps a margin to all obstacles and stays in the workspace.

    Searches with every combination of resolution and margin of the options, the coarsest first, until one
    finds a path. If it changes gears more than ``WINDING`` times, the next ones are tried for a moment, too: the
    cheapest path counts. Between samples of an arc the motion is covered by the clearances at its ends, so the path
    keeps its margin everywhere, to within a thousandth of the body's width, and not at samples only.

    Args:
        workspace: W; the body stays inside and may touch its border.
        obstacles: Convex, any number of vertices.
        vehicle: Its body (any number of convex parts, fixed to the rear-axle frame) and its turning radius.
        start: (x m, y m, theta rad) of the rear-axle midpoint.
        goal: The same.
        options: Defaults to :class:`HybridAStarOptions`.
        is_hopeless: Asked once if the first resolution was in vain; true ends the search.

    Returns:
        A result; its ``path`` is ``None`` unless its ``status`` is ``FOUND``; ``attempts`` is what was tried, the one
        that found the path last.

    Raises:
        InputError: A pose is not three finite numbers, or a body part is not fixed to the rear-axle frame.
        BuildError: The compiled core is missing.
    """
    options = options or HybridAStarOptions()
    start, goal = pose_of(start, "start"), pose_of(goal, "goal")
    scene = Scene(workspace, obstacles, vehicle.parts, vehicle.min_turning_radius, start, goal, options)
    attempts: list[Attempt] = []
    closed: list[Array] = []
    best: tuple[Path, Attempt] | None = None
    deadline = time.monotonic() + options.time_limit
    first = options.resolutions[0]
    for resolution, margin, direction in _ladder(options):
        seconds_left = deadline - time.monotonic()
        if _is_settled(resolution, margin, attempts) or (attempts and seconds_left <= 0):
            continue
        if is_hopeless is not None and resolution is not first:
            if is_hopeless():
                break
            is_hopeless = None
        attempt, arcs, poses = scene.attempt(resolution, margin, direction, seconds_left)
        attempts.append(attempt)
        closed.append(poses)
        if attempt.outcome is SearchStatus.FOUND:
            path = Path.from_arcs(start, arcs, options.spacing, goal)
            if best is None:
                deadline = min(deadline, time.monotonic() + SECONDS_MORE)
            if best is None or _cost(attempt) < _cost(best[1]):
                best = path, attempt
            if path.gear_changes <= WINDING:
                break
    if best is not None:
        path, chosen = best
        attempts.sort(key=lambda attempt: attempt is chosen)
        return SearchResult(SearchStatus.FOUND, path, tuple(attempts), np.concatenate(closed))
    return SearchResult(_verdict(attempts), None, tuple(attempts), np.concatenate(closed))


def _cost(attempt: Attempt) -> float:
    return np.inf if attempt.cost is None else attempt.cost


def _ladder(options: HybridAStarOptions) -> Iterator[tuple[Resolution, float, Direction]]:
    return itertools.product(options.resolutions, options.margins, options.directions)


def _is_settled(resolution: Resolution, margin: float, attempts: Sequence[Attempt]) -> bool:
    """Whether earlier attempts leave no hope with this margin, or exhausted it at this resolution."""
    return any(
        attempt.is_final or (attempt.resolution is resolution and attempt.outcome is SearchStatus.EXHAUSTED)
        for attempt in attempts
        if attempt.margin == margin
    )


def _verdict(attempts: Sequence[Attempt]) -> SearchStatus:
    """Of attempts that all failed: what the smallest margin came to, being exhausted above all."""
    smallest = min(attempt.margin for attempt in attempts)
    outcomes = [attempt.outcome for attempt in attempts if attempt.margin == smallest]
    return SearchStatus.EXHAUSTED if SearchStatus.EXHAUSTED in outcomes else outcomes[-1]
