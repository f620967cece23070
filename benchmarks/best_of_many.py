"""How often a batch of guesses finds the best known optima of the paper's programs, and in what time.

    python -m benchmarks.best_of_many [--runs N] [--guesses N] [--threads N] [--json FILE]

The programs are those of Table II with the recovered settings, formulation (17). A run is one seed:
``tightspot.campaigns.best_of`` makes the guesses, solves all of them with the stagewise solver and keeps the best
optimum. It counts as found within 0.2 % of J. The time is compared with one solve of the same program by IPOPT with
MUMPS from the hybrid A* guess, without the time to build its derivatives: in processor time on one thread, and on the
clock with several threads, in turns in one process.

Some guesses are the same for all seeds. So that the seeds mean something, the runs are also counted by the guesses that
were drawn at random only.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import statistics
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tightspot.campaigns.best_of import GUESSES, best_of
from tightspot.campaigns.claims import SAME
from tightspot.campaigns.settings import paper_settings
from tightspot.campaigns.table import BETTER
from tightspot.formulations import SeparatingLine
from tightspot.guesses import HybridAStar, assorted
from tightspot.planner.optima import Optimum
from tightspot.transcription import TimeGrid, transcribe

EVERY = 10
"""IPOPT solves once every so many runs."""


def figures(runs: int = 100, guesses: int = GUESSES, threads: int = 2) -> dict[str, Any]:
    """One object a scene, and the machine."""
    scenes = {known.scene: _scene(known.scene, known.objective, runs, guesses, threads) for known in BETTER}
    machine = platform.processor() or platform.machine()
    return {"machine": machine, "cores": os.cpu_count(), "runs": runs, "guesses": guesses, "scenes": scenes}


def _scene(scene: str, known: float, runs: int, guesses: int, threads: int) -> dict[str, Any]:
    best_of(scene, count=guesses)
    found, drawn, hits, processor, clock, ipopt_processor, ipopt_clock = 0, 0, 0, [], [], [], []
    iterations, solved = 0, 0
    for seed in range(runs):
        began = time.process_time()
        optima = best_of(scene, seed, count=guesses)
        processor.append(time.process_time() - began)
        began = time.perf_counter()
        best_of(scene, seed, count=guesses, threads=threads)
        clock.append(time.perf_counter() - began)
        right = [optimum for optimum in optima if abs(optimum.objective - known) <= SAME * known]
        found += bool(right) and right[0] is optima[0]
        hits += sum(len(optimum.indices) for optimum in right)
        solved += sum(len(optimum.indices) for optimum in optima)
        drawn += _is_found_by_chance(scene, seed, guesses, right)
        if seed % EVERY == 0:
            processor_seconds, clock_seconds, iterations = _ipopt(scene)
            ipopt_processor.append(processor_seconds)
            ipopt_clock.append(clock_seconds)
    return {
        "objective": known,
        "found": found,
        "found_by_what_is_drawn": drawn,
        "share_of_guesses": hits / (runs * guesses),
        "share_solved": solved / (runs * guesses),
        "milliseconds": 1e3 * statistics.median(processor),
        "slowest_milliseconds": 1e3 * max(processor),
        "ipopt_milliseconds": 1e3 * statistics.median(ipopt_processor),
        "ipopt_iterations": iterations,
        "ratio": statistics.median(ipopt_processor) / statistics.median(processor),
        "clock_ratio": statistics.median(ipopt_clock) / statistics.median(clock),
        "threads": threads,
    }


def _is_found_by_chance(scene: str, seed: int, guesses: int, right: Sequence[Optimum]) -> bool:
    """Whether a guess that depends on the seed led there."""
    settings = paper_settings()
    made = assorted(settings.scenario(scene), settings.car(), guesses, seed, margin=settings.gap)
    names = [guess.report["variant"] for guess in made if guess.trajectory is not None]
    indices = [index for optimum in right for index in optimum.indices]
    return any("random" in names[index] or "bent" in names[index] for index in indices)


def _ipopt(scene: str) -> tuple[float, float, int]:
    """Processor time and time on the clock of one solve, s, without what building the derivatives takes; iterations."""
    settings = paper_settings()
    scenario, car = settings.scenario(scene), settings.car()
    guess = HybridAStar().make(scenario, car, margin=settings.gap).trajectory
    if guess is None:
        raise RuntimeError(f"hybrid A* finds no path in {scene}")
    wanted, grid = settings.transcription(SeparatingLine()), TimeGrid.uniform(settings.steps)
    nlp = transcribe(scenario, car, guess, wanted, grid=grid).nlp
    began = time.process_time()
    report = settings.solver(60.0).solve(nlp)
    spent = time.process_time() - began
    share = report.timings["solve"] / (report.timings["build"] + report.timings["solve"])
    return share * spent, report.timings["solve"], report.iterations


def table(results: dict[str, Any]) -> str:
    """The figures as a table."""
    lines = [
        "| scene | J | found | by what is drawn | of all guesses | ms | IPOPT ms | ratio | on the clock |",
        "|---" * 9 + "|",
    ]
    for scene, row in results["scenes"].items():
        lines.append(
            f"| {scene} | {row['objective']:g} | {row['found']} of {results['runs']} | {row['found_by_what_is_drawn']} "
            f"| {100 * row['share_of_guesses']:.0f} % | {row['milliseconds']:.0f} | {row['ipopt_milliseconds']:.0f} "
            f"| {row['ratio']:.1f} | {row['clock_ratio']:.1f} with {row['threads']} threads |"
        )
    return "\n".join(lines) + "\n"


def main() -> None:
    """Measure and print a table; write the figures as JSON if asked to."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=100, help="seeds a scene")
    parser.add_argument("--guesses", type=int, default=GUESSES)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    results = figures(options.runs, options.guesses, options.threads)
    sys.stdout.write(table(results))
    if options.json:
        options.json.write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
