"""How often and how fast the stagewise solver gets from a straight line to a solution, beside IPOPT from the same line.

    python -m benchmarks.straight_lines [--starts N] [--reference N] [--substeps N] [--seed N] [--json FILE]

The guess is a straight line in state space that ignores dynamics and obstacles. Scenes are the paper's three, with 20
intervals; starts are the scene's and random ones about it. IPOPT solves formulation (17) with its default options, from
the first ``--reference`` starts only: it takes long. Times are processor times of the solving thread.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from tightspot.campaigns.speed.cases import GAP, SCENES, STEPS, by_the_paper, car, scenes_about, settings_for
from tightspot.guesses import LinearInterpolation
from tightspot.scenarios import Scenario
from tightspot.solvers.stagewise import Stagewise
from tightspot.trajectory import Trajectory
from tightspot.transcription import TimeGrid, transcribe
from tightspot.transcription.stage_problem import stage_problem


def line(scenario: Scenario) -> Trajectory:
    """From start to goal."""
    guess = LinearInterpolation().make(scenario, car(), margin=GAP).trajectory
    assert guess is not None
    return guess


def measure(scenario: Scenario, guess: Trajectory, weight: float, substeps: int, *, reference: bool) -> dict[str, Any]:
    """The stagewise solver on one start, plainly and robustly, and IPOPT if asked to."""
    arguments, grid = (scenario, car(), guess, settings_for(weight, substeps)), TimeGrid.uniform(STEPS)
    problem = stage_problem(*arguments, grid=grid)
    plain = Stagewise(robust=False).solve_stages(problem)
    began = time.thread_time()
    ours = Stagewise().solve_stages(problem)
    case: dict[str, Any] = {
        "seconds": time.thread_time() - began,
        "plain": plain.status.success,
        "success": ours.status.success,
        "objective": ours.objective if ours.status.success else np.inf,
        "attempts": len(ours.attempts),
        "iterations": ours.iterations,
    }
    if reference:
        nlp = transcribe(*arguments, grid=grid).nlp
        theirs, case["ipopt_seconds"] = by_the_paper(nlp)
        case["ipopt_success"] = theirs.status.success
        case["ipopt_objective"] = theirs.objective if theirs.status.success else np.inf
    return case


def summary(cases: list[dict[str, Any]]) -> dict[str, Any]:
    """Shares, medians, and the median of IPOPT's time over ours."""
    both = [case for case in cases if "ipopt_seconds" in case]
    near = [(case["objective"], case["ipopt_objective"], 1.01 * min(_objectives(case))) for case in both]
    return {
        "starts": len(cases),
        "plain": statistics.mean(case["plain"] for case in cases),
        "success": statistics.mean(case["success"] for case in cases),
        "first_way": statistics.mean(case["success"] and case["attempts"] <= 2 for case in cases),
        "milliseconds": 1e3 * statistics.median(case["seconds"] for case in cases),
        "slowest_milliseconds": 1e3 * max(case["seconds"] for case in cases),
        "iterations": statistics.median(case["iterations"] for case in cases),
        "reference_starts": len(both),
        "ipopt_success": statistics.mean(case["ipopt_success"] for case in both),
        "ipopt_milliseconds": 1e3 * statistics.median(case["ipopt_seconds"] for case in both),
        "ratio": statistics.median(case["ipopt_seconds"] / case["seconds"] for case in both),
        "near_best": statistics.mean(ours <= best for ours, _, best in near),
        "ipopt_near_best": statistics.mean(theirs <= best for _, theirs, best in near),
    }


def _objectives(case: dict[str, Any]) -> tuple[float, float]:
    return case["objective"], case["ipopt_objective"]


def main() -> None:
    """Measure and print a table; write the figures as JSON if asked to."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--starts", type=int, default=34, help="starts a scene")
    parser.add_argument("--reference", type=int, default=5, help="starts a scene that IPOPT solves, too; at least 1")
    parser.add_argument("--substeps", type=int, default=1, help="Runge-Kutta steps an interval")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    results: dict[str, Any] = {"seed": options.seed, "substeps": options.substeps}
    columns = ["r", "scene", "solved", "without robust", "by the first way", "ms", "slowest", "IPOPT ms", "ratio"]
    columns += ["IPOPT solved", "within 1 % of the better"]
    lines = [f"seed {options.seed}", "| " + " | ".join(columns) + " |", "|---" * len(columns) + "|"]
    for weight in (1.0, 0.01):
        everything = []
        for scene in SCENES:
            cases = [
                measure(scenario, line(scenario), weight, options.substeps, reference=index < options.reference)
                for index, scenario in enumerate(scenes_about(scene, options.starts, options.seed, GAP))
            ]
            everything += cases
            results[f"{scene}, r = {weight:g}"] = summary(cases)
            lines.append(_line(weight, scene, summary(cases)))
        results[f"all, r = {weight:g}"] = summary(everything)
        lines.append(_line(weight, "all", summary(everything)))
    sys.stdout.write("\n".join(lines) + "\n")
    if options.json:
        options.json.write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")


def _line(weight: float, scene: str, figures: dict[str, Any]) -> str:
    shares = {name: f"{100 * figures[name]:.0f} %" for name in ("success", "plain", "first_way", "ipopt_success")}
    return (
        f"| {weight:g} | {scene} | {shares['success']} | {shares['plain']} | {shares['first_way']} "
        f"| {figures['milliseconds']:.1f} | {figures['slowest_milliseconds']:.0f} "
        f"| {figures['ipopt_milliseconds']:.0f} | {figures['ratio']:.0f} | {shares['ipopt_success']} "
        f"| {100 * figures['near_best']:.0f} % against {100 * figures['ipopt_near_best']:.0f} % |"
    )


if __name__ == "__main__":
    main()
