"""Who listens to a solve may stop it, with Python's or NumPy's ``False``, in every backend alike."""

from functools import cache

import numpy as np
import pytest

from tightspot.formulations import UnitNormalLine
from tightspot.guesses import HybridAStar
from tightspot.scenarios.library import builtin
from tightspot.solvers import SOLVERS, SolveStatus, Stagewise
from tightspot.transcription import Settings, TimeGrid, stage_problem, transcribe
from tightspot.vehicles import vehicle

BACKENDS = [*SOLVERS, Stagewise.name]


@cache
def programs():
    scenario, car = builtin("oblique"), vehicle("paper")
    guess = HybridAStar().make(scenario, car, margin=0.05).trajectory
    given, grid = (scenario, car, guess, Settings(formulation=UnitNormalLine(), substeps=1)), TimeGrid.uniform(10)
    return transcribe(*given, grid=grid).nlp, stage_problem(*given, grid=grid)


def solve(backend, callback):
    nlp, problem = programs()
    if backend == Stagewise.name:
        return Stagewise().solve_stages(problem, callback=callback)
    return SOLVERS[backend]().solve(nlp, callback=callback)


@pytest.mark.parametrize("no", [False, np.False_], ids=["Python", "NumPy"])
@pytest.mark.parametrize("backend", BACKENDS)
def test_false_stops(backend, no):
    seen = []

    def watch(iteration):
        seen.append(iteration.number)
        return no if len(seen) == 3 else None

    assert solve(backend, watch).status is SolveStatus.STOPPED
    assert len(seen) == 3


@pytest.mark.parametrize("answer", [None, True, np.True_, 0, ""])
@pytest.mark.parametrize("backend", ["ipopt", Stagewise.name])
def test_nothing_else_does(backend, answer):
    assert solve(backend, lambda iteration: answer).status.success
