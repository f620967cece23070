"""From a straight line: the stagewise solver begins anew in other ways, says so, and keeps to its limits."""

from dataclasses import replace

import numpy as np
import pytest

from tightspot.formulations import SeparatingLine, SweptUnitNormalLine
from tightspot.geometry import ConvexPolygon, best_line, transform
from tightspot.guesses import LinearInterpolation
from tightspot.scenarios import Obstacle
from tightspot.scenarios.library import builtin
from tightspot.solvers import SolveStatus, Stagewise
from tightspot.solvers.rough_starts import bent, can_start_again, gentle, rolling, ways, without_pairs
from tightspot.solvers.stage_lines import with_states
from tightspot.transcription import Objective, Settings, TimeGrid, stage_problem
from tightspot.vehicles import vehicle

CAR = vehicle("paper")


def line(scene="vertical", formulation=None, boxes=(), weight=1.0, steps=20):
    scenario = builtin(scene)
    more = tuple(Obstacle(f"box {i}", ConvexPolygon.rectangle(*box).vertices) for i, box in enumerate(boxes))
    scenario = replace(scenario, obstacles=(*scenario.obstacles, *more))
    guess = LinearInterpolation().make(scenario, CAR, margin=0.0).trajectory
    settings = Settings(Objective(weight), formulation or SeparatingLine(), margin=0.002)
    return stage_problem(scenario, CAR, guess, settings, grid=TimeGrid.uniform(steps))


@pytest.mark.parametrize("weight", [1.0, 0.01])
@pytest.mark.parametrize("scene", ["oblique", "vertical", "parallel"])
def test_straight_lines_are_solved(scene, weight):
    problem = line(scene, weight=weight)
    report = Stagewise().solve_stages(problem)
    assert report.status.success, report.attempts
    assert report.violation < 1e-7
    assert report.attempts[0].start == "given"
    assert report.iterations == sum(attempt.iterations for attempt in report.attempts)
    body = transform(CAR.parts[0].polygon.vertices, report.states[1:, :3])
    for first, last in zip(problem.obstacle_first[:-1], problem.obstacle_first[1:], strict=True):
        assert best_line(body, problem.obstacle_vertices[first:last]).clearance.min() >= 0.002 - 1e-6


def test_the_report_says_what_was_used():
    problem = line()
    plain = Stagewise(robust=False).solve_stages(problem)
    assert [attempt.start for attempt in plain.attempts] == ["given"]
    assert not plain.status.success
    robust = Stagewise().solve_stages(problem)
    assert robust.attempts[-1].start in robust.note
    assert robust.to_dict()["attempts"][-1]["status"] == "SOLVED"
    again = Stagewise().solve_stages(problem)
    np.testing.assert_array_equal(again.x, robust.x)


def test_the_point_starts_the_next_solve_of_the_given_problem():
    problem = line()
    report = Stagewise().solve_stages(problem)
    warm = Stagewise(robust=False, initial_barrier=1e-6).solve_stages(problem, warm=report.point)
    assert warm.status.success
    assert warm.objective == pytest.approx(report.objective, rel=1e-6)


def test_limits_hold_over_all_attempts():
    goal = builtin("vertical").goal
    problem = line(boxes=[(goal[0] - 1, goal[0] + 1, goal[1] - 1, goal[1] + 1)])
    report = Stagewise().solve_stages(problem)
    assert report.status is SolveStatus.INFEASIBLE
    assert report.iterations <= Stagewise().max_iterations
    few = Stagewise(max_iterations=50).solve_stages(problem)
    assert not few.status.success
    assert few.iterations <= 50
    seen = []
    stopped = Stagewise().solve_stages(problem, callback=lambda news: seen.append(news) or len(seen) < 3)
    assert stopped.status is SolveStatus.STOPPED
    assert len(seen) == 3


def test_ways_are_sound_starts_without_obstacles():
    problem = line(formulation=SweptUnitNormalLine())
    found = list(ways(problem))
    assert len({way.name for way in found}) == len(found) > 3
    for way in found:
        assert not len(way.problem.pairs)
        np.testing.assert_array_equal(way.problem.states[[0, -1]], problem.states[[0, -1]])
        assert (way.problem.states >= problem.state_low).all()
        assert (way.problem.states <= problem.state_high).all()
        assert way.problem.time_weight <= problem.time_weight
    np.testing.assert_array_equal(bent(problem, 1).states, bent(problem, 1).states)
    assert not np.array_equal(bent(problem, 1).states, bent(problem, 2).states)
    assert gentle(problem).time_weight < problem.time_weight


def test_rolling_gives_the_speed_of_the_poses():
    problem = without_pairs(line())
    ahead = np.zeros((21, 5))
    ahead[:, 0] = np.linspace(0, 10, 21)
    v = rolling(problem.replaced(states=ahead, final_time=20.0)).states[1:-1, 3]
    assert v == pytest.approx(0.5)
    assert rolling(problem.replaced(states=-ahead, final_time=20.0)).states[1:-1, 3] == pytest.approx(-0.5)
    assert np.abs(rolling(problem.replaced(states=100 * ahead)).states[:, 3]).max() <= problem.state_high[3]


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e300])
def test_useless_numbers_are_not_tried_again(bad):
    problem = line()
    states = problem.states.copy()
    states[4, 1] = bad
    assert not can_start_again(problem.replaced(states=states))
    assert len(Stagewise().solve_stages(problem.replaced(states=states)).attempts) == 1


@pytest.mark.parametrize("formulation", [SeparatingLine(), SweptUnitNormalLine()])
def test_closed_form_lines_separate_where_it_can_be(formulation):
    problem = line(formulation=formulation)
    again = with_states(problem, problem.states, problem.inputs, problem.final_time)
    lines, origins = again.lines, again.pair_origins
    np.testing.assert_array_equal(lines, problem.lines)
    n = np.column_stack([np.cos(lines[:, 0]), np.sin(lines[:, 0])])
    assert (n * origins).sum(axis=1) == pytest.approx(lines[:, 1], abs=1e-9)
    checked = 0
    for (k, _, obstacle), normal, offset in zip(problem.pairs, n, lines[:, 1], strict=True):
        body = transform(CAR.parts[0].polygon.vertices, problem.states[k : k + 2, :3])
        first, last = problem.obstacle_first[obstacle : obstacle + 2]
        gap = best_line(body, problem.obstacle_vertices[first:last]).clearance
        if gap.min() > 0.5:
            assert (problem.obstacle_vertices[first:last] @ normal <= offset).all()
            assert (body[1] @ normal >= offset).all()
            checked += 1
    assert checked > 5
    elsewhere = with_states(problem, problem.states + np.eye(5)[0], problem.inputs, 30.0)
    assert elsewhere.final_time == 30.0
    assert not np.array_equal(elsewhere.lines, lines)
