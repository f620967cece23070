"""The paper's scenes with random starts, the paper's method, and how time is taken."""

from __future__ import annotations

import dataclasses
import statistics
import time
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from tightspot.errors import InputError
from tightspot.formulations import SeparatingLine
from tightspot.guesses import HybridAStar
from tightspot.scenarios import Scenario, check
from tightspot.scenarios.library import builtin
from tightspot.solvers import Ipopt, Nlp, SolveReport
from tightspot.trajectory import Trajectory
from tightspot.transcription import Objective, Settings
from tightspot.vehicles import SingleTrack, vehicle

SCENES = ("oblique", "vertical", "parallel")
GAP = 0.002
MARGIN = 0.05
"""Of plans, m: the scenes' own."""

STEPS = 20
AROUND = np.array([1.0, 0.5, 0.2])
"""Starts are drawn from the scene's by at most so much: m, m, rad."""

PAPERS_METHOD = Ipopt(options={"mu_strategy": "monotone", "mumps_scaling": 77, "bound_relax_factor": 1e-8})
"""IPOPT with MUMPS and all of its default options, to 1e-8."""

ENERGY_AND_TIME, TIME_OPTIMAL = 0.01, 1.0
"""Weights r of the duration."""


class Start(NamedTuple):
    """A scene and its hybrid A* guess."""

    scenario: Scenario
    guess: Trajectory


class Timed(NamedTuple):
    """A solve by the paper's method and the processor time that its thread spent in it, s."""

    report: SolveReport
    seconds: float


def car() -> SingleTrack:
    """The paper's vehicle."""
    return vehicle("paper")


def settings_for(weight: float, substeps: int = 4) -> Settings:
    """Formulation (17) as the paper has it."""
    return Settings(objective=Objective(weight), formulation=SeparatingLine(), margin=GAP, substeps=substeps)


def scenes_about(scene: str, count: int, seed: int, margin: float) -> Iterator[Scenario]:
    """The scene, then versions of it that start elsewhere, where the vehicle stands free; the same for a seed."""
    rng, base = np.random.default_rng(seed), builtin(scene)
    found = 0
    while found < count:
        start = np.array(base.start)
        if found:
            start[:3] += rng.uniform(-AROUND, AROUND)
        scenario = dataclasses.replace(base, start=start)
        try:
            check(scenario, car(), margin)
        except InputError:
            continue
        found += 1
        yield scenario


def starts(scene: str, count: int, seed: int) -> Iterator[Start]:
    """Versions of the scene that hybrid A* finds a path in, each with its guess."""
    found = 0
    for scenario in scenes_about(scene, 10 * count, seed, GAP):
        guess = HybridAStar().make(scenario, car(), margin=GAP).trajectory
        if guess is not None:
            found += 1
            yield Start(scenario, guess)
        if found == count:
            return


def by_the_paper(nlp: Nlp, solver: Ipopt = PAPERS_METHOD) -> Timed:
    """Solve; neither building the functions counts nor telling each iteration to Python."""
    wall, processor = time.perf_counter(), time.thread_time()
    report = solver.solve(nlp)
    wall, processor = time.perf_counter() - wall, time.thread_time() - processor
    own = report.timings["solve"] - report.timings.get("callback", 0.0)
    return Timed(report, processor * own / wall)


def median_seconds(work: Callable[[], Any], repeats: int) -> float:
    """Median processor time of this thread, s."""
    times = []
    for _ in range(repeats):
        began = time.thread_time()
        work()
        times.append(time.thread_time() - began)
    return statistics.median(times)


def quantiles(values: ArrayLike) -> dict[str, float]:
    """Median, quartiles, tenth and ninetieth percentile, extremes."""
    names = {"smallest": 0.0, "p10": 0.1, "p25": 0.25, "median": 0.5, "p75": 0.75, "p90": 0.9, "largest": 1.0}
    return {name: float(np.quantile(np.asarray(values, float), q)) for name, q in names.items()}


def slope(x: ArrayLike, y: ArrayLike) -> float:
    """Of log y over log x, by least squares: 1 where y is proportional to x."""
    return float(np.polyfit(np.log(np.asarray(x, float)), np.log(np.asarray(y, float)), 1)[0])
