"""From a scene in memory to a certified plan, against hybrid A* and the paper's method on the plan's own mesh."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot.campaigns.speed.cases import MARGIN, by_the_paper, car, quantiles, scenes_about
from tightspot.errors import PlanningError
from tightspot.formulations import SeparatingLine
from tightspot.guesses import HybridAStar
from tightspot.planner import plan
from tightspot.scenarios import Scenario
from tightspot.trajectory import Trajectory
from tightspot.transcription import Settings, TimeGrid, transcribe
from tightspot.verification import Plan

CLOCKS = ("search", "set_up", "solve", "judge")
PARTS = (*CLOCKS, "other")
"""Of a plan's time; together all of it."""

SUBSTEPS = 2
"""As many as the planner takes."""


def compare_plans(scene: str, count: int, seed: int, tell: Callable[[str], None]) -> list[dict[str, Any]]:
    """One case a start: seconds of the plan and its parts, and of the paper's method.

    All plans and searches are made before IPOPT begins, after a plan that does not count: a process that plans has the
    planner in the processor's caches, not what CasADi needs to build a program; and what was left in memory before is
    not looked through for garbage meanwhile.
    """
    scenarios = list(scenes_about(scene, count, seed, MARGIN))
    timed_plan(scenarios[0])
    cases = []
    gc.collect()
    gc.freeze()
    try:
        for number, scenario in enumerate(scenarios):
            tell(f"plan {scene}, start {number + 1} of {count}")
            cases.append(timed_plan(scenario))
        searches = [timed_search(scenario) for scenario in scenarios]
    finally:
        gc.unfreeze()
    for number, (case, found) in enumerate(cases):
        tell(f"IPOPT on the plan's mesh, {scene}, start {number + 1} of {count}")
        if found is not None:
            seconds, guess = searches[number]
            case |= {"search_seconds": seconds, **_by_the_paper(scenarios[number], found, guess)}
    return [case for case, _ in cases]


def timed_search(scenario: Scenario) -> tuple[float, Trajectory | None]:
    """Hybrid A* by itself, as the paper's method begins."""
    vehicle = car()
    began = time.thread_time()
    guess = HybridAStar().make(scenario, vehicle, margin=scenario.margin).trajectory
    return time.thread_time() - began, guess


def timed_plan(scenario: Scenario) -> tuple[dict[str, Any], Plan | None]:
    """Plan with the default settings; seconds and parts of it."""
    vehicle = car()
    began = time.process_time()
    try:
        found = plan(scenario, vehicle=vehicle)
    except PlanningError as error:
        return {"success": False, "seconds": time.process_time() - began, "reason": error.reason}, None
    seconds = time.process_time() - began
    return {"success": True, "seconds": seconds, **_parts(found, seconds)}, found


def _parts(found: Plan, seconds: float) -> dict[str, Any]:
    """The plan's time, split as its own clock says; ``other`` is what that clock has under no name."""
    report = found.report
    clock = {"search": float(report["guess"]["seconds"])}
    for part in CLOCKS[1:]:
        clock[part] = sum(float(outcome["timings"].get(part, 0.0)) for outcome in report["rounds"])
    whole = max(float(report["seconds"]), sum(clock.values()), 1e-9)
    clock["other"] = whole - sum(clock.values())
    return {
        "parts": {part: seconds / whole * clock[part] for part in PARTS},
        "rounds": len(report["rounds"]),
        "steps": len(found.trajectory.inputs),
        "solver": report["rounds"][-1]["solve"]["solver"],
        "tried": len(report["tried"]),
        "objective": report["objective"]["value"],
    }


def _by_the_paper(scenario: Scenario, found: Plan, guess: Trajectory | None) -> dict[str, Any]:
    """IPOPT (17) at the plan's knots from hybrid A*'s guess; building the program is told, but does not count."""
    assert guess is not None
    t = found.trajectory.t
    fractions = (t - t[0]) / (t[-1] - t[0])
    fractions[-1] = 1.0
    settings = Settings(formulation=SeparatingLine(), margin=found.certificate.margin, substeps=SUBSTEPS)
    began = time.thread_time()
    nlp = transcribe(scenario, car(), guess, settings, grid=TimeGrid(fractions)).nlp
    transcribed = time.thread_time() - began
    theirs, seconds = by_the_paper(nlp)
    return {
        "ipopt_seconds": seconds,
        "ipopt_set_up_seconds": transcribed + theirs.timings["build"],
        "ipopt_success": theirs.status.success,
        "ipopt_iterations": theirs.iterations,
    }


def plan_summary(cases: list[dict[str, Any]]) -> dict[str, Any]:
    """Medians over the cases with a plan, and ratios over those of them that IPOPT solves, too."""
    good = [case for case in cases if case["success"]]
    both = [case for case in good if case["ipopt_success"]]
    counts = {"starts": len(cases), "success": len(good) / len(cases)}
    if not both:
        return counts
    return {
        **counts,
        "ipopt_success": len(both) / len(good),
        **{name: quantiles(values) for name, values in ratios(both).items()},
        "milliseconds": quantiles([1e3 * case["seconds"] for case in good]),
        "parts_milliseconds": {part: float(1e3 * np.median([case["parts"][part] for case in good])) for part in PARTS},
        "search_milliseconds": quantiles([1e3 * case["search_seconds"] for case in good]),
        "ipopt_milliseconds": quantiles([1e3 * case["ipopt_seconds"] for case in both]),
        "ipopt_set_up_milliseconds": float(1e3 * np.median([case["ipopt_set_up_seconds"] for case in both])),
        "steps": float(np.median([case["steps"] for case in good])),
        "rounds": float(np.median([case["rounds"] for case in good])),
    }


def ratios(cases: Sequence[dict[str, Any]]) -> dict[str, NDArray[np.float64]]:
    """Of each case that both sides solve.

    ``ratio``: hybrid A* and the paper's solve, its program being there, over the plan; ``ratio_with_building``: with
    the time to build that program; ``search_ratio``: the paper's solve over hybrid A*.
    """
    names = ("seconds", "search_seconds", "ipopt_seconds", "ipopt_set_up_seconds")
    plan_, search, ipopt, build = (np.array([case[name] for case in cases]) for name in names)
    return {
        "ratio": (search + ipopt) / plan_,
        "ratio_with_building": (search + ipopt + build) / plan_,
        "search_ratio": ipopt / search,
    }
