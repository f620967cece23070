"""The speed benchmark measures what it says. A whole run is in tests/cli/test_bench_speed.py."""

from dataclasses import replace

import numpy as np
import pytest
from shapely.geometry import Polygon

from tightspot.campaigns.speed import SpeedPlan, run_speed
from tightspot.campaigns.speed.cases import by_the_paper, car, scenes_about, settings_for, slope, starts
from tightspot.campaigns.speed.infeasible import impossible, infeasible, infeasible_summary
from tightspot.campaigns.speed.plans import PARTS, compare_plans, plan_summary
from tightspot.campaigns.speed.scaling import crowded, rounded
from tightspot.campaigns.speed.solves import best_known, compare, residual, straight, summary
from tightspot.errors import InputError
from tightspot.geometry import ConvexPolygon, transform
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


def test_the_best_known_is_of_this_program_and_no_worse_than_both(solved):
    start, _, report = solved
    (known,) = best_known(start, [1.0])
    assert known <= report.objective * (1 + 1e-6), "the first of the guesses is the start's own"
    case = compare(start, 1.0, known=known)
    assert case["best"] == min(known, case["objective"], case["ipopt_objective"])
    far = summary([case | {"best": 0.9 * known}])
    near = summary([case | {"best": known}])
    assert (far["near_best"], near["near_best"]) == (0.0, float(case["objective"] <= 1.01 * known))


def test_ratios_are_of_the_cases_that_both_solve(solved):
    case = compare(solved[0], 1.0)
    slow = case | {"ipopt_success": False, "ipopt_seconds": 1e6, "ipopt_objective": np.nan}
    figures = summary([case, slow])
    assert figures["ratio"]["largest"] == pytest.approx(case["ipopt_seconds"] / case["seconds"])
    assert figures["ipopt_success"] == figures["ipopt_near_best"] == 0.5
    assert summary([slow])["ratio"] is None


def test_a_plan_s_parts_are_all_of_its_time(solved):
    (case,) = compare_plans("oblique", 1, 0, lambda told: None)
    assert case["success"]
    assert tuple(case["parts"]) == PARTS
    assert sum(case["parts"].values()) == pytest.approx(case["seconds"], rel=1e-9)
    assert min(case["parts"].values()) >= 0
    figures = plan_summary([case, {"success": False, "seconds": 1.0, "reason": "none"}])
    both = case["search_seconds"] + case["ipopt_seconds"]
    assert figures["success"] == 0.5
    assert figures["ratio"]["median"] == pytest.approx(both / case["seconds"])
    assert figures["ratio_with_building"]["median"] == pytest.approx(
        (both + case["ipopt_set_up_seconds"]) / case["seconds"]
    )
    assert plan_summary([case | {"ipopt_success": False}]) == {"starts": 1, "success": 1.0}


def test_infeasible_programs_are_infeasible(solved):
    start = solved[0]
    body = transform(car().parts[0].polygon.vertices, np.array([start.scenario.start, start.scenario.goal])[:, :3])
    given = dict(impossible(start))
    for kind in ("block in the slot", "goal in too narrow a gap"):
        added = given[kind].start.scenario.obstacles[len(start.scenario.obstacles) :]
        assert added
        assert all(Polygon(obstacle.exterior).intersection(Polygon(body[1])).area > 0.01 for obstacle in added)
    boxed = given["walls around the start"]
    walls = [Polygon(each.exterior) for each in boxed.start.scenario.obstacles[len(start.scenario.obstacles) :]]
    ring = walls[0].union(walls[1]).union(walls[2]).union(walls[3])
    assert len(ring.interiors) == 1, "closed"
    assert Polygon(ring.interiors[0]).contains(Polygon(body[0]))
    assert not ring.intersects(Polygon(body[1]))
    longest = boxed.settings.final_time[1] / 20 * max(car().limits.speed)
    assert longest < np.ptp(car().parts[0].polygon.vertices[:, 1]) + 1.0, "no interval is long enough to jump"
    hurried = given["too little time"].settings.final_time[1]
    assert hurried * max(car().limits.speed) < np.hypot(*(start.scenario.goal - start.scenario.start)[:2])


@pytest.mark.slow
def test_who_says_infeasible_and_when(solved):
    cases = infeasible([solved[0]], lambda news: None)
    assert [case["kind"] for case in cases] == list(dict(impossible(solved[0])))
    figures = infeasible_summary(cases)
    assert figures["all"]["cases"] == len(cases) == sum(figures["all"]["statuses"].values())
    assert not {"SOLVED", "ACCEPTABLE"} & (set(figures["all"]["statuses"]) | set(figures["all"]["ipopt_statuses"]))
    assert figures["all"]["ratio"]["median"] == pytest.approx(
        np.median([case["ipopt_seconds"] / case["seconds"] for case in cases])
    )


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
