"""Many problems at once, on the compiled core's threads."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from tightspot.errors import InputError, Problem, is_whole
from tightspot.solvers.base import Array
from tightspot.solvers.stage_core import MODELS, compiled
from tightspot.solvers.stage_problem import StageProblem

AT_ONCE = 64
"""Problems that each thread of a batch is given at a time; between them, Python is told of Ctrl-C."""


def check_batch(problems: Sequence[StageProblem], threads: int, time_limit: float | None) -> None:
    """Whether this is a batch at all.

    Raises:
        InputError: With all problems of the first argument that has some.
    """
    if not is_whole(threads) or threads < 1:
        raise InputError(Problem("threads", f"{threads!r} is no number of threads; give at least 1"))
    if time_limit is not None and not (isinstance(time_limit, (float, int, np.number)) and time_limit > 0):
        raise InputError(Problem("time_limit", f"{time_limit!r} must be positive"))
    if not isinstance(problems, Sequence):
        raise InputError(Problem("problems", f"{type(problems).__name__} is no sequence of problems; give a list"))
    others = [(i, type(one).__name__) for i, one in enumerate(problems) if not isinstance(one, StageProblem)]
    if others:
        raise InputError([Problem(f"problems[{i}]", f"{name} is not a StageProblem") for i, name in others])


def solve_together(
    problems: Sequence[StageProblem], options: Any, threads: int, seconds: float
) -> Iterable[dict[str, Any]]:
    """The core's answer to each problem, with ``flaw`` alone where one cannot be used."""
    models = sorted({problem.model for problem in problems})
    answers: list[dict[str, Any]] = [{} for _ in problems]
    for model in models:
        mine = [i for i, problem in enumerate(problems) if problem.model == model]
        if model not in MODELS:
            found = [{"flaw": f"the model {model!r} is not compiled in"}] * len(mine)
        else:
            starts = [_start_of(problems[i]) for i in mine]
            core = getattr(compiled(), MODELS[model])
            found = core.solve_many([problems[i] for i in mine], starts, options, threads, seconds)
        for i, answer in zip(mine, found, strict=True):
            answers[i] = answer
    return answers


def _start_of(problem: StageProblem) -> Array | None:
    """``None`` if its arrays do not fit each other."""
    try:
        with np.errstate(invalid="ignore", over="ignore"):
            return problem.starting_point()
    except (ValueError, TypeError, IndexError, AttributeError):
        return None
