"""Do the other methods find plans where ``balanced`` finds none? ``python -m benchmarks.portfolio DIR``.

DIR is a campaign's (:mod:`benchmarks.certify_campaign`): every scene in it without a plan is tried with the best of
many guesses, with every other guess, and with finer and longer searches than ``balanced`` makes. ``--only INDEX ...``
for some of them. What was tried is kept in ``DIR/portfolio.jsonl``; the table goes to ``benchmarks/results``.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import tightspot
from benchmarks.certify_campaign.rows import append_row, read_rows
from benchmarks.random_scenes import random_scene
from benchmarks.report import RESULTS
from tightspot.errors import TightspotError
from tightspot.guesses import HybridAStar
from tightspot.scenarios import Scenario
from tightspot.search import FINE, FINEST, NARROWEST, SMALL_TURNS, Direction, HybridAStarOptions, Resolution

SECONDS = 20.0
BEST_SECONDS = 40.0
MANY = 1_000_000
ULTRA = Resolution("ultra", 0.0125, 720, 0.03, max_expansions=MANY)
ENDS = (Direction.TIGHT_END, Direction.WIDE_END)


def methods(margin: float) -> dict[str, dict[str, Any]]:
    """Arguments of :func:`tightspot.plan` by the method's name."""
    just_more, half = margin + 0.001, margin / 2
    narrow = (NARROWEST, SMALL_TURNS)
    searches = {
        "search, the whole margin, long": {"resolutions": narrow, "margins": (just_more,)},
        "search, half the margin, long": {"resolutions": narrow, "margins": (half, 0.0)},
        "search, 15 steering angles": {
            "resolutions": (FINE, FINEST),
            "margins": (just_more, half),
            "steering_levels": 15,
        },
        "search, 6 mm": {"resolutions": (ULTRA,), "margins": (just_more, half), "steering_levels": 9},
        "search, both ends": {"margins": (just_more, half), "directions": ENDS[::-1]},
    }
    given: dict[str, dict[str, Any]] = {"best of many": {"effort": "best", "time_limit": BEST_SECONDS}}
    for name, options in searches.items():
        guess = HybridAStar(HybridAStarOptions(**{"max_expansions": MANY, "time_limit": SECONDS, **options}))
        given[name] = {"guess": guess, "time_limit": 2 * SECONDS}
    for name in ("collision-free", "simplified", "linear"):
        given[f"{name}, stagewise"] = {"guess": name, "solver": "stagewise", "time_limit": SECONDS}
    given["linear, ipopt"] = {"guess": "linear", "solver": "ipopt", "effort": "fast", "time_limit": SECONDS}
    return given


def tried(scene: Scenario, tell: Callable[[str], object]) -> dict[str, Any]:
    """What each method came to, in order, up to the first plan."""
    outcomes: dict[str, str] = {}
    for name, arguments in methods(scene.margin).items():
        began = time.perf_counter()
        try:
            tightspot.plan(scene, **arguments)
            outcomes[name] = "plan"
        except TightspotError as error:
            explanation = getattr(error, "explanation", None)
            outcomes[name] = explanation.kind.word.replace("-", " ") if explanation else type(error).__name__
        tell(f"{scene.name}: {name}: {outcomes[name]}, {time.perf_counter() - began:.0f} s\n")
        if outcomes[name] == "plan":
            break
    return outcomes


def as_markdown(plans: int, rows: list[dict[str, Any]]) -> str:
    """The table, and the part of the scenes that ``balanced`` plans of those that any method plans."""
    others = [row for row in rows if "plan" in row["tried"].values()]
    part = plans / max(1, plans + len(others))
    lines = [
        "# Scenes that other methods plan",
        "",
        "Written by `python -m benchmarks.portfolio`.",
        "",
        f"- `balanced` planned {plans} scenes; of the {len(rows)} others, another method planned {len(others)}",
        f"- so `balanced` planned {100 * part:.1f} % of the {plans + len(others)} scenes that any method plans",
        f"- tried, {SECONDS:g} to {BEST_SECONDS:g} s each by the clock: {'; '.join(methods(0.0))}",
        "",
        "| scene | kind | ratio | margin m | what another method found |",
        "|---|---|---|---|---|",
    ]
    for row in rows:
        found = next((name for name, outcome in row["tried"].items() if outcome == "plan"), None)
        ratio = "-" if row["ratio"] is None else f"{row['ratio']:.3f}"
        lines.append(
            f"| `{row['name']}` | {row['kind']} | {ratio} | {row['margin']:g} | "
            f"{f'a plan: {found}' if found else 'nothing'} |"
        )
    return "\n".join(lines) + "\n"


def main() -> int:
    """Try, write; 1 if ``balanced`` plans less than 99 % of what any method plans."""
    parser = argparse.ArgumentParser(description="Try other methods on a campaign's scenes without a plan.")
    parser.add_argument("directory", type=Path, metavar="DIR")
    parser.add_argument("--only", type=int, nargs="+", metavar="INDEX", help="try these scenes only; no report")
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--publish", action="store_true", help="write the table to benchmarks/results, too")
    options = parser.parse_args()
    done_file = options.directory / "portfolio.jsonl"
    rows, done = read_rows(options.directory / "rows.jsonl"), read_rows(done_file)
    failed = options.only or [index for index, row in rows.items() if row["outcome"] != "plan"]
    for index in failed:
        if index not in done:
            scene = random_scene(options.seed, index)
            done[index] = {**scene.facts(), "tried": tried(scene.scenario, sys.stderr.write)}
            append_row(done_file, done[index])
    if options.only:
        return 0
    plans = len(rows) - len(failed)
    report = as_markdown(plans, [done[index] for index in failed])
    sys.stdout.write(report)
    for directory in (options.directory, RESULTS) if options.publish else (options.directory,):
        (directory / "portfolio.md").write_text(report, encoding="utf-8")
    others = sum("plan" in done[index]["tried"].values() for index in failed)
    return int(plans < 0.99 * (plans + others))


if __name__ == "__main__":
    sys.exit(main())
