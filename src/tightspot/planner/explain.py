"""From what was tried to why there is no plan. What costs more than a second or two is left to ``deeper``."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import numpy as np

from tightspot.errors import BlockedError, InputError
from tightspot.guesses import GuessResult, HybridAStar
from tightspot.planner.attempts import PENETRATION_SECONDS, Attempts, colliding_starts, least_penetration
from tightspot.planner.deeper import PATIENCE_AS_IT_IS, deeper_analysis, with_defaults
from tightspot.planner.explanation import Explanation, FailureKind
from tightspot.planner.passing import Deeper
from tightspot.planner.penetration import Contact, Penetration
from tightspot.planner.progress import Progress, ProgressCallback
from tightspot.planner.reach import SECONDS as REACH_SECONDS
from tightspot.planner.reach import reach_of
from tightspot.planner.request import Request
from tightspot.planner.rounds import Round
from tightspot.planner.sentences import (
    blocked_words,
    certificate_words,
    guess_words,
    path_words,
    penetration_words,
    solver_words,
)
from tightspot.planner.solver_stop import solver_stop
from tightspot.scenarios import Blocked, Scenario
from tightspot.scenarios.bottleneck import Bottleneck, bottleneck
from tightspot.search import SearchResult
from tightspot.solvers import SolveStatus
from tightspot.trajectory import Trajectory
from tightspot.vehicles import SingleTrack, VehicleModel
from tightspot.verification import Witness

SECONDS = 60.0
"""That the deeper analysis may take."""
SHORTEST = 0.2
"""For each of the searches that show what can be reached, however late it is, s."""
CLOSE_ENOUGH = 1e-3
"""A trajectory that is nearer than the margin by less than this does not explain a failure, m."""


def explain_blocked(
    error: BlockedError,
    scenario: Scenario,
    vehicle: VehicleModel,
    resolved: Callable[[Scenario], Request],
    tell: ProgressCallback,
    seconds: float | None,
) -> Explanation:
    """Why the vehicle cannot stand at the start or the goal; in depth: whether a plan exists where it can.

    Args:
        error: With the blocked ends.
        scenario: Whose they are.
        vehicle: That shall stand there.
        resolved: Makes a request of another scenario.
        tell: Told what goes on.
        seconds: For the deeper analysis; ``None``: none is wanted.
    """
    sentence, remedy = blocked_words(error.ends)
    first = error.ends[0]
    kind = FailureKind.START_BLOCKED if first.end == "start" else FailureKind.GOAL_BLOCKED
    deeper = None
    if seconds is not None and all(end.move is not None for end in error.ends):
        tell(Progress("explain", "whether there is a plan once it is moved"))
        deeper = _cured(error.ends, scenario, resolved, tell, seconds)
    return Explanation(
        kind, sentence, remedy, scenario, vehicle, first.margin, blocked=tuple(error.ends), deeper=deeper
    )


def _cured(
    ends: Sequence[Blocked],
    scenario: Scenario,
    resolved: Callable[[Scenario], Request],
    tell: ProgressCallback,
    seconds: float,
) -> Deeper | None:
    """Whether there is a plan with all blocked ends moved as advised; ``None`` if something else is wrong, too."""
    began = time.perf_counter()
    moved = {end.end: getattr(scenario, end.end) + np.array([*(end.move or (0, 0)), 0, 0, 0]) for end in ends}
    try:
        request = resolved(scenario.with_(**moved))
    except InputError:
        return None
    request = with_defaults(request)
    attempts = Attempts(request, colliding_starts(request, None), tell, began + seconds)
    verdict = attempts.verdict(request, PATIENCE_AS_IT_IS)
    cured = None if verdict == "no time" else verdict == "passes"
    return Deeper(cured=cured, seconds=time.perf_counter() - began)


def explain_no_guess(
    request: Request, found: GuessResult, tell: ProgressCallback, seconds: float | None, until: float = np.inf
) -> Explanation:
    """Why there was nothing to begin with: no path, or a guess that is itself a failed optimisation.

    Args:
        request: What was asked for.
        found: Without a trajectory.
        tell: Told what goes on.
        seconds: For the deeper analysis; ``None``: none is wanted.
        until: When the rest shall be done, by the clock of :func:`time.perf_counter`, s.
    """
    tell(Progress("explain", "how far the search came"))
    narrow = bottleneck(request.scenario, request.vehicle, request.margin)
    reach = None
    if isinstance(found.details, SearchResult) and isinstance(request.vehicle, SingleTrack):
        options = request.guess.options if isinstance(request.guess, HybridAStar) else None
        reach = reach_of(request.scenario, request.vehicle, found.details, options, _share(until))
    kind = FailureKind.SOLVER_STOPPED if reach is None and narrow is None else FailureKind.NO_PATH
    deeper, least = None, None
    if seconds is not None:
        deadline = time.perf_counter() + seconds
        deeper, least = deeper_analysis(request, colliding_starts(request, None), tell, deadline)
    if narrow is not None or reach is not None:
        sentence, remedy = path_words(request, narrow, reach, deeper)
    else:
        sentence, remedy = guess_words(request, found, deeper)
    return Explanation(
        kind,
        sentence,
        remedy,
        request.scenario,
        request.vehicle,
        request.margin,
        reach=reach,
        bottleneck=narrow,
        penetration=least,
        deeper=deeper,
    )


def _share(until: float) -> float:
    """Half of what is left for the two searches that show what can be reached, s."""
    return float(np.clip((until - time.perf_counter()) / 2, SHORTEST, REACH_SECONDS))


def explain_rounds(
    request: Request, rounds: list[Round], tell: ProgressCallback, seconds: float | None, until: float = np.inf
) -> Explanation:
    """Why no round was certified; arguments as for :func:`explain_no_guess`."""
    narrow = bottleneck(request.scenario, request.vehicle, request.margin)
    if rounds[-1].certificate is not None and narrow is None:
        return _not_certified(request, rounds, tell, seconds)
    return _not_solved(request, rounds, narrow, tell, seconds, until)


def _not_certified(request: Request, rounds: list[Round], tell: ProgressCallback, seconds: float | None) -> Explanation:
    last = rounds[-1]
    certificate = last.certificate
    deeper = None
    if seconds is not None:
        deadline = time.perf_counter() + seconds
        starts = colliding_starts(request, last.trajectory)
        deeper, _ = deeper_analysis(request, starts, tell, deadline)
    sentence, remedy = certificate_words(request, rounds, deeper)
    return Explanation(
        FailureKind.NOT_CERTIFIED,
        sentence,
        remedy,
        request.scenario,
        request.vehicle,
        request.margin,
        certificate=certificate,
        trajectory=last.trajectory,
        witness=certificate.witness if certificate else None,
        deeper=deeper,
    )


def _not_solved(
    request: Request,
    rounds: list[Round],
    narrow: Bottleneck | None,
    tell: ProgressCallback,
    seconds: float | None,
    until: float,
) -> Explanation:
    """Why the last round was not solved, or why its solution cannot be any good if there is no way at all."""
    last = rounds[-1]
    stop = solver_stop(request, rounds)
    least, deeper = None, None
    starts = colliding_starts(request, last.trajectory)
    reports = [report for outcome in rounds for report in (outcome.report, *outcome.abandoned)]
    gave_up = any(report.status is SolveStatus.INFEASIBLE for report in reports)
    if seconds is not None:
        deadline = time.perf_counter() + seconds
        deeper, least = deeper_analysis(request, starts, tell, deadline)
    elif gave_up or narrow is not None:
        tell(Progress("explain", "the trajectory that penetrates least"))
        least = least_penetration(request, starts[:2], min(until, time.perf_counter() + PENETRATION_SECONDS))
    near = None if least is None else too_near(least, request.margin)
    trajectory: Trajectory = last.trajectory
    witness = stop.witness
    if least is not None and near is not None:
        kind, trajectory, witness = FailureKind.ONLY_PENETRATING, least.trajectory, _witness(near)
        sentence, remedy = penetration_words(request, stop, near, narrow, deeper)
    else:
        kind = FailureKind.SOLVER_STOPPED
        sentence, remedy = solver_words(request, stop, narrow, least, deeper)
    return Explanation(
        kind,
        sentence,
        remedy,
        request.scenario,
        request.vehicle,
        request.margin,
        bottleneck=narrow,
        solver=stop,
        penetration=least,
        trajectory=trajectory,
        witness=witness,
        deeper=deeper,
    )


def too_near(least: Penetration, margin: float) -> Contact | None:
    """The moment at which the trajectory that penetrates least comes too near, if it does."""
    nearest = least.contacts[0] if least.contacts else least.nearest
    if nearest is None or -nearest.depth >= margin - CLOSE_ENOUGH:
        return None
    return nearest


def _witness(contact: Contact) -> Witness:
    kind = "collision" if contact.depth > 0 else "margin"
    return Witness(contact.time, contact.part, contact.obstacle, -contact.depth, contact.pose, kind)
