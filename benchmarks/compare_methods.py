"""Plan scenes with every formulation and with every guess, and write down what came of it.

Run as ``python -m benchmarks.compare_methods``; ``--scenes NAME ...`` for other scenes than the paper's three
and ``garage``, ``--no-write`` to print only.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import time
from pathlib import Path
from typing import Any

import tightspot
from benchmarks.report import keep, machine, table, tell
from tightspot.formulations import FORMULATIONS
from tightspot.guesses import GUESSES

SCENES = ("vertical", "parallel", "oblique", "garage")


def methods() -> list[tuple[str, str]]:
    """(formulation, guess): each formulation from hybrid A*, each guess for swept line."""
    formulations = [(formulation, "hybrid-astar") for formulation in FORMULATIONS]
    return list(dict.fromkeys(formulations + [("swept-line", guess) for guess in GUESSES]))


def attempt(scene: str, formulation: str, guess: str) -> dict[str, Any]:
    """One plan, or why there is none."""
    row: dict[str, Any] = {"scene": scene, "formulation": formulation, "guess": guess}
    started = time.perf_counter()
    try:
        plan = tightspot.plan(scene, formulation=formulation, guess=guess)
        report, clearance = plan.report, plan.certificate.clearance
    except tightspot.PlanningError as error:
        return row | {"certified": False, "seconds": time.perf_counter() - started, "reason": error.reason}
    rounds = report["rounds"]
    return {
        **row,
        "certified": True,
        "seconds": report["seconds"],
        "rounds": len(rounds),
        "steps": rounds[-1]["steps"],
        "iterations": sum(entry["solve"]["iterations"] for entry in rounds),
        "first_round_certified": rounds[0]["certified"],
        "objective": report["objective"]["value"],
        "clearance": clearance,
    }


COLUMNS = (
    ("formulation", "formulation", "{}"),
    ("guess", "guess", "{}"),
    ("certified", "certified", "{}"),
    ("in the first round", "first", "{}"),
    ("rounds", "rounds", "{:g}"),
    ("iterations", "iterations", "{:g}"),
    ("J", "objective", "{:.2f}"),
    ("seconds", "seconds", "{:.3f}"),
)


def summary(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """One line a method: medians over the scenes that it certified."""
    lines = []
    for formulation, guess in methods():
        mine = [row for row in rows if (row["formulation"], row["guess"]) == (formulation, guess)]
        good = [row for row in mine if row["certified"]]
        counts = {
            "certified": f"{len(good)} of {len(mine)}",
            "first": sum(row["first_round_certified"] for row in good),
        }
        keys = ("rounds", "iterations", "objective", "seconds") if good else ()
        medians = {key: statistics.median(row[key] for row in good) for key in keys}
        lines.append({"formulation": formulation, "guess": guess, **counts, **medians})
    return lines


def main() -> int:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description="Compare formulations and guesses.")
    parser.add_argument("--scenes", nargs="+", metavar="NAME", default=list(SCENES), help="built-in scenes or files")
    parser.add_argument("--no-write", action="store_true", help="do not touch benchmarks/results")
    options = parser.parse_args()
    rows = []
    for scene in options.scenes:
        for formulation, guess in methods():
            sys.stderr.write(f"{Path(scene).stem}: {formulation} from {guess} ...\n")
            rows.append(attempt(scene, formulation, guess))
    scenes = ", ".join(dict.fromkeys(row["scene"] for row in rows))
    note = f"scenes: {scenes}; the scenes' own vehicles and margins; medians over the certified ones"
    failures = [
        f"- {row['scene']}, {row['formulation']}, {row['guess']}: {row['reason']}"
        for row in rows
        if not row["certified"]
    ]
    rest = ["## Not certified", "", *(failures or ["None."])]
    lines = table(summary(rows), COLUMNS)
    tell("compare_methods", "Formulations and guesses compared", note, lines, write=not options.no_write, rest=rest)
    if not options.no_write:
        keep("compare_methods.json", json.dumps({"machine": machine(), "runs": rows}, indent=2) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
