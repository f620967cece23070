"""Measure ``tightspot bench speed`` for the documentation: tables to benchmarks/results, pictures to docs/images.

    python -m benchmarks.speed [--starts N] [--quick]      (make speed)

Takes about a quarter of an hour on an idle machine; ``docs/speed.md`` shows what it writes.
"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import replace
from pathlib import Path

from tightspot.campaigns.speed import FULL, QUICK, run_speed, speed_report
from tightspot.cli.bench_speed import draw
from tightspot.files import atomic_write

RESULTS = Path(__file__).parent / "results"
IMAGES = Path(__file__).parents[1] / "docs" / "images"


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--starts", type=int, default=100, help="starts a scene")
    parser.add_argument("--runs", type=int, default=100, help="seeds of the best of many")
    parser.add_argument("--quick", action="store_true", help="a few starts, to see that it works")
    options = parser.parse_args()
    plan = QUICK if options.quick else replace(FULL, starts=options.starts, plans=options.starts, runs=options.runs)
    plan = replace(plan, straight=min(plan.straight, plan.starts))
    result = run_speed(plan, progress=lambda news: sys.stderr.write(f"{news:60}\r") and None)
    pictures = {caption: f"../../docs/images/{name}" for caption, name in draw(result, IMAGES).items()}
    atomic_write(RESULTS / "speed.md", speed_report(result, pictures))
    atomic_write(RESULTS / "speed.json", json.dumps(result, indent=1, allow_nan=False) + "\n")


if __name__ == "__main__":
    main()
