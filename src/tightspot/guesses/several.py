"""Several guesses for one scene that differ in where the gears change and on which side things are passed."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem
from tightspot.geometry import ConvexPolygon
from tightspot.guesses.ahead import in_order
from tightspot.guesses.base import GuessResult, as_single_track, known
from tightspot.guesses.hybrid_astar import HybridAStar, report_of
from tightspot.guesses.lifting import Lift, checked_lift, lift_path
from tightspot.guesses.perturbed import drawn, generator
from tightspot.scenarios.scenario import Scenario
from tightspot.search import Direction, EndGears, HybridAStarOptions, Path, SearchResult, search
from tightspot.vehicles.base import VehicleModel
from tightspot.vehicles.single_track import SingleTrack

Array = NDArray[np.float64]

PATIENCE = 200
MORE_EXPANSIONS = 1000
EXTRA_EXPANSIONS = 100
SECONDS = 1.0
"""For each variant's search: it may be hasty, and it gives up early, for what takes long is seldom worth it."""
TRIES = 3
_GHOST = 0.1
_SAME = 0.25
_FRACTIONS = np.linspace(0.0, 1.0, 33)
_DEFAULT = HybridAStarOptions()

_PRICES: dict[str, dict[str, Any]] = {
    "forwards, then in reverse": {"gears": EndGears(1, -1)},
    "in reverse, then forwards": {"gears": EndGears(-1, 1)},
    "forwards at both ends": {"gears": EndGears(1, 1)},
    "in reverse at both ends": {"gears": EndGears(-1, -1)},
    "from the wider end": {"directions": (Direction.WIDE_END, Direction.TIGHT_END)},
    "few gear changes": {"gear_change": 10.0},
    "many gear changes": {"gear_change": 0.3, "steering_change": 0.1},
    "little reverse": {"reverse": 3.0},
    "little steering": {"steering": 0.5, "steering_change": 2.0},
    "in reverse at both ends, few gear changes": {"gears": EndGears(-1, -1), "gear_change": 10.0},
    "forwards at both ends, few gear changes": {"gears": EndGears(1, 1), "gear_change": 10.0},
}


@dataclass(frozen=True)
class _Trial:
    name: str
    changes: dict[str, Any]
    ghosts: tuple[ConvexPolygon, ...] = ()


@dataclass(frozen=True, eq=False)
class _Course:
    """What a trial found."""

    name: str
    result: SearchResult
    path: Path


@dataclass(frozen=True, eq=False)
class _Task:
    """What all trials have in common: the scene, and the margin and resolution at which the first search succeeded."""

    scenario: Scenario
    car: SingleTrack
    obstacles: list[ConvexPolygon]
    options: HybridAStarOptions
    lift: Lift

    def run(self, trial: _Trial) -> _Course | None:
        start, goal = known(self.scenario.start)[:3], known(self.scenario.goal)[:3]
        options = replace(self.options, **trial.changes)
        result = search(self.scenario.workspace, [*self.obstacles, *trial.ghosts], self.car, start, goal, options)
        return _Course(trial.name, result, result.path) if result.path is not None else None

    def guess(self, course: _Course) -> GuessResult:
        trajectory = lift_path(course.path, self.scenario, self.car, self.lift)
        reason = f"{course.result.explain()} Searched with: {course.name}."
        report = report_of(course.result) | {"variant": course.name, "cost": path_cost(course.path, self.car)}
        return GuessResult(trajectory, reason, report, course.result)


