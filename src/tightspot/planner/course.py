"""Round after round, until one is certified."""

from __future__ import annotations

import time

from tightspot.planner.progress import Progress, ProgressCallback
from tightspot.planner.request import Request
from tightspot.planner.rounds import Round, Step, run_round
from tightspot.planner.strategy import first_step, next_step
from tightspot.solvers import StageReport
from tightspot.trajectory import Trajectory


def run_rounds(
    request: Request,
    guess: Trajectory,
    tell: ProgressCallback,
    deadline: float,
    solved: StageReport | None = None,
) -> list[Round]:
    """Rounds until one is certified or nothing is left to try, or until their number or time is used up.

    The first step may have been ``solved`` already.
    """
    step: Step | None = first_step(request, guess)
    rounds: list[Round] = []
    while step is not None:
        number = len(rounds)
        rounds.append(run_round(request, step, number, tell, deadline - time.perf_counter(), solved))
        solved = None
        if certified(rounds) or number == request.refinements or time.perf_counter() > deadline:
            break
        step = next_step(request, rounds, guess)
        if step is not None:
            tell(Progress("refine", step.reason, number + 1))
    return rounds


def certified(rounds: list[Round]) -> bool:
    """Whether the last round was certified."""
    return rounds[-1].certified
