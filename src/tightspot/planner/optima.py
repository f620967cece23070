"""The optima that many guesses lead to: solved in one batch, each told once, the best first."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from tightspot.guesses import GuessResult
from tightspot.scenarios import Scenario
from tightspot.solvers import StageProblem, StageReport, Stagewise
from tightspot.transcription import Settings, TimeGrid, stage_problem
from tightspot.vehicles import VehicleModel

SAME_OBJECTIVE, SAME_TIME = 2e-3, 5e-3
SAME_PLACE = 0.2


@dataclass(frozen=True, eq=False)
class Optimum:
    """A local optimum.

    Attributes:
        guess: The first guess that led to it.
        report: From that guess.
        indices: Of all guesses that led to it, counted without those that have no trajectory.
    """

    guess: GuessResult
    report: StageReport
    indices: tuple[int, ...]

    @property
    def objective(self) -> float:
        """J."""
        return float(self.report.objective)


def find_optima(
    scenario: Scenario,
    vehicle: VehicleModel,
    settings: Settings,
    guesses: Iterable[GuessResult],
    *,
    grid: TimeGrid,
    solver: Stagewise | None = None,
    threads: int = 1,
) -> list[Optimum]:
    """Solve one program from every guess and tell the optima, the smallest J first.

    The optima are those of the program: with a formulation that holds at the knots, nobody has looked between them yet;
    :func:`tightspot.planner.plan` with ``effort="best"`` goes on until they are certified.

    Args:
        scenario: The scene.
        vehicle: One whose model the stagewise solver knows.
        settings: Objective, formulation, margins.
        guesses: For example :func:`tightspot.guesses.assorted`; those without a trajectory are left out.
        grid: The intervals.
        solver: With which options.
        threads: Solves at a time; the answer does not depend on it.

    Returns:
        Optima that differ by more than 0.2 % in J, 0.5 % in t_f or 0.2 m in where the vehicle is at three moments;
        none if no solve ended well.

    Raises:
        InputError: If the stagewise solver does not know the vehicle's model or the formulation, or an argument does
            not fit the others.
    """
    tried = [guess for guess in guesses if guess.trajectory is not None]
    problems: list[StageProblem] = []
    for guess in tried:
        if guess.trajectory is not None:
            problems.append(stage_problem(scenario, vehicle, guess.trajectory, settings, grid=grid))
    return distinct(tried, (solver or Stagewise()).solve_many(problems, threads=threads))


def distinct(guesses: Sequence[GuessResult], reports: Sequence[StageReport]) -> list[Optimum]:
    """The optima among the reports, each once, the smallest J first; what was not solved is left out."""
    solved = [index for index, report in enumerate(reports) if report.status.success]
    groups: list[list[int]] = []
    for index in sorted(solved, key=lambda index: reports[index].objective):
        home = next((group for group in groups if alike(reports[group[0]], reports[index])), None)
        if home is None:
            groups.append([index])
        else:
            home.append(index)
    ordered = [tuple(sorted(group)) for group in groups]
    return [Optimum(guesses[group[0]], reports[group[0]], group) for group in ordered]


def alike(a: StageReport, b: StageReport) -> bool:
    """Whether two solutions are the same optimum, perhaps on different meshes."""
    near = abs(a.objective - b.objective) <= SAME_OBJECTIVE * max(abs(a.objective), abs(b.objective))
    if not near or abs(a.final_time - b.final_time) > SAME_TIME * max(a.final_time, b.final_time):
        return False
    return bool(np.hypot(*(_places(a) - _places(b)).T).max() <= SAME_PLACE)


def _places(report: StageReport) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Positions at a quarter, a half and three quarters of the knots, (3, 2)."""
    if report.states is None:
        return np.zeros((3, 2))
    at = np.array([0.25, 0.5, 0.75]) * (len(report.states) - 1)
    knots = np.arange(len(report.states))
    return np.column_stack([np.interp(at, knots, report.states[:, column]) for column in (0, 1)])
