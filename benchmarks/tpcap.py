"""The competition's scenes: planned as they are, then as fast as may be, and what knots alone would promise.

Run as ``python -m benchmarks.tpcap DIRECTORY`` with a directory of the competition's ``Case*.csv``, which are not part
of the repository; ``--no-write`` to print only. Every plan is made by ``tightspot plan`` in a process of its own and
replayed by ``benchmarks/replay.py``.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
from pathlib import Path
from typing import Any

from benchmarks.replay import replay_file
from benchmarks.report import keep, page, table
from benchmarks.run import run_tightspot
from tightspot import scenarios
from tightspot.errors import TightspotError
from tightspot.formulations import SeparatingLine
from tightspot.guesses import assorted
from tightspot.planner import find_optima
from tightspot.trajectory import Trajectory
from tightspot.transcription import Objective, Settings, TimeGrid
from tightspot.verification import verify

MARGIN = 0.02
ENERGY = 0.01
FAST = ("--free-steering", "--energy-weights", f"{ENERGY},{ENERGY}")
PUBLISHED = {"Case1": 10.8, "Case2": 14.4, "Case3": 14.2, "Case9": 37.7}
"""Durations of published trajectories, s; not judged by us."""
FINE_STEPS = 120
KNOTS = (20, 30, 40, 60, 80)
GUESSES = 120
SEED = 2

Row = dict[str, Any]


def cases(directory: Path) -> list[Path]:
    """The directory's cases by number."""
    found = {
        int(match[1]): path for path in directory.iterdir() if (match := re.fullmatch(r"Case(\d+)\.csv", path.name))
    }
    return [found[number] for number in sorted(found)]


def planned(path: Path, *options: str) -> Row:
    """One line: what ``tightspot plan`` answered, and what the replay of its plan shows."""
    with tempfile.TemporaryDirectory() as directory:
        arguments = ["plan", str(path), "--margin", str(MARGIN), "--output", directory, "--no-picture", "--quiet"]
        run = run_tightspot([*arguments, *options])
        row = {"scene": path.stem, "process": run.seconds}
        if run.code != 0:
            return row | {"problems": [run.errors.strip()]}
        seen = replay_file(run.answer["files"]["plan"])
    facts = {key: run.answer[key] for key in ("duration", "path_length", "gear_changes", "steps", "seconds")}
    clearance = run.answer["certificate"]["clearance"]
    return row | facts | {"certified": clearance, "replayed": seen.clearance, "problems": seen.problems(MARGIN)}


def fastest(path: Path) -> Row:
    """The time-optimal plan by each effort, and on a fine mesh."""
    row: Row = {"scene": path.stem, "published": PUBLISHED[path.stem], "problems": []}
    for name, options in (
        ("balanced", ()),
        ("best", ("--effort", "best")),
        ("fine", ("--effort", "best", "--steps", str(FINE_STEPS))),
    ):
        plan = planned(path, *FAST, *options)
        row |= {name: plan.get("duration"), f"{name}_seconds": plan.get("seconds")}
        row |= {"gear_changes": plan.get("gear_changes"), "problems": [*row["problems"], *plan["problems"]]}
    return row


def at_knots(path: Path, steps: int) -> Row:
    """The shortest time among the optima of separation at the knots only, and what the motion between them does."""
    scenario = scenarios.load(path).with_free_steering()
    vehicle = scenario.vehicle_model()
    settings = Settings(Objective(1.0, (ENERGY, ENERGY)), SeparatingLine(), margin=MARGIN, poses=1)
    guesses = assorted(scenario, vehicle, GUESSES, SEED, margin=MARGIN)
    grid = TimeGrid.uniform(steps)
    optima = find_optima(scenario, vehicle, settings, guesses, grid=grid)
    best = min(optima, key=lambda optimum: optimum.report.final_time).report
    if best.states is None or best.inputs is None:
        raise TightspotError(f"no optimum of {path.name} on {steps} intervals")
    motion = Trajectory(best.final_time * grid.fractions, best.states, best.inputs)
    judged = verify(scenario, vehicle, motion, margin=MARGIN)
    return {"steps": steps, "duration": best.final_time, "depth": max(0.0, -judged.clearance)}


def report(plans: list[Row], fast: list[Row], knots: list[Row]) -> str:
    """The results file."""
    lines = [f"As the files say (at rest with straight wheels at both ends), margin {MARGIN} m, effort `balanced`:", ""]
    lines += table(
        plans,
        (
            ("scene", "scene", "{}"),
            ("duration s", "duration", "{:.2f}"),
            ("path m", "path_length", "{:.1f}"),
            ("gear changes", "gear_changes", "{}"),
            ("intervals", "steps", "{}"),
            ("certified clearance m", "certified", "{:.4f}"),
            ("replayed clearance m", "replayed", "{:.4f}"),
            ("plan s", "seconds", "{:.2f}"),
            ("whole process s", "process", "{:.1f}"),
        ),
    )
    lines += ["", f"As fast as may be (`{' '.join(FAST)}`, margin {MARGIN} m), durations of certified plans, s:", ""]
    lines += table(
        fast,
        (
            ("scene", "scene", "{}"),
            ("effort balanced", "balanced", "{:.2f}"),
            ("took s", "balanced_seconds", "{:.2f}"),
            ("effort best", "best", "{:.2f}"),
            ("took s", "best_seconds", "{:.1f}"),
            (f"best, {FINE_STEPS} intervals", "fine", "{:.2f}"),
            ("took s", "fine_seconds", "{:.1f}"),
            ("gear changes", "gear_changes", "{}"),
            ("published", "published", "{:.1f}"),
        ),
    )
    if knots:
        what = f"the shortest of the optima from {GUESSES} guesses (no plan: it collides between them)"
        lines += ["", f"Case1 with only the knots kept clear, {what}:", ""]
        lines += table(
            knots,
            (
                ("intervals", "steps", "{}"),
                ("duration s", "duration", "{:.2f}"),
                ("deep in an obstacle between the knots m", "depth", "{:.2f}"),
            ),
        )
    problems = [f"- {row['scene']}: {problem}" for row in (*plans, *fast) for problem in row["problems"]]
    if problems:
        lines += ["", "Problems:", "", *problems]
    return page("python -m benchmarks.tpcap DIRECTORY", "The competition's scenes", [], lines)


def main() -> int:
    """Measure, print, write; 1 if there is a problem."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("directory", type=Path, help="with the competition's Case*.csv")
    parser.add_argument("--no-write", action="store_true", help="do not touch benchmarks/results")
    options = parser.parse_args()
    if not options.directory.is_dir():
        parser.error(f"{options.directory} is no directory")
    paths = cases(options.directory)
    if not paths:
        parser.error(f"{options.directory} holds no Case*.csv")
    plans = [planned(path) for path in paths]
    fast = [fastest(path) for path in paths if path.stem in PUBLISHED]
    knots = [at_knots(path, steps) for path in paths if path.stem == "Case1" for steps in KNOTS]
    text = report(plans, fast, knots)
    sys.stdout.write(text)
    if not options.no_write:
        keep("tpcap.md", text)
    return int(any(row["problems"] for row in (*plans, *fast)))


if __name__ == "__main__":
    sys.exit(main())
