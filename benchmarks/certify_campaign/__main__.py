"""The campaign: ``python -m benchmarks.certify_campaign --scenes 500 --seed 1 --jobs 2 --output DIR --resume``.

Scenes are planned in worker processes. One that hangs is ended at one and a half times its time limit and four minutes
(for the replays), one that crashes is replaced; either way its scene gets a row that says so.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import sys
from collections import Counter
from concurrent.futures import TimeoutError as HungError
from pathlib import Path
from typing import Any

from pebble import ProcessExpired, ProcessPool

from benchmarks.certify_campaign.report import as_markdown
from benchmarks.certify_campaign.rows import append_row, read_rows
from benchmarks.certify_campaign.scene_run import run_scene
from benchmarks.certify_campaign.summary import summarise
from benchmarks.random_scenes import random_scene
from benchmarks.report import RESULTS, machine

SCENES_A_WORKER = 50
SECONDS_BEYOND = 240.0


def campaign(options: argparse.Namespace, rows_file: Path) -> dict[int, dict[str, Any]]:
    """All rows, those on file and those made now."""
    rows = read_rows(rows_file)
    wanted = range(options.first, options.first + options.scenes)
    todo = [index for index in wanted if index not in rows]
    os.environ["OMP_NUM_THREADS"] = "1"  # for the workers, which inherit it
    context = multiprocessing.get_context("spawn")
    with ProcessPool(max_workers=options.jobs, max_tasks=SCENES_A_WORKER, context=context) as pool:
        arguments = [(options.seed, index, options.limit, str(options.output)) for index in todo]
        futures = [
            pool.schedule(run_scene, args=each, timeout=1.5 * options.limit + SECONDS_BEYOND) for each in arguments
        ]
        for done, (index, future) in enumerate(zip(todo, futures, strict=True), 1):
            try:
                row = future.result()
            except HungError:
                row = _lost(options.seed, index, "hung", "the worker did not come back in time")
            except ProcessExpired as error:
                row = _lost(options.seed, index, "crashed", f"the worker ended with code {error.exitcode}")
            except Exception as error:  # whatever it is, it belongs to this scene only
                row = _lost(options.seed, index, "crashed", f"{type(error).__name__}: {error}")
            append_row(rows_file, row)
            rows[index] = row
            seconds = f", {row['seconds']:.1f} s" if "seconds" in row else ""
            sys.stderr.write(f"{done}/{len(todo)} {row['name']}: {row['outcome']}{seconds}\n")
    return {index: rows[index] for index in wanted}


def _lost(seed: int, index: int, outcome: str, reason: str) -> dict[str, Any]:
    return {**random_scene(seed, index).facts(), "outcome": outcome, "reason": reason, "judged": []}


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Plan random scenes and replay every plan.")
    parser.add_argument("--scenes", type=int, default=500, metavar="N")
    parser.add_argument("--first", type=int, default=0, metavar="INDEX", help="where in the sequence to begin")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2, help="worker processes")
    parser.add_argument("--limit", type=float, default=60.0, metavar="SECONDS", help="time limit of a scene")
    parser.add_argument("--output", type=Path, required=True, metavar="DIR", help="for rows, scenes, plans, report")
    parser.add_argument("--resume", action="store_true", help="go on with the rows that are in DIR")
    parser.add_argument("--publish", action="store_true", help="write the report to benchmarks/results, too")
    return parser.parse_args()


def main() -> int:
    """Run, report; 1 if a plan is refuted or false alarms are not rare."""
    options = _options()
    rows_file = options.output / "rows.jsonl"
    if rows_file.exists() and not options.resume:
        sys.stderr.write(f"{rows_file} exists; give --resume to go on with it, or another --output\n")
        return 2
    for name in ("scenes", "plans"):
        (options.output / name).mkdir(parents=True, exist_ok=True)
    sys.stderr.write(f"seed {options.seed}, scenes {options.first} to {options.first + options.scenes - 1}\n")
    rows = campaign(options, rows_file)
    summary = summarise(list(rows.values()))
    where = {**machine(), "jobs": options.jobs, "seed": options.seed, "time limit": f"{options.limit:g} s"}
    report = as_markdown(summary, where)
    sys.stdout.write(report)
    content = json.dumps({"machine": where, "summary": summary}, indent=2) + "\n"
    for directory in (options.output, RESULTS) if options.publish else (options.output,):
        (directory / "certify_campaign.md").write_text(report, encoding="utf-8")
        (directory / "certify_campaign.json").write_text(content, encoding="utf-8")
    sys.stdout.write(f"outcomes: {dict(Counter(row['outcome'] for row in rows.values()))}\n")
    return int(not summary["passed"])


if __name__ == "__main__":
    sys.exit(main())
