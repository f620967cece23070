"""Where the solver stopped is the same whether it is read off the arrays or off the program's symbols."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tightspot.formulations import SweptLine, UnitNormalLine
from tightspot.planner.request import resolve
from tightspot.planner.rounds import run_round
from tightspot.planner.solver_stop import _of_program, _of_stages
from tightspot.planner.strategy import first_step
from tightspot.solvers import StageReport, Stagewise


@pytest.mark.parametrize("formulation", [UnitNormalLine(), SweptLine()])
@pytest.mark.parametrize("iterations", [0, 2, 6])
def test_arrays_and_symbols_agree(formulation, iterations):
    request = resolve("vertical", None, None, formulation, None, Stagewise(max_iterations=iterations), 20, 0.02, 8, 60)
    guess = request.guess.make(request.scenario, request.vehicle, margin=0.02).trajectory
    step = first_step(request, guess)
    step = replace(step, mesh=replace(step.mesh, formulation=formulation, poses=(2,) * 20))
    last = run_round(request, step, 0, lambda news: None, 60.0)
    assert isinstance(last.report, StageReport)
    assert not last.report.status.success
    by_symbols = _of_program(last)
    for found in _of_stages(last.report):
        alike = [each for each in by_symbols if each.kind == found.kind]
        worst = max(alike, key=lambda each: each.amount)
        assert max(found.amount, 0.0) == pytest.approx(worst.amount, abs=1e-9)
        if worst.amount > 1e-9:
            same = next(each for each in alike if each.knot == found.knot and each.key[: len(found.key)] == found.key)
            assert same.amount == pytest.approx(worst.amount, abs=1e-9)
