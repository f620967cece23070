"""Solves a second, re-solving after a small move, and the best of many guesses."""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import statistics
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from tightspot.campaigns.best_of import best_of
from tightspot.campaigns.claims import SAME
from tightspot.campaigns.settings import paper_settings
from tightspot.campaigns.speed.cases import (
    ENERGY_AND_TIME,
    GAP,
    STEPS,
    Start,
    by_the_paper,
    car,
    quantiles,
    settings_for,
)
from tightspot.campaigns.speed.cases import (
    MARGIN as PLAN_MARGIN,
)
from tightspot.campaigns.table import BETTER
from tightspot.errors import InputError, PlanningError
from tightspot.formulations import SeparatingLine
from tightspot.guesses import HybridAStar
from tightspot.planner import Planner, plan
from tightspot.scenarios import Scenario, check
from tightspot.solvers import StageReport, Stagewise, solve_many
from tightspot.solvers.stage_core import core_solver
from tightspot.solvers.stage_problem import StageProblem
from tightspot.transcription import TimeGrid, moved_ends, stage_problem, transcribe

MOVED = np.array([0.10, np.deg2rad(2.0)])
"""How far a start is moved and turned, m and rad."""

REPEATS = 5
PLANS = 20
"""Of each batch's scenes so many are planned."""


def batch(starts: Sequence[Start], tell: Callable[[str], None]) -> dict[str, Any]:
    """What one thread does in a second of processor time, by the public calls; only successes count.

    Solves of problems in memory, the same with every problem built from its scene and guess first, and certified plans.
    """
    tell(f"batch of {len(starts)}")
    problems = [_problem(start) for start in starts]
    solve_many(problems[:2])
    rates, built = [], []
    for _ in range(REPEATS):
        began = time.thread_time()
        reports = solve_many(problems)
        halfway = time.thread_time()
        again = solve_many([_problem(start) for start in starts])
        built.append(sum(report.status.success for report in again) / (time.thread_time() - halfway))
        rates.append(sum(report.status.success for report in reports) / (halfway - began))
    return {
        "problems": len(problems),
        "solves_per_second": statistics.median(rates),
        "solves_per_second_built": statistics.median(built),
        "success": float(np.mean([report.status.success for report in reports])),
        "plans_per_second": _plans_per_second([start.scenario for start in starts[:PLANS]]),
    }


def _plans_per_second(scenes: Sequence[Scenario]) -> float:
    plan(scenes[0], vehicle=car(), margin=PLAN_MARGIN)
    made, began = 0, time.thread_time()
    for scene in scenes:
        with contextlib.suppress(PlanningError, InputError):
            made += plan(scene, vehicle=car(), margin=PLAN_MARGIN).certificate.certified
    return made / (time.thread_time() - began)


def warm(starts: Sequence[Start], seed: int, tell: Callable[[str], None]) -> dict[str, Any]:
    """The solve after the start has moved a little: from the guess for the new start, and from the last solution.

    ``ratio`` is that of the solves alone, set-up on neither side. ``ratio_with_set_up`` has on both sides all that is
    to be done once the start is known. Anew: arrays from scene and guess, the core, the solve and its report, but not
    the search for the guess. Warm: the arrays with the new start, the solve by the kept core, its report.
    """
    rng = np.random.default_rng(seed)
    solver = Stagewise()
    ratios, with_set_up, iterations, solved = [], [], [], []
    for number, start in enumerate(starts):
        tell(f"warm re-solve {number + 1} of {len(starts)}")
        before = solver.solve_stages(_problem(start))
        moved = _moved(start, rng)
        if moved is None or before.problem is None or not before.status.success:
            continue
        core = core_solver(before.problem)
        cold_seconds, cold_all, cold = _timed(functools.partial(_anew, solver, moved))
        warm_seconds, warm_all, warmed = _timed(functools.partial(_again, solver, moved.scenario, before, core))
        solved.append(warmed.status.success)
        if cold.status.success and warmed.status.success:
            ratios.append(cold_seconds / warm_seconds)
            with_set_up.append(cold_all / warm_all)
            iterations.append((cold.iterations, warmed.iterations))
    if not ratios:
        return {"cases": len(solved), "success": float(np.mean(solved)) if solved else None}
    median_iterations = np.median(np.array(iterations), axis=0)
    return {
        "cases": len(solved),
        "success": float(np.mean(solved)),
        "ratio": quantiles(ratios),
        "ratio_with_set_up": quantiles(with_set_up),
        "iterations_cold": float(median_iterations[0]),
        "iterations_warm": float(median_iterations[1]),
    }


