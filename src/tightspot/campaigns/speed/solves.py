"""The stagewise solver against the paper's method: the same guess, mesh, formulation, bounds and tolerance."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from tightspot.campaigns.speed.cases import STEPS, Start, by_the_paper, car, quantiles, settings_for
from tightspot.guesses import LinearInterpolation
from tightspot.solvers import Stagewise
from tightspot.solvers.functions import complementarity, lagrangian_gradient, values
from tightspot.solvers.nlp import Nlp
from tightspot.solvers.stagewise import StageReport, core_solver
from tightspot.transcription import TimeGrid, stage_problem, transcribe

REPEATS = 5
Case = dict[str, Any]


def compare(
    start: Start, weight: float, *, steps: int = STEPS, substeps: int = 4, solver: Stagewise | None = None
) -> Case:
    """Both on one start: seconds, objective, iterations, success; and the largest residual of our answer."""
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
    return {
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
    starts: Sequence[Start], weight: float, tell: Callable[[str], None], *, solver: Stagewise | None = None
) -> list[Case]:
    """One case a start."""
    cases = []
    for number, start in enumerate(starts):
        tell(f"{start.scenario.name}, r = {weight:g}, start {number + 1} of {len(starts)}")
        cases.append(compare(start, weight, solver=solver))
    return cases


def summary(cases: Sequence[Case]) -> dict[str, Any]:
    """Ratios of the cases that we solve, success rates, and how often each is within 1 % of the better of the two."""
    column = {key: np.array([case[key] for case in cases]) for key in cases[0]}
    ours = np.where(column["success"], column["objective"], np.inf)
    theirs = np.where(column["ipopt_success"], column["ipopt_objective"], np.inf)
    best = 1.01 * np.minimum(ours, theirs)
    solved = column["residual"][column["success"]]
    return {
        "starts": len(cases),
        "ratio": quantiles((column["ipopt_seconds"] / column["seconds"])[column["success"]]) if solved.size else None,
        "milliseconds": quantiles(1e3 * column["seconds"]),
        "set_up_milliseconds": float(1e3 * np.median(column["set_up_seconds"])),
        "ipopt_milliseconds": quantiles(1e3 * column["ipopt_seconds"]),
        "iterations": float(np.median(column["iterations"])),
        "ipopt_iterations": float(np.median(column["ipopt_iterations"])),
        "success": float(column["success"].mean()),
        "ipopt_success": float(column["ipopt_success"].mean()),
        "near_best": float(np.mean((ours <= best) & np.isfinite(ours))),
        "ipopt_near_best": float(np.mean((theirs <= best) & np.isfinite(theirs))),
        "largest_residual": float(solved.max()) if solved.size else None,
    }
