"""Our structure-exploiting interior-point solver, compiled: the Python face."""

from __future__ import annotations

from typing import Any

from tightspot.errors import InputError, Problem
from tightspot.solvers.stage_problem import StageProblem


def core_solver(problem: StageProblem) -> Any:
    """The compiled solver of one problem, whose set-up allocates everything that solving needs.

    Raises:
        InputError: The model is not compiled in, or an array does not fit the others.
    """
    from tightspot import _core

    models = {"single_track": _core.StagewiseSingleTrack}
    if problem.model not in models:
        raise InputError(Problem("model", f"{problem.model!r} is not compiled in; there are {', '.join(models)}"))
    try:
        return models[problem.model](problem)
    except ValueError as error:
        raise InputError(Problem("problem", str(error))) from None