def _anew(solver: Stagewise, start: Start) -> StageReport:
    return solver.solve_stages(_problem(start))


def _again(solver: Stagewise, scenario: Scenario, before: StageReport, core: Any) -> StageReport:
    problem = moved_ends(before, scenario)
    assert problem is not None
    assert before.point is not None
    point = dataclasses.replace(before.point, v=problem.starting_point())
    return solver.solve_stages(problem, warm=point, core=core)


def warm_plans(scenes: Sequence[Scenario], seed: int, tell: Callable[[str], None]) -> dict[str, Any]:
    """Whole plans after the start has moved a little: by a :class:`tightspot.Planner` that has planned, and anew."""
    rng = np.random.default_rng(seed)
    ratios, used, tried = [], 0, 0
    for number, scenario in enumerate(scenes):
        tell(f"warm plan {number + 1} of {len(scenes)}")
        moved = _moved_scene(scenario, rng, scenario.margin)
        if moved is None:
            continue
        tried += 1
        try:
            planner = Planner(scenario, vehicle=car())
            planner.plan()
            began = time.process_time()
            again = planner.plan(start=moved.start)
            halfway = time.process_time()
            plan(moved, vehicle=car())
        except PlanningError:
            continue
        ratios.append((time.process_time() - halfway) / (halfway - began))
        used += bool(again.report["warm"]["used"])
    if not ratios:
        return {"cases": tried, "success": 0.0 if tried else None}
    return {"cases": tried, "success": len(ratios) / tried, "used": used / len(ratios), "ratio": quantiles(ratios)}


def best_of_many(runs: int, seed: int, tell: Callable[[str], None]) -> dict[str, Any]:
    """How often a batch of guesses finds the best known optimum of the paper's programs, against one IPOPT solve."""
    return {known.scene: _best_of(known.scene, known.objective, runs, seed, tell) for known in BETTER}


def _best_of(scene: str, known: float, runs: int, seed: int, tell: Callable[[str], None]) -> dict[str, Any]:
    settings = paper_settings()
    scenario, vehicle = settings.scenario(scene), settings.car()
    guess = HybridAStar().make(scenario, vehicle, margin=settings.gap).trajectory
    assert guess is not None
    grid = TimeGrid.uniform(settings.steps)
    nlp = transcribe(scenario, vehicle, guess, settings.transcription(SeparatingLine()), grid=grid).nlp
    ipopt = [by_the_paper(nlp).seconds for _ in range(3)]
    found, times = 0, []
    for run in range(runs):
        tell(f"best of many, {scene}, run {run + 1} of {runs}")
        began = time.process_time()
        optima = best_of(scene, seed + run)
        times.append(time.process_time() - began)
        found += bool(optima) and abs(optima[0].objective - known) <= SAME * known
    return {
        "objective": known,
        "runs": runs,
        "found": found,
        "milliseconds": quantiles([1e3 * value for value in times]),
        "ipopt_milliseconds": 1e3 * statistics.median(ipopt),
        "ratio": statistics.median(ipopt) / statistics.median(times),
    }


def _problem(start: Start) -> StageProblem:
    settings = settings_for(ENERGY_AND_TIME)
    return stage_problem(start.scenario, car(), start.guess, settings, grid=TimeGrid.uniform(STEPS))


def _timed(make: Callable[[], StageReport]) -> tuple[float, float, StageReport]:
    """Seconds of the solve alone, by the solver's clock, and of all, by the thread's; medians."""
    solves, times = [], []
    for _ in range(REPEATS):
        began = time.thread_time()
        report = make()
        times.append(time.thread_time() - began)
        solves.append(report.timings["solve"])
    return statistics.median(solves), statistics.median(times), report


def _moved(start: Start, rng: np.random.Generator) -> Start | None:
    """The moved scene with a new guess; ``None`` if it is not free there."""
    scenario = _moved_scene(start.scenario, rng, GAP)
    guess = None if scenario is None else HybridAStar().make(scenario, car(), margin=GAP).trajectory
    return None if scenario is None or guess is None else Start(scenario, guess)


def _moved_scene(scenario: Scenario, rng: np.random.Generator, margin: float) -> Scenario | None:
    """The start moved by :data:`MOVED` in a random direction; ``None`` if the vehicle does not stand free there."""
    angle, sign = rng.uniform(0.0, 2 * np.pi), rng.choice((-1.0, 1.0))
    state = np.array(scenario.start)
    state[:3] += [MOVED[0] * np.cos(angle), MOVED[0] * np.sin(angle), sign * MOVED[1]]
    moved = dataclasses.replace(scenario, start=state)
    try:
        check(moved, car(), margin)
    except InputError:
        return None
    return moved
