"""The compiled stagewise solver, one problem at a time."""

from __future__ import annotations

from typing import Any

import numpy as np

from tightspot.errors import BuildError, InputError, Problem
from tightspot.solvers.stage_problem import StageProblem
from tightspot.solvers.stage_report import StagePoint

MODELS = {"single_track": "StagewiseSingleTrack"}
"""Names of the models that are compiled in, and of the core's solvers of them."""


def core_solver(problem: StageProblem) -> Any:
    """The compiled solver of one problem, whose set-up allocates everything that solving needs.

    Raises:
        InputError: The model is not compiled in, or an array does not fit the others.
    """
    if problem.model not in MODELS:
        raise InputError(Problem("model", f"{problem.model!r} is not compiled in; there are {', '.join(MODELS)}"))
    if problem.penetrations.shape != (len(problem.pairs),):
        given = f"penetrations: has shape {problem.penetrations.shape}, but there are {len(problem.pairs)} pairs"
        raise InputError(Problem("problem", given))
    try:
        return getattr(compiled(), MODELS[problem.model])(problem)
    except ValueError as error:
        raise InputError(Problem("problem", str(error))) from None


def move_ends(core: Any, problem: StageProblem) -> None:
    """Start and goal of the problem, for the solver of another one that differs in these."""
    try:
        core.set_ends(problem.start, problem.goal)
    except ValueError as error:
        raise InputError(Problem("core", f"it is another problem's: {error}")) from None


def set_start(core: Any, problem: StageProblem, warm: StagePoint | None) -> None:
    """The point to start from: the problem's own, or the given one with its multipliers."""
    try:
        with np.errstate(invalid="ignore", over="ignore"):
            core.set(problem.starting_point() if warm is None else warm.v)
        if warm is not None:
            core.set_multipliers(warm.s, warm.z, warm.zb, warm.lam, warm.nu)
    except (ValueError, IndexError) as error:
        raise InputError(Problem("warm" if warm else "problem", str(error))) from None


def compiled() -> Any:
    """The compiled core.

    Raises:
        BuildError: It cannot be loaded.
    """
    try:
        from tightspot import _core
    except ImportError as error:
        raise BuildError(
            f"tightspot's compiled core cannot be loaded ({error}); install a C++17 compiler, e.g. "
            "`apt install g++`, and install tightspot again with `pip install .` in its folder"
        ) from None
    return _core
