"""The stagewise solver against the paper's method: the same guess, mesh, formulation, bounds and tolerance."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from tightspot.campaigns.speed.cases import GAP, STEPS, Start, by_the_paper, car, quantiles, settings_for
from tightspot.guesses import LinearInterpolation, assorted
from tightspot.planner.optima import find_optima
from tightspot.solvers import Stagewise
from tightspot.solvers.functions import complementarity, lagrangian_gradient, values
from tightspot.solvers.nlp import Nlp
from tightspot.solvers.stage_core import core_solver
from tightspot.solvers.stage_report import StageReport
from tightspot.transcription import TimeGrid, stage_problem, transcribe

REPEATS = 5
GUESSES = 10
NEAR = 1.01
"""J over the best known J that still counts as near it."""

Case = dict[str, Any]


def best_known(start: Start, weights: Sequence[float]) -> tuple[float, ...]:
    """For each weight the best J that ten guesses of all kinds lead the stagewise solver to; infinite if none does."""
    vehicle, grid = car(), TimeGrid.uniform(STEPS)
    guesses = assorted(start.scenario, vehicle, GUESSES, margin=GAP)
    found = (find_optima(start.scenario, vehicle, settings_for(weight), guesses, grid=grid) for weight in weights)
    return tuple(optima[0].objective if optima else np.inf for optima in found)


def compare(
    start: Start,
    weight: float,
    *,
    steps: int = STEPS,
    substeps: int = 4,
    solver: Stagewise | None = None,
    known: float = np.inf,
) -> Case:
    """Both on one start: seconds, objective, iterations, success; and the largest residual of our answer.

    ``best`` is the best J known: the smallest of ``known`` and what both solvers find.
    """
    settings, grid, vehicle = settings_for(weight, substeps), TimeGrid.uniform(steps), car()
    solver = solver or Stagewise()
    nlp = transcribe(start.scenario, vehicle, start.guess, settings, grid=grid).nlp
    theirs, seconds = by_the_paper(nlp)
    built, solved = [], []
    problem = None
    for _ in range(REPEATS):
        began = time.thread_time()
        problem = stage_problem(start.scenario, vehicle, start.guess, settings, grid=grid)
        core = core_solver(problem)
        core.set(problem.starting_point())
        halfway = time.thread_time()
        core.solve(solver.options())
        built.append(halfway - began)
        solved.append(time.thread_time() - halfway)
    assert problem is not None
    began = time.thread_time()
    ours = solver.solve_stages(problem)
    if len(ours.attempts) > 1:  # other starts count, too
        solved = [time.thread_time() - began]
    reports = (ours, theirs)
    return {
        "best": min(known, *(report.objective if report.status.success else np.inf for report in reports)),
        "ipopt_seconds": seconds,
        "ipopt_iterations": theirs.iterations,
        "ipopt_success": theirs.status.success,
        "ipopt_objective": theirs.objective,
        "seconds": statistics.median(solved),
        "set_up_seconds": statistics.median(built),
        "iterations": ours.iterations,
        "success": ours.status.success,
        "objective": ours.objective,
        "residual": residual(nlp, ours),
    }


def residual(nlp: Nlp, report: StageReport) -> float:
    """The largest of violation, stationarity and complementarity, computed with the functions that IPOPT is given.

    The latter two are divided by the mean multiplier where that is above 100, as IPOPT does before it compares with
    its tolerance.
    """
    _, g = values(nlp, report.x)
    multipliers = np.concatenate([report.lam_g, report.lam_x])
    scale = max(100.0, float(np.abs(multipliers).mean())) / 100.0
    gradient = np.abs(lagrangian_gradient(nlp, report.x, report.lam_g) + report.lam_x).max()
    gap = complementarity(nlp, report.x, g, report.lam_x, report.lam_g)
    return float(max(nlp.worst(report.x, g)[1], gradient / scale, gap / scale))


def straight(start: Start) -> Start:
    """The same scene with the straight-line guess."""
    guess = LinearInterpolation().make(start.scenario, car(), margin=0.0).trajectory
    assert guess is not None
    return Start(start.scenario, guess)


def compare_all(
    starts: Sequence[Start], weight: float, known: Sequence[float], tell: Callable[[str], None]
) -> list[Case]:
    """One case a start, with the best J known of each."""
    cases = []
    for number, (start, best) in enumerate(zip(starts, known, strict=True)):
        tell(f"{start.scenario.name}, r = {weight:g}, start {number + 1} of {len(starts)}")
        cases.append(compare(start, weight, known=best))
    return cases


def summary(cases: Sequence[Case]) -> dict[str, Any]:
    """Ratios of the cases that both solve, success rates, and how often each is within 1 % of the best known J."""
    column = {key: np.array([case[key] for case in cases]) for key in cases[0]}
    both = column["success"] & column["ipopt_success"]
    near = {
        name: column[f"{name}success"] & (column[f"{name}objective"] <= NEAR * column["best"])
        for name in ("", "ipopt_")
    }
    solved = column["residual"][column["success"]]
    return {
        "starts": len(cases),
        "ratio": quantiles((column["ipopt_seconds"] / column["seconds"])[both]) if both.any() else None,
        "milliseconds": quantiles(1e3 * column["seconds"]),
        "set_up_milliseconds": float(1e3 * np.median(column["set_up_seconds"])),
        "ipopt_milliseconds": quantiles(1e3 * column["ipopt_seconds"]),
        "iterations": float(np.median(column["iterations"])),
        "ipopt_iterations": float(np.median(column["ipopt_iterations"])),
        "success": float(column["success"].mean()),
        "ipopt_success": float(column["ipopt_success"].mean()),
        "near_best": float(near[""].mean()),
        "ipopt_near_best": float(near["ipopt_"].mean()),
        "largest_residual": float(solved.max()) if solved.size else None,
    }
