"""The one verb: from a scenario to a certified plan."""

from __future__ import annotations

import platform
import time
from collections.abc import Callable
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from tightspot.errors import BlockedError, InputError, PlanningError, Problem
from tightspot.formulations import Formulation
from tightspot.guesses import Guess
from tightspot.planner.best import run_best
from tightspot.planner.explain import SECONDS, explain_blocked, explain_no_guess, explain_rounds
from tightspot.planner.explanation import Explanation, FailureKind
from tightspot.planner.fell_back import fell_back_from
from tightspot.planner.mesh import gear_changes, path_length
from tightspot.planner.portfolio import EFFORTS, Course, Effort, run_portfolio
from tightspot.planner.progress import ProgressCallback, unheard
from tightspot.planner.request import Request, resolve, resolve_vehicle
from tightspot.planner.rounds import Round
from tightspot.scenarios import Scenario, load
from tightspot.search import SearchResult
from tightspot.solvers import Solver
from tightspot.transcription import Objective
from tightspot.vehicles import VehicleModel
from tightspot.verification import Plan

GRACE = 5.0
"""For saying why there is no plan when the time is up, s."""


def plan(
    scenario: Scenario | str | Path,
    *,
    vehicle: VehicleModel | str | Path | None = None,
    objective: Objective | None = None,
    formulation: Formulation | str | None = None,
    guess: Guess | str | None = None,
    solver: Solver | str | None = None,
    steps: int | None = None,
    margin: float | None = None,
    refinements: int = 8,
    time_limit: float = 60.0,
    effort: str = "balanced",
    seed: int = 0,
    explain: bool = False,
    progress: ProgressCallback | None = None,
) -> Plan:
    """Plan a trajectory that provably keeps ``margin`` from every obstacle at all times.

    Guess, transcribe, solve, judge. The first solve separates at the knots only; intervals are added where the judge
    sees the motion between them come near, and the demanded formulation is solved on that mesh from the first solution.
    If the judge still objects, intervals are added where the witness lies, then the demanded margin grows.

    Args:
        scenario: A scenario, the name of a built-in one, or a file.
        vehicle: A vehicle, a catalogue name or a file; default: the scenario's.
        objective: Default: the paper's eq. (25), r = 1, P = diag(1, 2).
        formulation: A member or its name; default: ``swept-line``.
        guess: A member or its name; default: ``hybrid-astar``.
        solver: A backend or its name; default: ``stagewise``, then ``fatrop``, then ``ipopt``, each where the one
            before fails or cannot be used. The report's ``fell_back_from`` says which failed, and how.
        steps: Number of intervals to begin with; default: from the guess's length and gear changes.
        margin: Demanded clearance, m; default: the scenario's.
        refinements: Largest number of re-solves.
        time_limit: No new round begins after this many seconds, and the solver is given what is left of them. Why there
            is no plan is then found out within a few seconds more.
        effort: ``fast``: one guess. ``balanced``: if that fails, other guesses and meshes, until one is certified.
            ``best``: all of them, on all cores; the certified plan with the smallest J. The report's ``tried`` lists
            them.
        seed: Of what ``best`` draws at random.
        explain: If there is no plan, find out what would pass: plan it from other guesses, with less margin and with a
            narrower body, for about a minute more. Nothing changes if there is a plan.
        progress: Called with news while it works.

    Returns:
        A certified plan.

    Raises:
        BlockedError: If the vehicle cannot stand at the start or at the goal; its ``explanation`` says what would free
            it.
        InputError: If the input makes no sense otherwise; nothing was computed.
        PlanningError: If no certified plan was found, with the reason, the last iterate, the witness and an
            ``explanation``: why, with numbers, and what to change.
    """
    started = time.perf_counter()
    chosen = known_effort(effort)
    tell = progress or unheard
    seconds = SECONDS if explain else None
    scene = scenario if isinstance(scenario, Scenario) else load(scenario)

    def resolved(scene: Scenario) -> Request:
        return resolve(scene, vehicle, objective, formulation, guess, solver, steps, margin, refinements, time_limit)

    request = resolve_or_explain(scene, vehicle, resolved, tell, seconds)
    return plan_request(request, chosen, tell, started, seed, seconds)[0]


