"""How many iterations the stagewise solver needs on finer meshes, and among more obstacles and vertices.

Run as ``python -m benchmarks.iterations [--starts N] [--seed N]``; ``--no-write`` prints only. Each solve begins at a
hybrid A* guess and has one chance (``robust=False``). The paper's scenes with random starts about theirs; random scenes
(:mod:`benchmarks.random_scenes`) of vehicles with one part. Four Runge-Kutta steps an interval. Times are processor
times of the solving thread.
"""

from __future__ import annotations

import argparse
import dataclasses
import time
from collections.abc import Callable, Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np

from benchmarks.random_scenes import random_scene
from benchmarks.report import table, tell
from tightspot.campaigns.speed.cases import (
    ENERGY_AND_TIME,
    SCENES,
    STEPS,
    TIME_OPTIMAL,
    Start,
    car,
    settings_for,
    slope,
    starts,
)
from tightspot.campaigns.speed.scaling import crowded, rounded
from tightspot.guesses import HybridAStar
from tightspot.scenarios import Obstacle
from tightspot.solvers.stage_core import core_solver
from tightspot.solvers.stage_problem import StageProblem
from tightspot.solvers.stagewise import Stagewise
from tightspot.transcription import TimeGrid, stage_problem
from tightspot.vehicles import VehicleModel

MESHES = (20, 40, 80, 160, 320, 640)
OBSTACLES = (2, 10, 30, 100, 300, 1000)
VERTICES = (4, 8, 16, 32, 64)


class Case(NamedTuple):
    """A start and the vehicle that drives from there."""

    start: Start
    vehicle: VehicleModel
    margin: float | None = None

    def problem(self, weight: float, steps: int) -> StageProblem:
        """On a uniform mesh."""
        settings = settings_for(weight)
        if self.margin is not None:
            settings = dataclasses.replace(settings, margin=self.margin)
        grid = TimeGrid.uniform(steps)
        return stage_problem(self.start.scenario, self.vehicle, self.start.guess, settings, grid=grid)


def paper_cases(scene: str, count: int, seed: int) -> list[Case]:
    """The scene's start and random ones about it."""
    return [Case(start, car()) for start in starts(scene, count, seed)]


def random_cases(count: int, seed: int) -> Iterator[Case]:
    """Random scenes in which hybrid A* finds a way."""
    index = found = 0
    while found < count:
        scenario = random_scene(seed, index).scenario
        vehicle, index = scenario.vehicle_model(), index + 1
        if len(vehicle.parts) > 1:
            continue
        guess = HybridAStar().make(scenario, vehicle, margin=scenario.margin).trajectory
        if guess is not None:
            found += 1
            yield Case(Start(scenario, guess), vehicle, scenario.margin)


def among(case: Case, count: int) -> Case:
    """The same start among so many obstacles."""
    scenario = dataclasses.replace(crowded(count), start=case.start.scenario.start)
    return case._replace(start=Start(scenario, case.start.guess))


def with_vertices(case: Case, count: int) -> Case:
    """The obstacles' corners rounded by so many vertices."""
    scenario = case.start.scenario
    obstacles = tuple(
        Obstacle(obstacle.name, rounded(np.asarray(obstacle.exterior, float), count)) for obstacle in scenario.obstacles
    )
    return case._replace(start=Start(dataclasses.replace(scenario, obstacles=obstacles), case.start.guess))


def meshed(cases: list[Case]) -> Callable[[int, float], Iterable[StageProblem]]:
    """All cases on a mesh, for a weight."""
    return lambda steps, weight: (case.problem(weight, steps) for case in cases)


def series(
    name: str, counts: Iterable[int], problems: Callable[[int, float], Iterable[StageProblem]]
) -> Iterator[dict[str, Any]]:
    """For both weights a line for every count, the last of them with the slope of the mean time of a solve."""
    for weight in (TIME_OPTIMAL, ENERGY_AND_TIME):
        rows: list[dict[str, Any]] = []
        for count in counts:
            answers = [_solve(problem) for problem in problems(count, weight)]
            iterations = [answer["iterations"] for answer in answers if answer["status"] == "solved"]
            rows.append(
                {
                    "series": name,
                    "weight": weight,
                    "count": count,
                    "median": float(np.median(iterations)) if iterations else None,
                    "p90": float(np.quantile(iterations, 0.9)) if iterations else None,
                    "largest": max(iterations, default=None),
                    "solved": f"{len(iterations)} of {len(answers)}",
                    "milliseconds": 1e3 * float(np.mean([answer["processor"] for answer in answers])),
                }
            )
        rows[-1]["slope"] = slope([row["count"] for row in rows], [row["milliseconds"] for row in rows])
        yield from rows


def _solve(problem: StageProblem) -> dict[str, Any]:
    core = core_solver(problem)
    core.set(problem.starting_point())
    began = time.thread_time()
    answer: dict[str, Any] = core.solve(Stagewise().options())
    return answer | {"processor": time.thread_time() - began}


COLUMNS = (
    ("series", "series", "{}"),
    ("r", "weight", "{:g}"),
    ("count", "count", "{}"),
    ("iterations", "median", "{:.0f}"),
    ("90 %", "p90", "{:.0f}"),
    ("most", "largest", "{}"),
    ("solved", "solved", "{}"),
    ("ms", "milliseconds", "{:.2f}"),
    ("slope of ms", "slope", "{:.2f}"),
)


def measure(count: int, seed: int) -> Iterator[dict[str, Any]]:
    """All lines of the table."""
    few = paper_cases("vertical", max(count // 2, 1), seed)
    for scene in SCENES:
        yield from series(f"{scene}, steps", MESHES, meshed(paper_cases(scene, count, seed)))
    drawn = list(random_cases(2 * count, seed))
    yield from series("random scenes, steps", MESHES[:-1], meshed(drawn))
    yield from series("obstacles", OBSTACLES, lambda n, r: (among(c, n).problem(r, STEPS) for c in few))
    yield from series("vertices", VERTICES, lambda n, r: (with_vertices(c, n).problem(r, STEPS) for c in few))


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description="Iterations on finer meshes, among more obstacles and vertices.")
    parser.add_argument("--starts", type=int, default=8, help="starts a scene; twice as many random scenes")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--no-write", action="store_true", help="do not touch benchmarks/results")
    options = parser.parse_args()
    rows = list(measure(options.starts, options.seed))
    note = (
        f"{options.starts} starts a scene, {2 * options.starts} random scenes, seed {options.seed}; iterations of "
        "those solved; ms are means over all; slopes on logarithmic scales, 1 is linear"
    )
    tell("iterations", "Iterations of the stagewise solver", note, table(rows, COLUMNS), write=not options.no_write)


if __name__ == "__main__":
    main()
