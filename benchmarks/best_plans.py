"""What ``effort="best"`` gains over the default effort, and what it takes.

    python -m benchmarks.best_plans [--seeds N] [--json FILE] [SCENE ...]

Every scene (by default all built-in ones) is planned once with ``effort="balanced"`` and with ``effort="best"`` for
several seeds, in one process. Times are processor time of all threads, so they do not depend on what else the machine
does. Files ending in ``.csv`` are taken as cases of the TPCAP competition, with its vehicle.
"""

from __future__ import annotations

import argparse
import json
import platform
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import tightspot
from tightspot.errors import PlanningError
from tightspot.scenarios.library import names

GAIN = 1e-3
"""A plan is better if its J is smaller by more than this part."""


def figures(scenes: Sequence[str], seeds: int = 3) -> dict[str, Any]:
    """One object a scene and a summary."""
    tightspot.plan("oblique", effort="best")
    rows = {Path(scene).stem: _scene(scene, seeds) for scene in scenes}
    gains = [row["gain"] for row in rows.values() if row["gain"] is not None]
    return {
        "seeds": seeds,
        "scenes": rows,
        "better": sum(gain > GAIN for gain in gains),
        "worse": sum(gain < 0 for gain in gains),
        "planned_only_by_best": sum(row["balanced"] is None and row["best"] is not None for row in rows.values()),
    }


def _scene(scene: str, seeds: int) -> dict[str, Any]:
    vehicle = "tpcap" if scene.endswith(".csv") else None
    balanced, balanced_seconds, _ = _planned(scene, vehicle, "balanced", 0)
    runs = [_planned(scene, vehicle, "best", seed) for seed in range(seeds)]
    values = [value for value, _, _ in runs if value is not None]
    best, worst = (min(values), max(values)) if values else (None, None)
    gain = None if balanced is None or worst is None else 1 - worst / balanced
    return {
        "balanced": balanced,
        "balanced_seconds": balanced_seconds,
        "best": best,
        "worst": worst,
        "failed": seeds - len(values),
        "gain": gain,
        "seconds": sorted(seconds for _, seconds, _ in runs)[seeds // 2],
        "guesses": [guess for _, _, guess in runs],
    }


def _planned(scene: str, vehicle: str | None, effort: str, seed: int) -> tuple[float | None, float, str]:
    """J (``None``: no plan), processor seconds, and the guess that led to it."""
    began = time.process_time()
    try:
        report = tightspot.plan(scene, vehicle=vehicle, effort=effort, seed=seed).report
    except PlanningError:
        return None, time.process_time() - began, ""
    return report["objective"]["value"], time.process_time() - began, report["guess"]["name"]


def table(results: dict[str, Any]) -> str:
    """The figures as a table."""
    lines = ["| scene | balanced J | s | best J | of all seeds the worst | gain | s |", "|---" * 7 + "|"]
    for scene, row in results["scenes"].items():
        gain = "-" if row["gain"] is None else f"{100 * row['gain']:.1f} %"
        lines.append(
            f"| {scene} | {_number(row['balanced'])} | {row['balanced_seconds']:.2f} | {_number(row['best'])} "
            f"| {_number(row['worst'])} | {gain} | {row['seconds']:.2f} |"
        )
    return "\n".join(lines) + "\n"


def _number(value: float | None) -> str:
    return "none" if value is None else f"{value:.3f}"


def main() -> None:
    """Measure and print a table; write the figures as JSON if asked to."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="names or files; default: all built-in scenes")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    results = figures(options.scenes or names(), options.seeds) | {"machine": platform.processor()}
    sys.stdout.write(table(results))
    if options.json:
        options.json.write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
