"""Solves a second, re-solving after a small move, and the best of many guesses."""

from __future__ import annotations

import dataclasses
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
from tightspot.campaigns.table import BETTER
from tightspot.errors import InputError, PlanningError
from tightspot.formulations import SeparatingLine
from tightspot.guesses import HybridAStar
from tightspot.planner import Planner, plan
from tightspot.scenarios import Scenario, check
from tightspot.solvers import Stagewise
from tightspot.solvers.stage_problem import StageProblem
from tightspot.transcription import TimeGrid, stage_problem, transcribe

MOVED = np.array([0.10, np.deg2rad(2.0)])
"""How far a start is moved and turned, m and rad."""

WARM_BARRIER = 1e-3
REPEATS = 5


def batch(starts: Sequence[Start], tell: Callable[[str], None]) -> dict[str, Any]:
    """Solves of one thread a second, by the public call, from problems in memory; only solved ones count."""
    tell(f"batch of {len(starts)}")
    problems = [_problem(start) for start in starts]
    solver = Stagewise()
    solver.solve_many(problems[:2])
    rates = []
    for _ in range(REPEATS):
        began = time.thread_time()
        reports = solver.solve_many(problems)
        rates.append(sum(report.status.success for report in reports) / (time.thread_time() - began))
    return {
        "problems": len(problems),
        "solves_per_second": statistics.median(rates),
        "success": float(np.mean([report.status.success for report in reports])),
    }


def warm(starts: Sequence[Start], seed: int, tell: Callable[[str], None]) -> dict[str, Any]:
    """The solve after the start has moved a little: from the guess for the new start, and from the last solution."""
    rng = np.random.default_rng(seed)
    cold_solver, warm_solver = Stagewise(), Stagewise(initial_barrier=WARM_BARRIER)
    ratios, iterations, solved = [], [], []
    for number, start in enumerate(starts):
        tell(f"warm re-solve {number + 1} of {len(starts)}")
        before = cold_solver.solve_stages(_problem(start))
        moved = _moved(start, rng)
        if moved is None or before.lines is None or not before.status.success:
            continue
        again = _problem(Start(moved.scenario, _trajectory_of(start, before)))
        again = again.replaced(lines=before.lines)
        cold_seconds, cold = _timed(cold_solver, _problem(moved))
        warm_seconds, warmed = _timed(warm_solver, again)
        solved.append(warmed.status.success)
        if cold.status.success and warmed.status.success:
            ratios.append(cold_seconds / warm_seconds)
            iterations.append((cold.iterations, warmed.iterations))
    if not ratios:
        return {"cases": len(solved), "success": float(np.mean(solved)) if solved else None}
    median_iterations = np.median(np.array(iterations), axis=0)
    return {
        "cases": len(solved),
        "success": float(np.mean(solved)),
        "ratio": quantiles(ratios),
        "iterations_cold": float(median_iterations[0]),
        "iterations_warm": float(median_iterations[1]),
    }


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


def _timed(solver: Stagewise, problem: StageProblem) -> tuple[float, Any]:
    times = []
    for _ in range(REPEATS):
        report = solver.solve_stages(problem)
        times.append(report.timings["solve"])
    return statistics.median(times), report


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


def _trajectory_of(start: Start, report: Any) -> Any:
    """The solution as a guess."""
    grid = TimeGrid.uniform(STEPS)
    fields = {"t": report.final_time * grid.fractions, "states": report.states, "inputs": report.inputs}
    return dataclasses.replace(start.guess, **fields)
