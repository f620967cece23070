"""Several guesses for one request: what to try, in which order, on how many cores.

A course is one guess and the rounds that begin with it. Guesses differ in the way round the obstacles and in where the
gears change, and so do the optima that they lead to.
"""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal

from tightspot.errors import TightspotError
from tightspot.guesses import Guess, GuessResult, HybridAStar, LinearInterpolation
from tightspot.guesses.hybrid_astar import MORE_THAN_MARGIN
from tightspot.planner.as_found import driven_as_found
from tightspot.planner.course import certified, run_rounds
from tightspot.planner.mesh import steps_for
from tightspot.planner.progress import Progress, ProgressCallback, unheard
from tightspot.planner.request import Request
from tightspot.planner.rounds import Round
from tightspot.scenarios.bottleneck import is_closed
from tightspot.scenarios.scenario import Scenario
from tightspot.search import (
    COARSE,
    FINE,
    FINEST,
    MEDIUM,
    NARROW,
    NARROWER,
    NARROWEST,
    SMALL_TURNS,
    Direction,
    HybridAStarOptions,
    SearchResult,
    SearchStatus,
)
from tightspot.solvers import SolveReport, StageReport, Stagewise
from tightspot.vehicles.base import VehicleModel

Effort = Literal["fast", "balanced", "best"]
EFFORTS: tuple[Effort, ...] = ("fast", "balanced", "best")

SEARCH_SECONDS = 4.0
BETWEEN_WALLS = (NARROW, NARROWER, NARROWEST, SMALL_TURNS)
FALLBACK_SECONDS = 20.0
COURSE_SECONDS = 10.0
MANY = 2_000_000
SECONDS_MORE = 12.0
"""For other courses, once the first one's path is known to be certified as it is."""
POLL_SECONDS = 0.1


@dataclass(frozen=True)
class Member:
    """What may be tried: a guess, and a factor on the number of intervals that it suggests."""

    name: str
    guess: Guess
    finer: float = 1.0


@dataclass(frozen=True, eq=False)
class Course:
    """What came of a member.

    Attributes:
        member: What was tried.
        found: The guess.
        rounds: From it; empty if there is no guess.
        guess_seconds: Time for the guess.
        seconds: Time for all.
        solved: Of a guess that was solved at the knots and not followed further: how that ended.
    """

    member: Member
    found: GuessResult
    rounds: list[Round]
    guess_seconds: float
    seconds: float
    solved: SolveReport | None = None

    @property
    def certified(self) -> bool:
        """Whether it ended with a certified trajectory."""
        return bool(self.rounds) and certified(self.rounds)

    def objective(self, request: Request) -> float:
        """J of the last trajectory."""
        last = self.rounds[-1].trajectory
        return request.objective.value(last.t, last.inputs)

    def to_dict(self, request: Request) -> dict[str, Any]:
        """One line of the report's list of what was tried."""
        first, last = (self.rounds[0].report, self.rounds[-1].report) if self.rounds else (self.solved, self.solved)
        return {
            "guess": self.member.name,
            "certified": self.certified,
            "objective": self.objective(request) if self.certified else None,
            "objective_first": first.objective if first and first.status.success else None,
            "rounds": len(self.rounds),
            "status": last.status.name if last else "NO_GUESS",
            "reason": self.found.reason,
            "seconds": self.seconds,
        }


def chosen_member(request: Request) -> Member:
    """What to try first: the guess that was asked for."""
    return Member(request.guess.name, request.guess)


def members_of(request: Request) -> list[Member]:
    """What to try, the most promising first. A guess that was asked for is kept to; only its mesh varies."""
    chosen = chosen_member(request)
    finer = Member(f"{request.guess.name}, more intervals", request.guess, finer=1.6)
    if request.guess != HybridAStar():
        return [chosen, finer]
    margin = request.margin
    between_walls = {"resolutions": BETWEEN_WALLS, "margins": tuple(dict.fromkeys((margin, margin / 2, 0.0)))}
    # What the judge certifies as it is: the search keeps its margin to a thousandth of the body's width.
    as_it_is = {"resolutions": (COARSE, MEDIUM, *BETWEEN_WALLS), "margins": (margin + 0.003, margin + 0.001)}
    variants: dict[str, dict[str, Any]] = {
        "the whole margin": as_it_is,
        "finest cells": {"resolutions": (FINE, FINEST)},
        "from the wider end": {"directions": (Direction.WIDE_END, Direction.TIGHT_END)},
        "few gear changes": {"gear_change": 10.0},
        "many gear changes": {"gear_change": 0.3, "steering_change": 0.1},
        "between walls": between_walls,
        "forwards": {"reverse": 3.0},
    }
    searches = [Member(f"hybrid-astar, {name}", _search(request, **options)) for name, options in variants.items()]
    return [chosen, finer, *searches, Member("linear", LinearInterpolation())]


