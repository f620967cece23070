"""Planning anew against planning from the last plan, after the start moved by 10 cm and 2 degrees.

Run as ``python -m benchmarks.warm``; ``--moves N`` sets the number of moved starts a scene (default 25), ``--no-write``
prints only. Each moved start is drawn at random (any direction, either turn); where the vehicle cannot stand it is
drawn again. It is planned twice in one process: by :func:`tightspot.plan`, and by a :class:`tightspot.Planner` whose
last plan is that of the scene as it was, each ``REPEATS`` times, of which the fastest counts. Times are processor times
of the whole plan (checks, guess, set-up, solves, judge), and the solver's own clock, which runs on while others use the
processor.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

import tightspot
from benchmarks.report import tell
from tightspot.errors import PlanningError, SceneError
from tightspot.scenarios import Scenario

Array = NDArray[np.float64]

SCENES = ("oblique", "vertical", "parallel")
DISTANCE, TURN = 0.1, np.radians(2.0)
MARGIN = 0.02
REPEATS = 3


@dataclass(frozen=True)
class WarmRow:
    """One scene: medians over the moved starts.

    Attributes:
        scene: Its name.
        moves: How many starts were planned.
        warm: How many of the planner's plans came from the last plan.
        cold_ms: Processor time of a plan made anew, ms.
        warm_ms: Of the planner's.
        plan_ratio: Median of the first over the second, start by start.
        cold_solve_ms: The solver's time in a plan made anew, all rounds, ms.
        warm_solve_ms: In the planner's.
        solve_ratio: Median of the first over the second, start by start.
        cold_iterations: The solver's iterations in a plan made anew, all rounds, median.
        warm_iterations: In the planner's.
        worse: How much larger J is than that of the plan made anew, median.
    """

    scene: str
    moves: int
    warm: int
    cold_ms: float
    warm_ms: float
    plan_ratio: float
    cold_solve_ms: float
    warm_solve_ms: float
    solve_ratio: float
    cold_iterations: float
    warm_iterations: float
    worse: float


def measure(scene: str, moves: int, margin: float = MARGIN, seed: int = 0) -> WarmRow:
    """Plan ``moves`` moved starts of a built-in scene, anew and warm."""
    rng = np.random.default_rng(seed)
    base = tightspot.load(scene)
    rows: list[tuple[float, ...]] = []
    while len(rows) < moves:
        angle = rng.uniform(0.0, 2 * np.pi)
        shift = [DISTANCE * np.cos(angle), DISTANCE * np.sin(angle), TURN * rng.choice((-1, 1)), 0.0, 0.0]
        try:
            rows.append(_both(base, base.start + shift, margin))
        except (SceneError, PlanningError):
            continue
    cold, warm, cold_solve, warm_solve, cold_iterations, warm_iterations, used, worse = np.array(rows).T
    return WarmRow(
        scene,
        moves,
        int(used.sum()),
        1e3 * float(np.median(cold)),
        1e3 * float(np.median(warm)),
        float(np.median(cold / warm)),
        1e3 * float(np.median(cold_solve)),
        1e3 * float(np.median(warm_solve)),
        float(np.median(cold_solve / warm_solve)),
        float(np.median(cold_iterations)),
        float(np.median(warm_iterations)),
        float(np.median(worse)),
    )


def _both(base: Scenario, start: Array, margin: float) -> tuple[float, ...]:
    """Seconds of the plans anew and warm, of their solves, their iterations, whether warm was warm, and J's excess."""
    times = []
    for _ in range(REPEATS):
        planner = tightspot.Planner(base, margin=margin)
        planner.plan()
        cold, cold_seconds = _timed(partial(tightspot.plan, base.with_(start=start), margin=margin))
        warm, warm_seconds = _timed(partial(planner.plan, start=start))
        times.append((cold_seconds, warm_seconds, _solving(cold), _solving(warm)))
    worse = warm.report["objective"]["value"] / cold.report["objective"]["value"] - 1
    return (*np.min(times, axis=0), _iterations(cold), _iterations(warm), warm.report["warm"]["used"], worse)


def ratios(moves: int = 25) -> dict[str, dict[str, float]]:
    """``plan_ratio`` and ``solve_ratio`` (cold over warm, medians) of the paper's scenes, by name."""
    rows = [measure(scene, moves) for scene in SCENES]
    return {row.scene: {"plan_ratio": row.plan_ratio, "solve_ratio": row.solve_ratio} for row in rows}


def _timed(make: Callable[[], tightspot.Plan]) -> tuple[tightspot.Plan, float]:
    began = time.process_time()
    plan = make()
    return plan, time.process_time() - began


def _solving(plan: tightspot.Plan) -> float:
    return float(sum(each["timings"]["solve"] for each in plan.report["rounds"]))


def _iterations(plan: tightspot.Plan) -> int:
    return sum(each["solve"]["iterations"] for each in plan.report["rounds"])


def table(rows: list[WarmRow]) -> list[str]:
    """A Markdown table."""
    lines = [
        "| scene | starts | from the last plan | anew, ms | warm, ms | ratio | solver anew, ms | solver warm, ms "
        "| ratio | iterations anew | iterations warm | J more |",
        "|---|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        cells = [row.scene, str(row.moves), str(row.warm), f"{row.cold_ms:.1f}", f"{row.warm_ms:.1f}"]
        cells += [f"{row.plan_ratio:.1f}", f"{row.cold_solve_ms:.2f}", f"{row.warm_solve_ms:.2f}"]
        cells += [
            f"{row.solve_ratio:.1f}",
            f"{row.cold_iterations:.0f}",
            f"{row.warm_iterations:.0f}",
            f"{100 * row.worse:+.2f} %",
        ]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def main() -> int:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description="Planning anew against planning from the last plan.")
    parser.add_argument("--moves", type=int, default=25, metavar="N", help="moved starts a scene (default 25)")
    parser.add_argument("--no-write", action="store_true", help="do not touch benchmarks/results")
    options = parser.parse_args()
    for scene in SCENES:
        measure(scene, 1)  # nothing is done for the first time in what is measured
    lines = table([measure(scene, options.moves) for scene in SCENES])
    note = f"margin {MARGIN:g} m; start moved by {DISTANCE:g} m and {np.degrees(TURN):g} deg; medians; processor time"
    tell("warm", "Planning again from the last plan", note, lines, write=not options.no_write)
    return 0


if __name__ == "__main__":
    sys.exit(main())
