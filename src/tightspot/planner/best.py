"""The best of many: a batch of guesses solved at the knots, the optima certified in order, the best made finer.

What can be certified of an optimum usually has a larger J than the optimum has at the knots: whole intervals keep a
little more distance. So once a certified plan is no worse than what the next optimum has at the knots, the rest is left
out.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass, replace

import numpy as np

from tightspot.guesses import GuessResult, HybridAStar, assorted, bent_versions
from tightspot.guesses.ahead import in_order
from tightspot.guesses.perturbed import generator
from tightspot.planner.mesh import steps_for
from tightspot.planner.optima import alike, distinct
from tightspot.planner.portfolio import (
    Course,
    Member,
    attempt,
    conclude,
    cores_for,
    is_hopeless,
    members_of,
    on_all_cores,
    run_course,
    without_fallbacks,
)
from tightspot.planner.progress import Progress, ProgressCallback
from tightspot.planner.request import Request
from tightspot.planner.rounds import problem_of
from tightspot.planner.strategy import MOST_STEPS, at_knots, first_step
from tightspot.search import SearchResult
from tightspot.solvers import StageReport, Stagewise
from tightspot.transcription import fits_stages
from tightspot.vehicles import SingleTrack

GUESSES = 60
SLOW_GUESSES = 6
"""With solvers that take a hundred times as long."""
MOST_COURSES = 8
MOST_AHEAD = 4
"""Courses beside each other: what the first ones come to may make the later ones unwanted."""
FINER = (1.5, 2.0)
AT_ONCE = 8
SOLVE_SECONDS = 1.0
SEARCH_SHARE = 0.2
"""Of the time left, for the searches."""


@dataclass(frozen=True, eq=False)
class _Candidate:
    """A guess to follow, with the answer to its first step if that is known."""

    member: Member
    found: GuessResult
    solved: StageReport | None = None
    hopes: float = -np.inf


class _Unwanted(Exception):  # noqa: N818 - nothing is wrong
    """Ends a course whose result is no longer wanted."""


def run_best(request: Request, tell: ProgressCallback, deadline: float, seed: int = 0) -> list[Course]:
    """Courses in the order tried; the last one is the answer: the certified one with the smallest J if there is any.

    The first guess as with less effort, and if that fails all other members; then ``GUESSES`` assorted guesses (of a
    guess that was asked for: bent versions), solved at the knots in one batch; each optimum once, the smallest J first,
    until it is certified or no better than one that is; then the best once more with more intervals. The answer depends
    on the seed, not on the number of cores, as long as the time suffices.

    Raises:
        InputError: If the seed is not a whole number, 0 or more.
    """
    generator(seed, "seed")
    quick = without_fallbacks(request)
    members = members_of(request)
    tried = [run_course(quick, members[0], tell, deadline)]
    first = tried[0]
    if not first.certified:
        if is_hopeless(request, first):
            return tried
        others = on_all_cores(quick, members[1:], tell, deadline, stop_at_first=False)
        tried += sorted(others, key=lambda course: members.index(course.member))
    if time.perf_counter() < deadline:
        tried += _followed(quick, _guesses(quick, first.found, seed, deadline), tried, tell, deadline)
    best = conclude(replace(request, fallbacks=()), tried, tell, deadline)[-1]
    if best.certified and time.perf_counter() < deadline:
        tried += _finer(quick, best, tell, deadline)
    return conclude(request, tried, tell, deadline)


def _guesses(request: Request, first: GuessResult, seed: int, deadline: float) -> list[GuessResult]:
    """Assorted ones where the choice is ours; otherwise the given guess bent. The first itself is left out."""
    count = GUESSES if _has_batch(request) else SLOW_GUESSES
    if request.guess == HybridAStar() and isinstance(request.vehicle, SingleTrack):
        made = assorted(
            request.scenario,
            request.vehicle,
            count + 1,
            seed,
            margin=request.margin,
            threads=cores_for(request),
            seconds=SEARCH_SHARE * (deadline - time.perf_counter()),
            first=first if isinstance(first.details, SearchResult) else None,
        )
        others = (guess for guess in made if first.details is None or guess.details is not first.details)
        return [guess for guess in others if guess.trajectory is not None]
    if first.trajectory is None or not {"x", "y", "theta"} <= set(first.trajectory.state_names):
        return []
    return bent_versions([first], request.vehicle, count, seed)


def _has_batch(request: Request) -> bool:
    """Whether the first step is one for the stagewise solver."""
    return isinstance(request.solver, Stagewise) and fits_stages(request.vehicle, at_knots(request.formulation))


def _followed(
    request: Request, guesses: Sequence[GuessResult], before: Sequence[Course], tell: ProgressCallback, deadline: float
) -> list[Course]:
    """The courses from the guesses' optima, and of the other guesses how they ended."""
    if not guesses:
        return []
    origin = next((course.found for course in before if course.rounds), guesses[0])
    if request.steps is None and origin.trajectory is not None:
        request = replace(request, steps=steps_for(origin.trajectory))
    members = [Member(f"{request.guess.name}, {guess.report['variant']}", request.guess) for guess in guesses]
    if not _has_batch(request):
        candidates = [_Candidate(*pair) for pair in zip(members, guesses, strict=True)]
        return _courses(request, candidates, before, tell, deadline)
    reports = _batch(request, guesses, tell, deadline)
    firsts = [course.rounds[0].report for course in before if course.certified]
    known = [report for report in firsts if isinstance(report, StageReport)]
    candidates = [
        _Candidate(members[optimum.indices[0]], optimum.guess, optimum.report, optimum.objective)
        for optimum in distinct(guesses, reports)
        if not any(alike(optimum.report, report) for report in known)
    ]
    courses = _courses(request, candidates[:MOST_COURSES], before, tell, deadline)
    followed = {id(course.member) for course in courses}
    left = [
        Course(member, guess, [], 0.0, 0.0, report)
        for member, guess, report in zip(members, guesses, reports, strict=False)
        if id(member) not in followed
    ]
    return [*left, *courses]