def variants(
    scenario: Scenario,
    vehicle: VehicleModel,
    count: int,
    seed: int = 0,
    *,
    margin: float | None = None,
    lift: Lift = "rolling",
    threads: int = 1,
    tries: int = TRIES,
    seconds: float = math.inf,
    first: GuessResult | None = None,
) -> list[GuessResult]:
    """Up to ``count`` guesses by hybrid A*, no two alike, the cheapest path first.

    Searched in turn: the default; the four ways to set out and arrive by gear; the other direction of search; other
    prices of gear changes, reverse and steering; then prices drawn at random, in every other search together with a
    small obstacle that is not there but stands in the first path's way. Two paths are alike if their gears change in
    the same order and they lie less than a quarter of the body's width apart on average. The same arguments give the
    same guesses, whatever the number of threads.

    Args:
        scenario: The scene, in its own (recentred) coordinates.
        vehicle: A single-track vehicle; its limits hold for the results.
        count: Most guesses wanted; fewer are returned if no more are found in a few tries for each.
        seed: Of what is drawn at random; 0 or more.
        margin: Clearance demanded, m; the scenario's by default. As with :class:`HybridAStar`, somewhat more is sought.
        lift: How the paths are given times.
        threads: Searches at a time; they do not hold Python's lock.
        tries: Random searches for each guess wanted, before the count is given up.
        seconds: After so long no further result is waited for: what is found then depends on the machine.
        first: What :class:`HybridAStar` found for the scene, if that is known.

    Returns:
        Guesses; ``report["variant"]`` says which search found each, ``report["cost"]`` its path's cost by the default
        prices. If there is no path, one result without a trajectory, with the reason.

    Raises:
        InputError: If an argument is out of its range, or the vehicle is not of the single-track model.
    """
    car = as_single_track(vehicle, "variants")
    checked_lift(lift)
    _check(count, threads)
    rng = generator(seed)
    margin = scenario.margin if margin is None else margin
    until = time.perf_counter() + seconds
    first = first or HybridAStar(lift=lift).make(scenario, car, margin=margin)
    found: SearchResult = first.details
    if found.path is None:
        return [first]
    last = found.attempts[-1]
    options = HybridAStarOptions(
        resolutions=(replace(last.resolution, patience=PATIENCE),),
        margins=(last.margin,),
        max_expansions=MORE_EXPANSIONS + 2 * last.expansions,
        extra_expansions=EXTRA_EXPANSIONS,
        time_limit=SECONDS,
    )
    task = _Task(scenario, car, list(scenario.obstacle_polygons), options, lift)
    width = min(np.ptp(np.vstack([part.polygon.vertices for part in car.parts]), axis=0))
    courses = [_Course("default", found, found.path)]
    for course in in_order(task.run, _trials(found.path, car, rng, tries * count), threads):
        if len(courses) >= count or time.perf_counter() > until:
            break
        if course and not any(alike(course.path, other.path, _SAME * width) for other in courses):
            courses.append(course)
    courses.sort(key=lambda course: path_cost(course.path, car))
    return [task.guess(course) for course in courses]


def alike(a: Path, b: Path, distance: float) -> bool:
    """Whether two paths change gears alike and lie less than ``distance`` m apart on average, by way driven."""
    return np.array_equal(_gears(a), _gears(b)) and bool(np.hypot(*(_at(a) - _at(b)).T).mean() < distance)


def path_cost(path: Path, car: SingleTrack, prices: HybridAStarOptions = _DEFAULT) -> float:
    """What a path costs, m of straight driving forwards; see :class:`HybridAStarOptions`."""
    lengths, curvatures = path.arcs.T
    turned = np.r_[0.0, curvatures, 0.0] * car.min_turning_radius / prices.curvature_factor
    ways = np.abs(lengths) * np.where(lengths < 0, prices.reverse, 1.0)
    driven = (ways * (1 + prices.steering * np.abs(turned[1:-1]))).sum()
    steered = np.abs(np.diff(turned)).sum()
    return float(driven + prices.steering_change * steered + prices.gear_change * path.gear_changes)


def _check(count: int, threads: int) -> None:
    problems = [
        Problem(name, f"{value} must be a whole number, 1 or more")
        for name, value in (("count", count), ("threads", threads))
        if not (value >= 1 and value == int(value))
    ]
    if problems:
        raise InputError(problems)


def _trials(path: Path, car: SingleTrack, rng: np.random.Generator, most: int) -> Iterator[_Trial]:
    """All that may be tried, drawn beforehand: later ones do not depend on what earlier ones find."""
    for name, changes in _PRICES.items():
        yield _Trial(name, changes)
    for number in range(int(most)):
        ghosts = _ghosts(path, car, rng) if number % 2 == 0 else ()
        yield _Trial(f"random {number}" + (", past a ghost" if ghosts else ""), drawn(rng), ghosts)


def _ghosts(path: Path, car: SingleTrack, rng: np.random.Generator) -> tuple[ConvexPolygon, ...]:
    """A small square on the path, out of the body's reach at both ends; none if the path is too short for that."""
    reach = max(part.polygon.radius for part in car.parts) * 1.05
    at = path.poses[:, :2]
    is_away = np.minimum(np.hypot(*(at - at[0]).T), np.hypot(*(at - at[-1]).T)) > reach + 0.2
    if not is_away.any():
        return ()
    x, y = at[rng.choice(np.flatnonzero(is_away))]
    half = _GHOST * car.min_turning_radius / 2
    return (ConvexPolygon.rectangle(x - half, x + half, y - half, y + half),)


def _gears(path: Path) -> Array:
    """The sequence of gears, each once."""
    gears = np.sign(path.arcs[:, 0])
    is_new = np.r_[True, np.diff(gears) != 0][: len(gears)]
    return np.asarray(gears[is_new])


def _at(path: Path) -> Array:
    """Positions at equal fractions of the way, (33, 2)."""
    x, y = path.poses[:, :2].T
    s = np.r_[0.0, np.cumsum(np.hypot(np.diff(x), np.diff(y)))]
    return np.asarray(np.stack([np.interp(_FRACTIONS * s[-1], s, column) for column in (x, y)], axis=1))
