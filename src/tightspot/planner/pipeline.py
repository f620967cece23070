"""The one verb: from a scenario to a certified plan."""

from __future__ import annotations

import platform
import time
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from tightspot.errors import PlanningError
from tightspot.formulations import Formulation
from tightspot.guesses import Guess, GuessResult
from tightspot.planner.mesh import gear_changes, path_length
from tightspot.planner.progress import Progress, ProgressCallback
from tightspot.planner.request import Request, resolve
from tightspot.planner.rounds import Round, Step, run_round
from tightspot.planner.strategy import first_step, next_step
from tightspot.scenarios import Scenario
from tightspot.solvers import Solver
from tightspot.trajectory import Trajectory
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
    progress: ProgressCallback | None = None,
) -> Plan:
    """Plan a trajectory that provably keeps ``margin`` from every obstacle at all times.

    Guess, transcribe, solve, judge. If the judge does not certify the solution, intervals are added where the
    witness lies, then the demanded margin grows, and the problem is solved again from the last solution.

    Args:
        scenario: A scenario, the name of a built-in one, or a file.
        vehicle: A vehicle, a catalogue name or a file; default: the scenario's.
        objective: Default: the paper's eq. (25), r = 1, P = diag(1, 2).
        formulation: A member or its name; default: ``swept-line``.
        guess: A member or its name; default: ``hybrid-astar``.
        solver: A backend or its name; default: IPOPT.
        steps: Number of intervals to begin with; default: from the guess's length and gear changes.
        margin: Demanded clearance, m; default: the scenario's.
        refinements: Largest number of re-solves.
        time_limit: No new round begins after this many seconds, and the solver is given what is left of them.
        progress: Called with news while it works.

    Returns:
        A certified plan.

    Raises:
        InputError: If the input makes no sense; nothing was computed.
        PlanningError: If no certified plan was found, with the reason, the last iterate and the witness.
    """
    started = time.perf_counter()
    request = resolve(scenario, vehicle, objective, formulation, guess, solver, steps, margin, refinements, time_limit)
    tell = progress or (lambda news: None)
    tell(Progress("guess", f"initial guess by {request.guess.name}"))
    found = request.guess.make(request.scenario, request.vehicle, margin=request.margin)
    guessed = time.perf_counter() - started
    if found.trajectory is None:
        raise PlanningError(found.reason, report={"guess": found.report, "rounds": []})
    rounds = _rounds(request, found.trajectory, tell, started + time_limit)
    report = _report(request, found, rounds, guessed, time.perf_counter() - started)
    last = rounds[-1]
    if last.certificate is None or not last.certificate.certified:
        raise _failure(request, rounds, report)
    return Plan(request.scenario, request.vehicle, last.trajectory, last.certificate, report)


def _rounds(request: Request, guess: Trajectory, tell: ProgressCallback, deadline: float) -> list[Round]:
    """Rounds until one is certified or nothing is left to try, or until their number or time is used up."""
    step: Step | None = first_step(request, guess)
    rounds: list[Round] = []
    while step is not None:
        number = len(rounds)
        rounds.append(run_round(request, step, number, tell, deadline - time.perf_counter()))
        judged = rounds[-1].certificate
        if (judged and judged.certified) or number == request.refinements or time.perf_counter() > deadline:
            break
        step = next_step(request, rounds, guess)
        if step is not None:
            tell(Progress("refine", step.reason, number + 1))
    return rounds


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


def _failure(request: Request, rounds: list[Round], report: dict[str, Any]) -> PlanningError:
    """The exception that says why, with the last iterate and the witness."""
    last = rounds[-1]
    witness = last.certificate.witness if last.certificate else None
    if last.certificate is None:
        worst = f" The worst constraint is {last.report.worst}." if last.report.worst else ""
        reason = (
            f"The solver found no trajectory with {request.margin:g} m of clearance: {last.report.status.sentence}"
            f"{worst} Try a smaller margin or another guess."
        )
    elif witness is not None:
        reason = (
            f"No certified plan after {len(rounds)} rounds: {witness}. Try more steps, a larger margin or the "
            "swept-line formulation."
        )
    else:
        failed = " ".join(check.sentence for check in last.certificate.failed)
        reason = f"No certified plan after {len(rounds)} rounds. {failed}"
    return PlanningError(reason, trajectory=last.trajectory, witness=witness, report=report)
