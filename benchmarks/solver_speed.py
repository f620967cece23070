"""How much faster the stagewise solver is than the paper's method, from the same hybrid A* guesses, in one process.

    python -m benchmarks.solver_speed [--starts N] [--substeps N] [--seed N] [--json FILE]

The first table of ``tightspot bench speed`` by itself: the paper's three scenes with 20 intervals, the scene's start
and random ones about it. See :mod:`tightspot.campaigns.speed`.
"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict
from pathlib import Path

from tightspot.campaigns import Machine
from tightspot.campaigns.speed.cases import SCENES, starts
from tightspot.campaigns.speed.report import solves_table
from tightspot.campaigns.speed.run import WEIGHTS, with_all
from tightspot.campaigns.speed.solves import compare


def main() -> None:
    """Measure and print a table; write the figures as JSON if asked to."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--starts", type=int, default=100, help="starts a scene")
    parser.add_argument("--substeps", type=int, default=4, help="Runge-Kutta steps an interval")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    given = {scene: list(starts(scene, options.starts, options.seed)) for scene in SCENES}
    results = {}
    for name, weight in WEIGHTS.items():
        cases = {
            scene: [compare(start, weight, substeps=options.substeps) for start in some]
            for scene, some in given.items()
        }
        results[name] = with_all(cases)
        sys.stdout.write("\n".join([f"r = {weight:g}", "", *solves_table(results[name]), "", ""]))
    if options.json:
        machine = asdict(Machine.here())
        options.json.write_text(json.dumps({"machine": machine, **results}, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