def _batch(
    request: Request, guesses: Sequence[GuessResult], tell: ProgressCallback, deadline: float
) -> list[StageReport]:
    """How the first step from each guess ends; fewer if there is no more time."""
    solver = request.solver.with_time_limit(SOLVE_SECONDS)
    reports: list[StageReport] = []
    while len(reports) < len(guesses) and time.perf_counter() < deadline and isinstance(solver, Stagewise):
        tell(Progress("guess", f"{len(reports)} of {len(guesses)} other guesses solved"))
        some = [guess.trajectory for guess in guesses[len(reports) : len(reports) + AT_ONCE]]
        problems = [problem_of(request, first_step(request, guess)) for guess in some if guess is not None]
        reports += solver.solve_many(problems, threads=cores_for(request))
    return reports


def _courses(
    request: Request,
    candidates: Sequence[_Candidate],
    before: Sequence[Course],
    tell: ProgressCallback,
    deadline: float,
) -> list[Course]:
    """The candidates' courses in order, until one hopes for no more than is certified."""
    best = min((course.objective(request) for course in before if course.certified), default=np.inf)
    unwanted = threading.Event()

    def listen(news: Progress) -> None:
        if unwanted.is_set():
            raise _Unwanted

    def run(candidate: _Candidate) -> Course | None:
        return attempt(request, candidate.member, listen, deadline, candidate.found, candidate.solved)

    courses: list[Course] = []
    with closing(in_order(run, candidates, min(cores_for(request), MOST_AHEAD), unwanted.set)) as results:
        for candidate in candidates:
            if candidate.hopes >= best or time.perf_counter() > deadline:
                break
            tell(Progress("guess", f"{len(courses)} of {len(candidates)} optima followed"))
            course = next(results)
            if course is not None:
                courses.append(course)
                best = min(best, course.objective(request)) if course.certified else best
    return courses


def _finer(request: Request, best: Course, tell: ProgressCallback, deadline: float) -> list[Course]:
    """The best plan once more with more intervals to begin with: its inputs may change oftener."""
    steps = best.rounds[0].mesh.grid.steps
    candidates = []
    for factor in FINER:
        member = replace(best.member, name=f"{best.member.name}, {factor:g} times the intervals")
        reason = f"{best.found.reason} From its certified plan again, with {factor:g} times the intervals."
        found = replace(best.found, trajectory=best.rounds[-1].trajectory, reason=reason)
        candidates.append((replace(request, steps=min(int(factor * steps), MOST_STEPS)), _Candidate(member, found)))
    return [course for asked, candidate in candidates for course in _courses(asked, [candidate], [], tell, deadline)]
