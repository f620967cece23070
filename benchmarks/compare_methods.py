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
from benchmarks.plan_scenes import RESULTS, machine
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


def summary(rows: list[dict[str, Any]]) -> list[str]:
    """A Markdown table, one line a method: medians over the scenes that it certified."""
    lines = [
        "| formulation | guess | certified | in the first round | rounds | iterations | J | seconds |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for formulation, guess in methods():
        mine = [row for row in rows if (row["formulation"], row["guess"]) == (formulation, guess)]
        good = [row for row in mine if row["certified"]]
        first = sum(row["first_round_certified"] for row in good)
        cells = [formulation, guess, f"{len(good)} of {len(mine)}", str(first)]
        for key, form in (
            ("rounds", "{:g}"),
            ("iterations", "{:g}"),
            ("objective", "{:.2f}"),
            ("seconds", "{:.1f}"),
        ):
            cells.append(form.format(statistics.median(row[key] for row in good)) if good else "-")
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def as_markdown(rows: list[dict[str, Any]], where: dict[str, Any]) -> str:
    """What the results file holds."""
    scenes = ", ".join(dict.fromkeys(row["scene"] for row in rows))
    lines = [
        "# Formulations and guesses compared",
        "",
        "Written by `python -m benchmarks.compare_methods`.",
        "",
    ]
    lines.append("- " + ", ".join(f"{key} {value}" for key, value in where.items()))
    lines.append(f"- scenes: {scenes}; the scenes' own vehicles and margins; medians over the certified ones")
    failures = [
        f"- {row['scene']}, {row['formulation']}, {row['guess']}: {row['reason']}"
        for row in rows
        if not row["certified"]
    ]
    return "\n".join([*lines, "", *summary(rows), "", "## Not certified", "", *(failures or ["None."])]) + "\n"


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
    where = machine()
    report = as_markdown(rows, where)
    sys.stdout.write(report)
    if not options.no_write:
        RESULTS.mkdir(exist_ok=True)
        (RESULTS / "compare_methods.md").write_text(report, encoding="utf-8")
        table = "\n".join(summary(rows)) + "\n"  # the documentation shows it
        (RESULTS / "compare_methods_table.md").write_text(table, encoding="utf-8")
        content = json.dumps({"machine": where, "runs": rows}, indent=2) + "\n"
        (RESULTS / "compare_methods.json").write_text(content, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