def _search(request: Request, **options: Any) -> HybridAStar:
    margins = (*(request.margin + more for more in MORE_THAN_MARGIN), request.margin / 2)
    common: dict[str, Any] = {"margins": tuple(dict.fromkeys(margins)), "resolutions": (COARSE, MEDIUM, NARROW)}
    return HybridAStar(HybridAStarOptions(**(common | options), time_limit=SEARCH_SECONDS))


def run_course(
    request: Request,
    member: Member,
    tell: ProgressCallback,
    deadline: float,
    found: GuessResult | None = None,
    solved: StageReport | None = None,
) -> Course:
    """The member's guess, if it is not given, then rounds until one is certified or nothing is left to try.

    The first step from a given guess may have been ``solved`` already.
    """
    started = time.perf_counter()
    if found is None:
        tell(Progress("guess", f"initial guess by {member.name}"))
        found = member.guess.make(request.scenario, request.vehicle, margin=request.margin)
    guessed = time.perf_counter() - started
    rounds: list[Round] = []
    if found.trajectory is not None:
        if member.finer != 1.0:
            steps = int(member.finer * (request.steps or steps_for(found.trajectory)))
            request = replace(request, steps=steps)
        rounds = run_rounds(request, found.trajectory, tell, deadline, solved)
    return Course(member, found, rounds, guessed, time.perf_counter() - started)


def run_portfolio(request: Request, effort: Effort, tell: ProgressCallback, deadline: float) -> list[Course]:
    """Courses in the order tried; the last one is the answer: a certified one if there is any.

    ``fast``: the first member with all solvers. Otherwise the first member with the first solver, then the others on
    all cores until one is certified; then a searched path as it is, if the judge certifies one; then the first once
    more with the fall-back solvers.
    """
    chosen = chosen_member(request)
    if effort == "fast":
        return [run_course(request, chosen, tell, deadline)]
    quick = without_fallbacks(request)
    first = run_course(quick, chosen, tell, deadline)
    if first.certified or is_hopeless(request, first):
        return [first]
    until = deadline
    if driven_as_found(request, first.found):
        until = min(deadline, time.perf_counter() + SECONDS_MORE)
    _, finer, *others = members_of(request)
    tried = [first, *on_all_cores(quick, [*_again(first, finer), *others], tell, until, stop_at_first=True)]
    if request.guess == HybridAStar() and all(map(_ran_out, tried)):
        tried.append(run_course(quick, _patient(request, deadline), tell, deadline))
    return conclude(request, tried, tell, deadline)


def _ran_out(course: Course) -> bool:
    """Whether it did not come from a search that found a path, or that looked at all that can be reached."""
    result = course.found.details
    return not isinstance(result, SearchResult) or result.status in (
        SearchStatus.LIMIT_REACHED,
        SearchStatus.TIME_LIMIT,
    )


def _patient(request: Request, deadline: float) -> Member:
    """A search for most of the time that is left."""
    options = HybridAStarOptions(
        resolutions=tuple(replace(resolution, max_expansions=MANY) for resolution in (MEDIUM, NARROW, NARROWER)),
        margins=(request.margin + MORE_THAN_MARGIN[1], request.margin + 0.001),
        max_expansions=MANY,
        time_limit=max(1.0, 0.7 * (deadline - time.perf_counter())),
    )
    return Member("hybrid-astar, patient", HybridAStar(options))


def _again(first: Course, finer: Member) -> list[Member]:
    """The first course's guess on a finer mesh; nothing if there is no guess."""
    return [replace(finer, guess=_Known(first.found))] if first.found.trajectory is not None else []


