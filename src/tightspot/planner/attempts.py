"""Quick plan attempts under a common deadline: would it work with less?"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from tightspot.errors import PlanningError
from tightspot.guesses import Arc, HybridAStar, LinearInterpolation, lift_arcs
from tightspot.guesses.base import known
from tightspot.guesses.hybrid_astar import MORE_THAN_MARGIN
from tightspot.planner.course import certified, run_rounds
from tightspot.planner.mesh import steps_for
from tightspot.planner.passing import Verdict
from tightspot.planner.penetration import Penetration
from tightspot.planner.progress import Progress, ProgressCallback
from tightspot.planner.request import Request
from tightspot.planner.shallowest import shallowest, soft_solvers
from tightspot.scenarios.bottleneck import is_closed
from tightspot.scenarios.remedies import fits
from tightspot.search import COARSE, MEDIUM, HybridAStarOptions, shortest_path
from tightspot.trajectory import Trajectory
from tightspot.vehicles import SingleTrack

SEARCH_SECONDS = 1.0
ATTEMPT_SECONDS = 4.0
PATIENCE = 6.0
PENETRATION_SECONDS = 5.0
ROUNDS = 5


class Start(NamedTuple):
    """A trajectory to begin with, and where it is from."""

    name: str
    trajectory: Trajectory


def colliding_starts(request: Request, last: Trajectory | None) -> list[Start]:
    """Trajectories that do not care for obstacles, the most promising first: Reeds-Shepp, linear, the last iterate."""
    starts = []
    if isinstance(request.vehicle, SingleTrack):
        starts.append(Start("reeds-shepp", reeds_shepp(request, request.vehicle)))
    line = LinearInterpolation().make(request.scenario, request.vehicle, margin=request.margin).trajectory
    if line is not None:
        starts.append(Start("linear", line))
    return starts if last is None else [*starts, Start("last iterate", last)]


def reeds_shepp(request: Request, car: SingleTrack) -> Trajectory:
    """The shortest path of the car without obstacles, driven arc after arc."""
    start, goal = known(request.scenario.start), known(request.scenario.goal)
    path = shortest_path(start[:3], goal[:3], car.min_turning_radius)
    arcs = [Arc(float(length), float(curvature)) for length, curvature in path.arcs]
    return lift_arcs(arcs, np.asarray(request.scenario.start), float(request.scenario.goal[4]), car)


def least_penetration(request: Request, starts: Sequence[Start], deadline: float) -> Penetration | None:
    """The shallowest of the local minima from the starts; ``None`` if no solve ended well."""
    solvers = soft_solvers(request.vehicle)
    best: Penetration | None = None
    for start in starts:
        seconds = min(PENETRATION_SECONDS, deadline - time.perf_counter())
        if seconds <= 0 or (best is not None and _spare(best) >= request.margin):
            break
        try:
            found = shallowest(
                request.scenario,
                request.vehicle,
                start.trajectory,
                solvers,
                objective=request.objective,
                steps=request.steps or steps_for(start.trajectory),
                margin=request.margin,
                deadline=time.perf_counter() + seconds,
            )
        except PlanningError:
            continue
        if best is None or _spare(found) > _spare(best):
            best = found
    return best


def _spare(found: Penetration) -> float:
    """Smallest signed distance, m."""
    return np.inf if found.nearest is None else -found.nearest.depth


class Attempts:
    """Plans variants of a request from several starts; remembers the last trajectory that was certified.

    The solver's iterations are told on, so that the caller may interrupt, the attempts' own phases are not.
    """

    def __init__(self, request: Request, starts: Sequence[Start], tell: ProgressCallback, deadline: float) -> None:
        self.request, self.starts, self.tell, self.deadline = request, list(starts), tell, deadline
        self.found: Start | None = None

    def verdict(self, request: Request, patience: float = PATIENCE) -> Verdict:
        """Whether a certified plan is found for this request; no start is tried after ``patience`` seconds."""
        scene, car, margin = request.scenario, request.vehicle, request.margin
        if is_closed(scene, car, margin) or not all(
            fits(scene, car, state, margin) for state in (scene.start, scene.goal)
        ):
            return "impossible"
        request = replace(request, refinements=ROUNDS)
        given_up = time.perf_counter() + patience
        for start in self._ways(request):
            now = time.perf_counter()
            if now > self.deadline:
                return "no time"
            if now > given_up:
                return "fails"
            rounds = run_rounds(request, start.trajectory, self._listen, min(self.deadline, now + ATTEMPT_SECONDS))
            if certified(rounds):
                self.found = Start(start.name, rounds[-1].trajectory)
                return "passes"
        return "no time" if time.perf_counter() > self.deadline else "fails"

    def _listen(self, news: Progress) -> None:
        if news.iteration is not None:
            self.tell(news)

    def _ways(self, request: Request) -> Iterator[Start]:
        """Where to begin: the last way that was found, a path that is searched for now, the given starts."""
        if self.found is not None:
            yield self.found
        yield from self._searched(request)
        yield from self.starts

    def _searched(self, request: Request) -> list[Start]:
        """A path by hybrid A* at a moderate resolution, if the vehicle is one for it."""
        if not isinstance(request.vehicle, SingleTrack):
            return []
        margins = (*(request.margin + more for more in MORE_THAN_MARGIN), request.margin / 2)
        options = HybridAStarOptions(
            resolutions=(COARSE, MEDIUM), margins=tuple(dict.fromkeys(margins)), time_limit=SEARCH_SECONDS
        )
        found = HybridAStar(options).make(request.scenario, request.vehicle, margin=request.margin).trajectory
        return [] if found is None else [Start("hybrid-astar", found)]
