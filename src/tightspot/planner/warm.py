"""Rounds that begin with the last round of another plan."""

from __future__ import annotations

import time
from dataclasses import replace

from tightspot.planner.course import certified
from tightspot.planner.progress import Progress, ProgressCallback
from tightspot.planner.request import Request
from tightspot.planner.rounds import Round, Step, run_round
from tightspot.planner.strategy import next_step

MOST_ROUNDS = 3


def warm_rounds(request: Request, last: Round, tell: ProgressCallback, deadline: float) -> list[Round]:
    """The request solved on the mesh of ``last``, from its trajectory, lines and multipliers; refined if need be.

    No fall-back solvers: what does not come out at once is better planned anew.
    """
    alone = replace(request, fallbacks=())
    start = last.trajectory
    step: Step | None = Step(last.mesh, start, "warm", "from the last plan", last)
    rounds: list[Round] = []
    while step is not None:
        number = len(rounds)
        rounds.append(run_round(alone, step, number, tell, deadline - time.perf_counter()))
        if certified(rounds) or not rounds[-1].solved or number + 1 == MOST_ROUNDS or time.perf_counter() > deadline:
            break
        step = next_step(alone, rounds, start)
        if step is not None:
            tell(Progress("refine", step.reason, number + 1))
    return rounds
