"""How much faster the stagewise solver is than the paper's method, from the same hybrid A* guesses, in one process.

    python -m benchmarks.solver_speed [--starts N] [--substeps N] [--json FILE]

The paper's method: formulation (17) written with CasADi, solved by IPOPT with MUMPS and IPOPT's default options, to
1e-8. The stagewise solver gets the same guess, mesh, bounds, margin and tolerance, and formulation (17) too. Scenes are
the paper's three, with 20 intervals; starts are the scene's and random ones about it. Both are timed from the built
problem to the answer, in turns, by the processor time of their thread: other programs on the machine do not count.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import os
import platform
import statistics
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from tightspot.errors import InputError
from tightspot.formulations import SeparatingLine
from tightspot.guesses import HybridAStar
from tightspot.scenarios import Scenario, check
from tightspot.scenarios.library import builtin
from tightspot.solvers import Ipopt
from tightspot.solvers.stagewise import Stagewise, core_solver
from tightspot.trajectory import Trajectory
from tightspot.transcription import Objective, Settings, TimeGrid, transcribe
from tightspot.transcription.stage_problem import stage_problem
from tightspot.vehicles import vehicle

SCENES = ("oblique", "vertical", "parallel")
GAP = 0.002
STEPS = 20
AROUND = np.array([1.0, 0.5, 0.2])
PAPERS_METHOD = Ipopt(options={"mu_strategy": "monotone", "mumps_scaling": 77})


def starts(scene: str, count: int, seed: int) -> Iterator[tuple[Scenario, Trajectory]]:
    """The scene and versions of it that start elsewhere, each with its hybrid A* guess."""
    rng, base, car = np.random.default_rng(seed), builtin(scene), vehicle("paper")
    found = 0
    while found < count:
        start = np.array(base.start)
        if found:
            start[:3] += rng.uniform(-AROUND, AROUND)
        scenario = dataclasses.replace(base, start=start)
        try:
            check(scenario, car, GAP)
        except InputError:
            continue
        guess = HybridAStar().make(scenario, car, margin=GAP).trajectory
        if guess is not None:
            found += 1
            yield scenario, guess


def measure(scenario: Scenario, guess: Trajectory, weight: float, substeps: int, repeats: int = 5) -> dict[str, Any]:
    """Both solvers on one start: seconds, objective, iterations, success."""
    settings = Settings(objective=Objective(weight), formulation=SeparatingLine(), margin=GAP, substeps=substeps)
    car, grid = vehicle("paper"), TimeGrid.uniform(STEPS)
    nlp = transcribe(scenario, car, guess, settings, grid=grid).nlp
    began = time.thread_time()
    reference = PAPERS_METHOD.solve(nlp)
    parts = reference.timings
    ipopt_seconds = (time.thread_time() - began) * parts["solve"] / (parts["build"] + parts["solve"])
    built, solved = [], []
    for _ in range(repeats):
        began = time.thread_time()
        problem = stage_problem(scenario, car, guess, settings, grid=grid)
        core = core_solver(problem)
        core.set(problem.starting_point())
        halfway = time.thread_time()
        core.solve(Stagewise().options())
        built.append(halfway - began)
        solved.append(time.thread_time() - halfway)
    ours = Stagewise().solve_stages(problem)
    return {
        "ipopt_seconds": ipopt_seconds,
        "ipopt_iterations": reference.iterations,
        "ipopt_success": reference.status.success,
        "ipopt_objective": reference.objective,
        "seconds": statistics.median(solved),
        "setup_seconds": statistics.median(built),
        "iterations": ours.iterations,
        "success": ours.status.success,
        "objective": ours.objective,
    }


def summary(cases: list[dict[str, Any]]) -> dict[str, Any]:
    """Medians, success rates, and how often each is within 1 % of the better of the two."""
    column = {key: np.array([case[key] for case in cases]) for key in cases[0]}
    ours = np.where(column["success"], column["objective"], np.inf)
    theirs = np.where(column["ipopt_success"], column["ipopt_objective"], np.inf)
    best = 1.01 * np.minimum(ours, theirs)
    ratio = column["ipopt_seconds"] / column["seconds"]
    return {
        "starts": len(cases),
        "solve_ratio": float(np.median(ratio)),
        "solve_ratio_quartiles": [float(value) for value in np.quantile(ratio, (0.25, 0.75))],
        "milliseconds": 1e3 * float(np.median(column["seconds"])),
        "setup_milliseconds": 1e3 * float(np.median(column["setup_seconds"])),
        "ipopt_milliseconds": 1e3 * float(np.median(column["ipopt_seconds"])),
        "iterations": float(np.median(column["iterations"])),
        "ipopt_iterations": float(np.median(column["ipopt_iterations"])),
        "success": float(column["success"].mean()),
        "ipopt_success": float(column["ipopt_success"].mean()),
        "near_best": float(np.mean(ours <= best)),
        "ipopt_near_best": float(np.mean(theirs <= best)),
    }


def main() -> None:
    """Measure and print a table; write the figures as JSON if asked to."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--starts", type=int, default=100, help="starts a scene")
    parser.add_argument("--substeps", type=int, default=4, help="Runge-Kutta steps an interval")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    results: dict[str, Any] = {"machine": platform.processor() or platform.machine(), "cores": os.cpu_count()}
    results |= {"python": platform.python_version(), "casadi": ca.__version__, "substeps": options.substeps}
    lines = ["| r | scene | ratio | ms | IPOPT ms | iterations | solved | within 1 % of the better |", "|---" * 8 + "|"]
    for weight in (1.0, 0.01):
        everything = []
        for scene in SCENES:
            cases = [measure(*start, weight, options.substeps) for start in starts(scene, options.starts, options.seed)]
            everything += cases
            results[f"{scene}, r = {weight:g}"] = summary(cases)
            lines.append(_line(f"{weight:g}", scene, summary(cases)))
        results[f"all, r = {weight:g}"] = summary(everything)
        lines.append(_line(f"{weight:g}", "all", summary(everything)))
    sys.stdout.write("\n".join(lines) + "\n")
    if options.json:
        options.json.write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")


def _line(weight: str, scene: str, figures: dict[str, Any]) -> str:
    shares = [100 * figures[key] for key in ("success", "ipopt_success", "near_best", "ipopt_near_best")]
    return (
        f"| {weight} | {scene} | {figures['solve_ratio']:.0f} | {figures['milliseconds']:.2f} "
        f"| {figures['ipopt_milliseconds']:.0f} "
        f"| {figures['iterations']:.0f} against {figures['ipopt_iterations']:.0f} "
        f"| {shares[0]:.0f} % against {shares[1]:.0f} % | {shares[2]:.0f} % against {shares[3]:.0f} % |"
    )


if __name__ == "__main__":
    main()