@dataclass(frozen=True)
class _Known(Guess):
    """A guess that was made before."""

    name: ClassVar[str] = "known"
    collision_free: ClassVar[bool] = False
    found: GuessResult

    def make(self, scenario: Scenario, vehicle: VehicleModel, *, margin: float) -> GuessResult:
        return self.found


def without_fallbacks(request: Request) -> Request:
    """The same with the stagewise solver only; other solvers keep their fall-backs."""
    return replace(request, fallbacks=()) if isinstance(request.solver, Stagewise) else request


def conclude(request: Request, tried: list[Course], tell: ProgressCallback, deadline: float) -> list[Course]:
    """The certified course with the smallest J to the end; without one, the quickest searched path as it is.

    If there is none of that either, the first guess with the fall-back solvers. Straight lines are for the user to ask
    for: where no search finds a path, no solver was seen to find one from there.
    """
    good = [course for course in tried if course.certified] or _as_found(request, tried)
    if good:
        best = min(good, key=lambda course: course.objective(request))
        return [*(course for course in tried if course is not best), best]
    started = [course for course in tried if course.rounds and course.member.name != LinearInterpolation.name]
    first = tried[0] if tried[0].rounds else next(iter(started), None)
    if request.fallbacks and first is not None and time.perf_counter() < deadline:
        slow = replace(request, solver=request.fallbacks[0], fallbacks=request.fallbacks[1:])
        member = replace(first.member, name=f"{first.member.name}, {slow.solver.name}")
        until = min(deadline, time.perf_counter() + FALLBACK_SECONDS)
        return [*tried, run_course(slow, member, tell, until, first.found)]
    return sorted(tried, key=lambda course: bool(course.rounds))


def _as_found(request: Request, tried: Sequence[Course]) -> list[Course]:
    """Courses of the searched paths that are certified as they are."""
    courses = []
    for course in tried:
        outcome = driven_as_found(request, course.found)
        if outcome is not None:
            member = replace(course.member, name=f"{course.member.name}, as found")
            courses.append(Course(member, course.found, [outcome], course.guess_seconds, course.seconds))
    return courses


def is_hopeless(request: Request, course: Course) -> bool:
    """It is proved that there is no way, whatever the guess."""
    result = course.found.details
    if isinstance(result, SearchResult) and result.path is None and result.is_proof:
        return True
    return is_closed(request.scenario, request.vehicle, request.margin)


def on_all_cores(
    request: Request, members: Sequence[Member], tell: ProgressCallback, deadline: float, *, stop_at_first: bool
) -> list[Course]:
    """Courses as they end. The search and the stagewise solver run beside each other, other solvers do not.

    The progress of courses that run beside each other is not told: it would be a medley.
    """
    done: list[Course] = []
    if not members:
        return done
    cores = min(cores_for(request), len(members))
    waiting = list(members)
    if cores == 1:
        while waiting and time.perf_counter() < deadline and not (stop_at_first and _any_certified(done)):
            course = attempt(request, waiting.pop(0), tell, deadline)
            done += [course] if course else []
        return done
    running: set[Future[Course | None]] = set()
    with ThreadPoolExecutor(cores) as pool:
        while waiting or running:
            while waiting and len(running) < cores and time.perf_counter() < deadline:
                running.add(pool.submit(attempt, request, waiting.pop(0), unheard, deadline))
            if not running:
                break
            ended, running = wait(running, timeout=POLL_SECONDS, return_when=FIRST_COMPLETED)
            done += [course for future in ended if (course := future.result())]
            tell(Progress("guess", f"{len(done)} of {len(members)} other ways tried"))
            if stop_at_first and _any_certified(done):
                waiting = []
    return done


def cores_for(request: Request) -> int:
    """How many courses may run beside each other: only the stagewise solver lets go of Python's lock."""
    if not isinstance(request.solver, Stagewise):
        return 1
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _any_certified(courses: Sequence[Course]) -> bool:
    return any(course.certified for course in courses)


def attempt(
    request: Request,
    member: Member,
    tell: ProgressCallback,
    deadline: float,
    found: GuessResult | None = None,
    solved: StageReport | None = None,
) -> Course | None:
    """The member's course, for ``COURSE_SECONDS`` at most; ``None`` if its guess cannot be made for this vehicle."""
    try:
        return run_course(request, member, tell, min(deadline, time.perf_counter() + COURSE_SECONDS), found, solved)
    except TightspotError:
        return None
