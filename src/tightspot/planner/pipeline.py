"""The one verb: from a scenario to a certified plan."""

from __future__ import annotations

import platform
import time
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from tightspot.errors import BlockedError, PlanningError
from tightspot.formulations import Formulation
from tightspot.guesses import Guess, GuessResult
from tightspot.planner.course import run_rounds
from tightspot.planner.explain import SECONDS, explain_blocked, explain_no_guess, explain_rounds
from tightspot.planner.explanation import Explanation
from tightspot.planner.mesh import gear_changes, path_length
from tightspot.planner.progress import Progress, ProgressCallback
from tightspot.planner.request import Request, resolve, resolve_vehicle
from tightspot.planner.rounds import Round
from tightspot.scenarios import Scenario, load
from tightspot.solvers import Solver
from tightspot.transcription import Objective
from tightspot.vehicles import VehicleModel
from tightspot.verification import Plan


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
        solver: A backend or its name; default: ``stagewise``, and ``ipopt`` where that fails or cannot be used.
        steps: Number of intervals to begin with; default: from the guess's length and gear changes.
        margin: Demanded clearance, m; default: the scenario's.
        refinements: Largest number of re-solves.
        time_limit: No new round begins after this many seconds, and the solver is given what is left of them.
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
    tell = progress or (lambda news: None)
    seconds = SECONDS if explain else None
    scene = scenario if isinstance(scenario, Scenario) else load(scenario)

    def resolved(scene: Scenario) -> Request:
        return resolve(scene, vehicle, objective, formulation, guess, solver, steps, margin, refinements, time_limit)

    try:
        request = resolved(scene)
    except BlockedError as error:
        car = resolve_vehicle(scene, vehicle)
        error.explanation = explain_blocked(error, scene, car, resolved, tell, seconds)
        raise
    tell(Progress("guess", f"initial guess by {request.guess.name}"))
    found = request.guess.make(request.scenario, request.vehicle, margin=request.margin)
    guessed = time.perf_counter() - started
    if found.trajectory is None:
        report = {"guess": found.report, "rounds": []}
        raise _failure(explain_no_guess(request, found, tell, seconds), [], report)
    rounds = run_rounds(request, found.trajectory, tell, started + time_limit)
    report = _report(request, found, rounds, guessed, time.perf_counter() - started)
    last = rounds[-1]
    if last.certificate is None or not last.certificate.certified:
        raise _failure(explain_rounds(request, rounds, tell, seconds), rounds, report)
    return Plan(request.scenario, request.vehicle, last.trajectory, last.certificate, report)


def _report(request: Request, found: GuessResult, rounds: list[Round], guessed: float, total: float) -> dict[str, Any]:
    last = rounds[-1]
    return {
        "objective": {
            "value": request.objective.value(last.trajectory.t, last.trajectory.inputs),
            "time_weight": request.objective.time_weight,
            "input_weights": list(request.objective.input_weights),
            "energy": request.objective.energy.value,
        },
        "formulation": request.formulation.name,
        "guess": {"name": request.guess.name, "reason": found.reason, "seconds": guessed, **found.report},
        "solver": request.solver.name,
        "margin": request.margin,
        "duration": last.trajectory.duration,
        "path_length": path_length(last.trajectory),
        "gear_changes": gear_changes(last.trajectory),
        "rounds": [outcome.to_dict() for outcome in rounds],
        "seconds": total,
        "versions": {
            "python": platform.python_version(),
            "numpy": np.__version__,
            "casadi": metadata.version("casadi"),
        },
    }


def _failure(explanation: Explanation, rounds: list[Round], report: dict[str, Any]) -> PlanningError:
    """The exception that says why, with the last iterate and the witness."""
    last = rounds[-1] if rounds else None
    return PlanningError(
        f"{explanation.sentence} {explanation.remedy}",
        trajectory=last.trajectory if last else None,
        witness=last.certificate.witness if last and last.certificate else None,
        report=report,
        explanation=explanation,
    )
