"""What an iteration of the stagewise solver costs more where obstacles move.

Run as ``python -m benchmarks.moving_obstacles``; ``--no-write`` prints only. The paper's scenes, 20 intervals, hybrid
A* guess: once as they are, once with all obstacles as moving ones that happen to stand, so that both programs have the
same optimum and the solver goes the same way. Solves alternate; times are processor times of the solving thread.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from benchmarks.report import table, tell
from tightspot.formulations import Formulation, SweptLine, UnitNormalLine
from tightspot.guesses import HybridAStar
from tightspot.scenarios.library import builtin
from tightspot.solvers.stage_core import core_solver
from tightspot.solvers.stage_problem import StageProblem
from tightspot.solvers.stagewise import Stagewise
from tightspot.transcription import ObstacleMotion, Settings, TimeGrid, stage_problem
from tightspot.vehicles import vehicle

SCENES = ("oblique", "vertical", "parallel")
STEPS, ROUNDS = 20, 60


@dataclass(frozen=True)
class MovingRow:
    """One scene and formulation: medians.

    Attributes:
        scene: Its name.
        formulation: Its name.
        iterations: Of both solves, where they are the same.
        standing_us: Microseconds an iteration, obstacles as they are.
        moving_us: The same obstacles as moving ones.
        ratio: Median of the second over the first, round by round.
        apart: How far the two optima's J are apart, relatively.
    """

    scene: str
    formulation: str
    iterations: str
    standing_us: float
    moving_us: float
    ratio: float
    apart: float


def compare(scene: str, formulation: Formulation) -> MovingRow:
    """Both programs of one scene, solved in turns."""
    scenario, car = builtin(scene), vehicle("paper")
    guess = HybridAStar().make(scenario, car, margin=0.05).trajectory
    if guess is None:
        raise RuntimeError(f"no guess for {scene}")
    settings = Settings(formulation=formulation, margin=0.02, substeps=2, workspace_margin=0.002)
    grid, still = TimeGrid.uniform(STEPS), np.zeros((STEPS + 1, 3))
    motions = [ObstacleMotion(polygon, still, still, guess.duration) for polygon in scenario.obstacle_polygons]
    problems = (
        stage_problem(scenario, car, guess, settings, grid=grid),
        stage_problem(scenario.with_(obstacles=()), car, guess, settings, grid=grid, motions=motions),
    )
    cores = [core_solver(problem) for problem in problems]
    seconds = np.empty((ROUNDS, 2))
    for row in seconds:
        answers = [_solve(*pair) for pair in zip(cores, problems, strict=True)]
        row[:] = [spent / answer["iterations"] for spent, answer in answers]
    counts, values = ([answer[key] for _, answer in answers] for key in ("iterations", "objective"))
    return MovingRow(
        scene,
        formulation.name,
        str(counts[0]) if counts[0] == counts[1] else f"{counts[0]}, {counts[1]}",
        *(1e6 * np.median(seconds, axis=0)),
        ratio=float(np.median(seconds[:, 1] / seconds[:, 0])),
        apart=abs(values[1] / values[0] - 1),
    )


def _solve(core: Any, problem: StageProblem) -> tuple[float, dict[str, Any]]:
    core.set(problem.starting_point())
    began = time.thread_time()
    answer = core.solve(Stagewise().options())
    return time.thread_time() - began, answer


COLUMNS = (
    ("scene", "scene", "{}"),
    ("formulation", "formulation", "{}"),
    ("iterations", "iterations", "{}"),
    ("standing, us", "standing_us", "{:.1f}"),
    ("moving, us", "moving_us", "{:.1f}"),
    ("ratio", "ratio", "{:.2f}"),
    ("J apart", "apart", "{:.0e}"),
)


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description="What an iteration costs more where obstacles move.")
    parser.add_argument("--no-write", action="store_true", help="do not touch benchmarks/results")
    options = parser.parse_args()
    rows = [asdict(compare(scene, member())) for scene in SCENES for member in (UnitNormalLine, SweptLine)]
    note = f"{STEPS} intervals, medians of {ROUNDS} solves in turns; microseconds an iteration, processor time"
    title = "Obstacles that move: what an iteration costs"
    tell("moving_obstacles", title, note, table(rows, COLUMNS), write=not options.no_write)


if __name__ == "__main__":
    main()
