"""The one verb: from a scenario to a certified plan."""

from __future__ import annotations

import platform
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import casadi
import numpy as np

from tightspot.errors import PlanningError
from tightspot.formulations import Formulation
from tightspot.guesses import Guess, GuessResult
from tightspot.planner.mesh import gear_changes, path_length, poses_for, steps_for
from tightspot.planner.pairs import near_guess
from tightspot.planner.progress import Progress, ProgressCallback
from tightspot.planner.request import Request, resolve
from tightspot.planner.rounds import REACH, Mesh, Round, refine, run_round
from tightspot.scenarios import Scenario
from tightspot.solvers import Solver
from tightspot.trajectory import Trajectory
from tightspot.transcription import Objective, TimeGrid
from tightspot.vehicles import VehicleModel
from tightspot.verification import Plan

EXTRA = 0.002


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
        progress: Called with news while it works.

    Returns:
        A certified plan.

    Raises:
        InputError: If the input makes no sense; nothing was computed.
        PlanningError: If no certified plan was found, with the reason, the last iterate and the witness.
    """
    started = time.perf_counter()
    request = resolve(scenario, vehicle, objective, formulation, guess, solver, steps, margin, refinements)
    tell = progress or (lambda news: None)
    tell(Progress("guess", f"initial guess by {request.guess.name}"))
    found = request.guess.make(request.scenario, request.vehicle, margin=request.margin)
    guessed = time.perf_counter() - started
    if found.trajectory is None:
        raise PlanningError(found.reason, report={"guess": found.report, "rounds": []})
    rounds = _rounds(request, found.trajectory, tell)
    report = _report(request, found, rounds, guessed, time.perf_counter() - started)
    last = rounds[-1]
    if last.certificate is None or not last.certificate.certified:
        raise _failure(request, rounds, report)
    return Plan(request.scenario, request.vehicle, last.trajectory, last.certificate, report)


def _rounds(request: Request, guess: Trajectory, tell: ProgressCallback) -> list[Round]:
    """Rounds until one is certified or their number is used up."""
    mesh = _first_mesh(request, guess, request.steps or steps_for(guess))
    rounds = [run_round(request, mesh, guess, 0, tell)]
    for number in range(1, request.refinements + 1):
        last = rounds[-1]
        if last.certificate is not None and last.certificate.certified:
            break
        if last.solved:
            mesh, start = refine(request, last, number), last.trajectory
        else:
            if number > 3:
                break
            mesh, start = _after_failure(request, rounds, guess)
        tell(Progress("refine", f"{mesh.grid.steps} intervals, {1000 * mesh.extra:.0f} mm beyond the margin", number))
        rounds.append(run_round(request, mesh, start, number, tell))
    return rounds


def _first_mesh(request: Request, guess: Trajectory, steps: int) -> Mesh:
    grid = TimeGrid.uniform(steps)
    active = near_guess(guess, grid, request.scenario, request.vehicle, REACH)
    return Mesh(grid, poses_for(request.formulation, guess, request.vehicle, steps), EXTRA, active)


def _after_failure(request: Request, rounds: list[Round], guess: Trajectory) -> tuple[Mesh, Trajectory]:
    """After a failed solve: from the last solution if there is one, otherwise from the guess; a finer mesh."""
    last = rounds[-1].mesh
    solved = [outcome for outcome in rounds if outcome.solved]
    if solved:
        mesh = solved[-1].mesh
        every = np.arange(mesh.grid.steps)
        finer = replace(mesh, grid=mesh.grid.split(every), active=np.repeat(mesh.active, 2, axis=0), extra=EXTRA)
        return finer, solved[-1].trajectory
    steps = int(np.ceil(1.5 * last.grid.steps))
    mesh = _first_mesh(request, guess, steps)
    return replace(mesh, poses=last.poses + 1 if last.poses > 1 else 1, extra=EXTRA / 2), guess


def _report(
    request: Request, found: GuessResult, rounds: list[Round], guessed: float, total: float
) -> dict[str, Any]:
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
            "casadi": casadi.__version__,
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
        failed = "; ".join(check.sentence for check in last.certificate.failed)
        reason = f"No certified plan after {len(rounds)} rounds: {failed}."
    return PlanningError(reason, trajectory=last.trajectory, witness=witness, report=report)
