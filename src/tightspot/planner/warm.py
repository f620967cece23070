"""Rounds that begin with the last round of another plan."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

from tightspot.planner.course import certified
from tightspot.planner.progress import Progress, ProgressCallback, iterations_told
from tightspot.planner.request import Request
from tightspot.planner.rounds import Round, Step, problem_of, run_round
from tightspot.planner.strategy import next_step
from tightspot.solvers import IterationCallback, StagePoint, StageProblem, StageReport, Stagewise
from tightspot.solvers.stage_core import core_solver
from tightspot.solvers.stagewise import WARM_ITERATIONS
from tightspot.transcription import carry_lines, moved_ends

MOST_ROUNDS = 3


class KeptCore:
    """The compiled solver of the last problem: the next one need not set it up if only start and goal moved."""

    def __init__(self) -> None:
        self._problem: StageProblem | None = None
        self._core: Any = None

    def keep(self, last: Round) -> None:
        """Set up for the round's problem."""
        if isinstance(last.report, StageReport) and last.report.problem is not None:
            self.of(last.report.problem)

    def of(self, problem: StageProblem) -> Any:
        """The one that is kept if it fits the problem, else a new one."""
        if self._problem is None or not problem.differs_in_ends_only(self._problem):
            self._core = core_solver(problem)
        self._problem = problem
        return self._core


def warm_rounds(request: Request, last: Round, core: KeptCore, tell: ProgressCallback, deadline: float) -> list[Round]:
    """The request solved on the mesh of ``last``, from its trajectory, lines and multipliers; refined if need be.

    No fall-back solvers, and no other starts: what does not come out at once is better planned anew.
    """
    alone = replace(request, fallbacks=()) if request.fallbacks else request
    start = last.trajectory
    step: Step | None = Step(last.mesh, start, "warm", "from the last plan", last)
    solved = _solved_again(alone, last, core, deadline - time.perf_counter(), iterations_told(tell, 0))
    rounds: list[Round] = []
    while step is not None:
        number = len(rounds)
        rounds.append(run_round(alone, step, number, tell, deadline - time.perf_counter(), solved))
        solved = None
        if certified(rounds) or not rounds[-1].solved or number + 1 == MOST_ROUNDS or time.perf_counter() > deadline:
            break
        step = next_step(alone, rounds, start)
        if step is not None:
            tell(Progress("refine", step.reason, number + 1))
    return rounds


def _solved_again(
    request: Request, last: Round, core: KeptCore, seconds: float, watch: IterationCallback | None
) -> StageReport | None:
    """On the same mesh, from the last solution with all its multipliers; ``None`` if another solver made it."""
    report, solver = last.report, request.solver
    if not isinstance(solver, Stagewise) or not isinstance(report, StageReport) or report.point is None:
        return None
    problem = moved_ends(report, request.scenario)
    if problem is None:
        step = Step(last.mesh, last.trajectory, "warm", "from the last plan", last)
        problem = carry_lines(last.mesh.grid, report, problem_of(request, step))
    most, limit = min(solver.max_iterations, WARM_ITERATIONS), min(solver.time_limit, max(seconds, 1e-3))
    quick = solver.with_options(max_iterations=most, time_limit=limit, robust=False)
    old = report.point
    point = StagePoint(problem.starting_point(), old.s, old.z, old.zb, old.lam, old.nu)
    return quick.solve_stages(problem, warm=point, callback=watch, core=core.of(problem))
