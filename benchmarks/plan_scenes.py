"""Plan every scene from the command line, replay each plan independently, and write down what was measured.

Run as ``python -m benchmarks.plan_scenes`` (``make bench``); ``--only NAME ...`` for some scenes,
``--no-write`` to print only. The competition's cases are planned where ``../shared/data/tpcap`` is there.
"""

from __future__ import annotations

import argparse
import json
import math
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from benchmarks.replay import replay_file
from benchmarks.report import keep, machine, page, table
from benchmarks.run import run_tightspot
from benchmarks.scenes import PROMISED_MARGIN, builtin_scenes, tpcap_scenes
from tightspot import scenarios
from tightspot.guesses import HybridAStar

SEARCHES = 11


def measure(scene: str | Path) -> dict[str, Any]:
    """One row of the table."""
    scenario = scenarios.load(scene)
    row: dict[str, Any] = {"scene": scenario.name, "hybrid_astar_ms": search_time(scenario)}
    with tempfile.TemporaryDirectory() as directory:
        run = run_tightspot(["plan", str(scene), "--output", directory, "--quiet"])
        row |= {"exit_code": run.code, "seconds": run.seconds, "megabytes": run.megabytes}
        if run.code != 0:
            return row | {"problems": [run.errors.strip()]}
        seen = replay_file(run.answer["files"]["plan"])
    promised = PROMISED_MARGIN["tpcap" if isinstance(scene, Path) else "builtin"]
    facts = {key: run.answer[key] for key in ("rounds", "steps", "objective", "duration", "gear_changes")}
    certified = math.floor(run.answer["certificate"]["clearance"] * 1e4) / 1e4  # never promise more than is proved
    return {
        **row,
        **facts,
        "plan_seconds": run.answer["seconds"],
        "certified_clearance": certified,
        "replay_clearance": seen.clearance,
        "replay_frames": seen.frames,
        "problems": seen.problems(max(promised, certified)),
    }


def search_time(scenario: scenarios.Scenario) -> float:
    """Median time of the hybrid A* guess, lifting included, ms."""
    vehicle = scenario.vehicle_model()
    times = []
    for _ in range(SEARCHES):
        started = time.perf_counter()
        HybridAStar().make(scenario, vehicle, margin=scenario.margin)
        times.append(time.perf_counter() - started)
    return 1000 * statistics.median(times)


def import_time() -> float:
    """Time of ``import tightspot`` in a new process beyond an empty one's, best of a few, ms."""

    def best(program: str) -> float:
        times = []
        for _ in range(SEARCHES):
            started = time.perf_counter()
            subprocess.run([sys.executable, "-c", program], check=True)
            times.append(time.perf_counter() - started)
        return min(times)

    return 1000 * (best("import tightspot") - best("pass"))


_COLUMNS = (
    ("scene", "scene", "{}"),
    ("process s", "seconds", "{:.1f}"),
    ("plan s", "plan_seconds", "{:.2f}"),
    ("rounds", "rounds", "{}"),
    ("steps", "steps", "{}"),
    ("J", "objective", "{:.3f}"),
    ("t_f s", "duration", "{:.2f}"),
    ("gear changes", "gear_changes", "{}"),
    ("certified m", "certified_clearance", "{:.4f}"),
    ("replay m", "replay_clearance", "{:.4f}"),
    ("hybrid A* ms", "hybrid_astar_ms", "{:.1f}"),
    ("memory MB", "megabytes", "{:.0f}"),
)


def as_markdown(rows: list[dict[str, Any]], where: dict[str, Any], imported: float) -> str:
    """The table and the machine, as the results file holds them."""
    notes = [
        "one process a scene, one scene at a time",
        "process s: the whole `tightspot plan`, files included; plan s: `tightspot.plan` alone",
        "replay m: smallest distance in an independent replay in 1 ms steps; certified m: its proved bound",
        f"hybrid A* ms: median of {SEARCHES} searches, lifted to a trajectory",
    ]
    problems = [f"- {row['scene']}: {problem}" for row in rows for problem in row["problems"]]
    searches = [row["hybrid_astar_ms"] for row in rows if "hybrid_astar_ms" in row]
    lines = [*table(rows, _COLUMNS), "", "## Problems", "", *(problems or ["None."])]
    lines += ["", f"Hybrid A*, median over the scenes: {statistics.median(searches):.1f} ms."]
    lines += ["", f"`import tightspot`: {imported:.0f} ms beyond an empty process."]
    return page("make bench", "Plans of all scenes", notes, lines, where)


def main() -> int:
    """Measure, print, write; 1 if any scene shows a problem."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", metavar="NAME", help="scenes whose name is one of these")
    parser.add_argument("--no-write", action="store_true", help="do not touch benchmarks/results")
    options = parser.parse_args()
    scenes: list[str | Path] = [*builtin_scenes(), *tpcap_scenes()]
    rows = []
    for scene in scenes:
        if options.only and Path(scene).stem not in options.only:
            continue
        sys.stderr.write(f"{Path(scene).stem} ...\n")
        rows.append(measure(scene))
    where, imported = machine(), import_time()
    report = as_markdown(rows, where, imported)
    sys.stdout.write(report)
    if not options.no_write:
        keep("plan_scenes.md", report)
        content = json.dumps({"machine": where, "import_ms": imported, "scenes": rows}, indent=2) + "\n"
        keep("plan_scenes.json", content)
    return int(any(row["problems"] for row in rows))


if __name__ == "__main__":
    sys.exit(main())
