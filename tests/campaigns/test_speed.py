"""The speed benchmark measures what it says. A whole run is in tests/cli/test_bench_speed.py."""

from dataclasses import replace

import numpy as np
import pytest

from tightspot.campaigns.speed import SpeedPlan, run_speed
from tightspot.campaigns.speed.cases import by_the_paper, car, scenes_about, settings_for, slope, starts
from tightspot.campaigns.speed.scaling import crowded, rounded
from tightspot.campaigns.speed.solves import compare, residual, straight, summary
from tightspot.errors import InputError
from tightspot.geometry import ConvexPolygon
from tightspot.scenarios.library import builtin
from tightspot.solvers import Stagewise
from tightspot.transcription import TimeGrid, stage_problem, transcribe


@pytest.mark.parametrize("power", [0.0, 1.0, 2.0])
def test_a_slope_is_the_exponent(power):
    x = np.array([2.0, 5.0, 30.0, 400.0])
    assert slope(x, 3.0 * x**power) == pytest.approx(power, abs=1e-12)


def test_starts_are_the_scene_s_and_free_ones_about_it_the_same_for_a_seed():
    found = list(scenes_about("vertical", 4, 1, 0.05))
    again = list(scenes_about("vertical", 4, 1, 0.05))
    other = list(scenes_about("vertical", 4, 2, 0.05))
    np.testing.assert_array_equal(found[0].start, builtin("vertical").start)
    moves = np.array([scene.start - found[0].start for scene in found])
    assert (np.abs(moves[:, :3]) <= [1.0, 0.5, 0.2]).all()
    assert len(np.unique(moves[:, 0])) == 4
    np.testing.assert_array_equal(moves, [scene.start - found[0].start for scene in again])
    assert not np.array_equal(found[1].start, other[1].start)


@pytest.mark.parametrize("count", [8, 16, 64])
def test_rounded_obstacles_are_convex_within_the_rectangle_and_have_so_many_vertices(count):
    corners = np.array([(0, -8), (5, -8), (5, -2), (0, -2)], float)
    polygon = ConvexPolygon(rounded(corners, count))
    assert len(polygon.vertices) == count
    assert (polygon.vertices >= corners.min(axis=0) - 1e-12).all()
    assert (polygon.vertices <= corners.max(axis=0) + 1e-12).all()


@pytest.mark.parametrize("count", [2, 3, 10, 100])
def test_crowded_scenes_have_so_many_obstacles_that_do_not_meet(count):
    scene = crowded(count)
    assert len(scene.obstacles) == count
    boxes = np.array([(*o.exterior.min(axis=0), *o.exterior.max(axis=0)) for o in scene.obstacles])
    apart = (boxes[:, None, :2] >= boxes[None, :, 2:]).any(axis=2) | (boxes[None, :, :2] >= boxes[:, None, 2:]).any(
        axis=2
    )
    assert apart[~np.eye(count, dtype=bool)].all()


@pytest.fixture(scope="module")
def solved():
    """A start of the scene oblique with its program and our answer."""
    (start,) = starts("oblique", 1, 0)
    settings, grid = settings_for(1.0), TimeGrid.uniform(20)
    problem = stage_problem(start.scenario, car(), start.guess, settings, grid=grid)
    nlp = transcribe(start.scenario, car(), start.guess, settings, grid=grid).nlp
    return start, nlp, Stagewise().solve_stages(problem)


def test_the_residual_is_small_at_a_solution_and_not_beside_it(solved):
    _, nlp, report = solved
    assert residual(nlp, report) < 1e-6
    rng = np.random.default_rng(0)
    beside = replace(report, x=report.x + 1e-3 * rng.normal(size=report.x.size))
    assert residual(nlp, beside) > 1e-4
    assert residual(nlp, replace(report, lam_g=1.01 * report.lam_g)) > 1e-4


def test_a_comparison_compares_the_same_program(solved):
    start, nlp, report = solved
    case = compare(start, 1.0)
    assert case["success"]
    assert case["ipopt_success"]
    assert case["objective"] == pytest.approx(report.objective, rel=1e-12)
    assert case["ipopt_objective"] == pytest.approx(case["objective"], rel=1e-5), "the scene has one good optimum"
    assert case["seconds"] > 0
    assert case["ipopt_seconds"] > 0
    timed = by_the_paper(nlp)
    assert timed.seconds <= 1.5 * timed.report.timings["solve"] + 0.01
    figures = summary([case, case])
    assert figures["ratio"]["median"] == pytest.approx(case["ipopt_seconds"] / case["seconds"])
    assert figures["success"] == 1.0


def test_straight_guesses_are_straight(solved):
    line = straight(solved[0]).guess
    np.testing.assert_allclose(np.diff(line.states, 2, axis=0), 0.0, atol=1e-12)


def test_numbers_that_make_no_sense_are_refused():
    with pytest.raises(InputError, match="starts: 0 must be at least 1"):
        SpeedPlan(starts=0)
    with pytest.raises(InputError, match="seed"):
        SpeedPlan(seed=-1)


def test_an_interrupt_ends_it():
    def stop(news):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_speed(SpeedPlan(), progress=stop)