def known_effort(effort: str) -> Effort:
    """The effort of that name; raises :class:`InputError` if there is none such."""
    chosen = next((known for known in EFFORTS if known == effort), None)
    if chosen is None:
        raise InputError(Problem("effort", f"{effort!r} is not known; choose one of {', '.join(EFFORTS)}"))
    return chosen


def resolve_or_explain(
    scene: Scenario,
    vehicle: VehicleModel | str | Path | None,
    resolved: Callable[[Scenario], Request],
    tell: ProgressCallback,
    seconds: float | None,
) -> Request:
    """The request; a blocked start or goal raises with its ``explanation``."""
    try:
        return resolved(scene)
    except BlockedError as error:
        car = resolve_vehicle(scene, vehicle)
        error.explanation = explain_blocked(error, scene, car, resolved, tell, seconds)
        raise


def plan_request(
    request: Request, effort: Effort, tell: ProgressCallback, started: float, seed: int, seconds: float | None
) -> tuple[Plan, Round]:
    """:func:`plan` for a request that is resolved, and the round that the plan is of.

    Raises:
        PlanningError: As there.
    """
    deadline = started + request.time_limit
    if effort == "best":
        tried = run_best(request, tell, deadline, seed)
    else:
        tried = run_portfolio(request, effort, tell, deadline)
    course = tried[-1]
    report = report_of(request, tried, time.perf_counter() - started)
    last = course.rounds[-1] if course.rounds else None
    if last is None or last.certificate is None or not last.certificate.certified:
        raise _failure(_explained(request, tried, tell, seconds, deadline + GRACE), course.rounds, report)
    return Plan(request.scenario, request.vehicle, last.trajectory, last.certificate, report), last


def report_of(request: Request, tried: list[Course], total: float) -> dict[str, Any]:
    """A plan's report: what was tried, what it cost and what came of it, as plain data."""
    course = tried[-1]
    found = course.found
    report: dict[str, Any] = {
        "formulation": request.formulation.name,
        "guess": {"name": course.member.name, "reason": found.reason, "seconds": course.guess_seconds, **found.report},
        "solver": request.solver.name,
        "fell_back_from": fell_back_from(request, tried),
        "margin": request.margin,
        "rounds": [outcome.to_dict() for outcome in course.rounds],
        "tried": [other.to_dict(request) for other in tried],
        "seconds": total,
        "versions": dict(_versions()),
    }
    if not course.rounds:
        return report
    trajectory = course.rounds[-1].trajectory
    return report | {
        "objective": {
            "value": report["tried"][-1]["objective"] if course.certified else course.objective(request),
            "time_weight": request.objective.time_weight,
            "input_weights": list(request.objective.input_weights),
            "energy": request.objective.energy.value,
        },
        "duration": trajectory.duration,
        "path_length": path_length(trajectory),
        "gear_changes": gear_changes(trajectory),
    }


@cache
def _versions() -> dict[str, str]:
    return {
        "python": platform.python_version(),
        "numpy": np.__version__,
        "casadi": metadata.version("casadi"),
    }


def _explained(
    request: Request, tried: list[Course], tell: ProgressCallback, seconds: float | None, until: float
) -> Explanation:
    """Why nothing was certified: there is no path, unless a search found one; or what the last course came to."""
    searched = [course for course in tried if isinstance(course.found.details, SearchResult)]
    if searched and not any(course.rounds for course in searched):
        return explain_no_guess(request, searched[0].found, tell, seconds, until)
    if not tried[-1].rounds:
        return explain_no_guess(request, tried[-1].found, tell, seconds, until)
    return explain_rounds(request, tried[-1].rounds, tell, seconds, until)


def _failure(explanation: Explanation, rounds: list[Round], report: dict[str, Any]) -> PlanningError:
    """The exception that says why, with the last iterate and the witness."""
    last = rounds[-1] if rounds and explanation.kind is not FailureKind.NO_PATH else None
    return PlanningError(
        f"{explanation.sentence} {explanation.remedy}",
        trajectory=last.trajectory if last else None,
        witness=last.certificate.witness if last and last.certificate else None,
        report=report,
        explanation=explanation,
    )
