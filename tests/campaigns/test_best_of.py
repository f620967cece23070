"""The better optima of the paper's programs, found from any seed."""

from __future__ import annotations

import json

import casadi as ca
import numpy as np
import pytest
from benchmarks.best_of_many import figures, table

from tightspot.campaigns import best_of, paper_settings
from tightspot.campaigns.claims import SAME
from tightspot.campaigns.table import BETTER
from tightspot.errors import InputError
from tightspot.formulations import SeparatingLine
from tightspot.transcription import TimeGrid, transcribe


@pytest.mark.parametrize("known", BETTER, ids=lambda known: known.scene)
def test_the_best_known_optimum_is_the_first_that_is_told(known):
    for seed in range(5):
        optimum = best_of(known.scene, seed)[0]
        assert optimum.objective == pytest.approx(known.objective, rel=SAME)
        assert optimum.report.final_time == pytest.approx(known.final_time, rel=SAME)


@pytest.mark.slow
@pytest.mark.parametrize("known", BETTER, ids=lambda known: known.scene)
def test_it_is_found_from_nearly_every_seed(known):
    found = [best_of(known.scene, seed)[0].objective for seed in range(100)]
    assert np.sum(np.abs(np.array(found) - known.objective) <= SAME * known.objective) >= 95


def test_it_is_a_solution_of_the_program_that_ipopt_solves():
    settings, known = paper_settings(), BETTER[1]
    optimum = best_of(known.scene, 7)[0]
    scenario, car = settings.scenario(known.scene), settings.car()
    wanted, grid = settings.transcription(SeparatingLine()), TimeGrid.uniform(settings.steps)
    nlp = transcribe(scenario, car, optimum.guess.trajectory, wanted, grid=grid).nlp
    report = optimum.report
    f, g, gradient, jacobian = (
        np.array(value)
        for value in ca.Function(
            "all", [nlp.x, nlp.p], [nlp.f, nlp.g, ca.gradient(nlp.f, nlp.x), ca.jacobian(nlp.g, nlp.x)]
        )(report.x, nlp.p0)
    )
    assert f.item() == pytest.approx(known.objective, rel=SAME)
    assert nlp.violation(g.ravel()).max() < 1e-6
    assert np.maximum(nlp.lbx - report.x, report.x - nlp.ubx).max() < 1e-6
    assert np.abs(gradient.ravel() + jacobian.T @ report.lam_g + report.lam_x).max() < 1e-6


def test_optima_come_in_order_and_no_guess_is_counted_twice():
    optima = best_of("parallel", 2, count=20, threads=2)
    values = [optimum.objective for optimum in optima]
    assert values == sorted(values)
    indices = [index for optimum in optima for index in optimum.indices]
    assert len(indices) == len(set(indices)) <= 20
    again = best_of("parallel", 2, count=20)
    assert [optimum.objective for optimum in again] == values


def test_the_printed_settings_can_be_solved_too():
    optima = best_of("oblique", 1, settings=paper_settings("printed"), count=4)
    assert optima[0].objective == pytest.approx(22.75, rel=2e-2)


def test_a_scene_that_is_not_the_paper_s_is_named():
    with pytest.raises(InputError, match="'garage' is not one of the paper's"):
        best_of("garage")


def test_the_benchmark_tells_how_often_and_how_fast():
    results = figures(runs=2, guesses=6)
    assert json.loads(json.dumps(results)) == results
    assert set(results["scenes"]) == {"vertical", "parallel"}
    for row in results["scenes"].values():
        assert 0 <= row["found_by_what_is_drawn"] <= row["found"] <= 2
        assert row["ratio"] == pytest.approx(row["ipopt_milliseconds"] / row["milliseconds"])
        assert 0 < row["share_of_guesses"] <= row["share_solved"] <= 1
    assert table(results).count("\n") == 4
