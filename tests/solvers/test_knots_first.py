"""Solves begun with the rows at the knots alone: the same program in the end, and nothing lost on the way."""

from dataclasses import replace

import numpy as np
import pytest
from tests.solvers.test_stagewise import case, kkt_residuals

from tightspot.formulations import SeparatingLine, SoftSweptUnitNormalLine, SweptLine
from tightspot.solvers import SolveStatus, Stagewise, knots_first, solve_many
from tightspot.solvers.stage_core import core_solver
from tightspot.transcription import transcribe
from tightspot.transcription.stage_problem import stage_problem

BOTH = ["given, at the knots", "from the knots"]


def swept(scene="parallel", **changes):
    arguments, grid = case(scene, SweptLine(), **changes)
    return stage_problem(*arguments, **grid)


def starts(report):
    return [one.start for one in report.attempts]


@pytest.mark.parametrize("scene", ["oblique", "vertical", "parallel"])
def test_the_answer_satisfies_the_whole_programs_conditions(scene):
    arguments, grid = case(scene, SweptLine(), poses=2)
    problem = stage_problem(*arguments, **grid)
    report = Stagewise().solve_stages(problem)
    assert report.status.success
    assert report.problem is problem
    assert starts(report)[:2] == BOTH
    assert report.iterations == sum(one.iterations for one in report.attempts)
    assert max(kkt_residuals(transcribe(*arguments, **grid).nlp, report)) < 1e-6


def test_rows_at_the_knots_are_those_of_the_program_without_poses():
    whole, bare = swept(poses=3), swept(poses=0)
    knots = knots_first.at_knots(whole)
    for name in ("pieces", "pair_demands", "wall_demands", "pair_sides", "pairs", "walls"):
        np.testing.assert_array_equal(getattr(knots, name), getattr(bare, name))
    np.testing.assert_array_equal(knots.substeps, whole.pieces * whole.substeps)
    assert knots_first.has_rows_between(whole)
    assert not knots_first.has_rows_between(knots)


def test_rows_at_the_knots_are_a_relaxation_with_the_same_motion():
    """What solves all rows satisfies those at the knots, and the dynamics written with fewer samples."""
    whole = swept(poses=3)
    point = Stagewise().solve_stages(whole).point
    core = core_solver(knots_first.at_knots(whole))
    sizes = core.sizes
    at = core.derivatives(point.v, point.lam, np.zeros(sizes["rows"]))
    assert np.abs(at["defects"]).max() < 1e-8
    assert at["rows"].min() > -1e-8
    assert at["rows"].size < point.z.size


@pytest.mark.parametrize("moment", [1, 3, 40])
def test_a_callback_stops_it_in_either_phase(moment):
    seen = []

    def watch(news):
        seen.append(news.number)
        return len(seen) < moment

    problem = swept()
    report = Stagewise().solve_stages(problem, callback=watch)
    if len(seen) < moment:
        assert report.status.success
    else:
        assert report.status is SolveStatus.STOPPED
    assert report.problem is problem
    assert report.x.size == report.n_variables
    assert report.g.size == report.n_rows


def test_limits_hold_for_all_together():
    problem = swept()
    for most in (1, 4, 5, 12, 40):
        report = Stagewise(max_iterations=most).solve_stages(problem)
        assert report.iterations <= most
        assert report.x.size == report.n_variables
    late = Stagewise(time_limit=1e-9).solve_stages(problem)
    assert late.status is SolveStatus.TIME_LIMIT
    assert late.problem is problem


def test_what_fails_at_the_knots_is_solved_from_the_given_start(monkeypatch):
    problem = swept("vertical")
    alone = Stagewise(knots_first=False, max_iterations=1000).solve_stages(problem)
    assert alone.status.success
    assert starts(alone) == ["given"]
    monkeypatch.setattr(knots_first, "SHARE", 500)  # two iterations at the knots
    report = Stagewise(max_iterations=1000).solve_stages(problem)
    assert report.status.success
    assert starts(report) == ["given, at the knots", "given"]
    assert report.iterations == alone.iterations + 2
    np.testing.assert_array_equal(report.x, alone.x)


def test_only_problems_with_rows_between_knots_and_starts_of_unknown_quality():
    arguments, grid = case("vertical", SeparatingLine())
    assert starts(Stagewise().solve_stages(stage_problem(*arguments, **grid))) == ["given"]
    problem = swept("vertical")
    assert starts(Stagewise(initial_barrier=0.1).solve_stages(problem))[0] == "given"
    arguments, grid = case("vertical", SoftSweptUnitNormalLine())
    assert not knots_first.has_rows_between(stage_problem(*arguments, **grid))
    solved = Stagewise().solve_stages(problem)
    assert starts(Stagewise().solve_stages(problem, warm=solved.point)) == ["warm"]


@pytest.mark.parametrize("threads", [1, 3])
def test_together_as_alone(threads):
    bare, rough = swept(poses=0), swept("vertical", steps=8)
    given = [swept(), bare, swept("vertical"), rough, rough.replaced(model="boat")]
    solver = Stagewise(max_iterations=300)
    reports = solve_many(given, threads=threads, solver=solver)
    assert reports[-1].status is SolveStatus.FAILED
    assert reports[-1].problem is given[-1]
    for problem, report in zip(given[:-1], reports[:-1], strict=True):
        alone = solver.solve_stages(problem)
        assert report.problem is problem
        assert (report.status, report.iterations, report.attempts) == (alone.status, alone.iterations, alone.attempts)
        np.testing.assert_array_equal(report.x, alone.x)
    hasty = solve_many(given[:4], solver=replace(solver, max_iterations=6))
    assert all(report.iterations <= 6 for report in hasty)
