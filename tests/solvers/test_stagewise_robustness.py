"""Whatever the stagewise solver is given, it ends in a status within its limits, and "solved" means it."""

import threading
import time
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.formulations import SweptUnitNormalLine, UnitNormalLine
from tightspot.geometry import ConvexPolygon, clearance, transform
from tightspot.guesses import LinearInterpolation
from tightspot.scenarios import Obstacle, Scenario
from tightspot.solvers.stage_core import core_solver
from tightspot.solvers.stagewise import Stagewise
from tightspot.transcription import Settings, TimeGrid
from tightspot.transcription.stage_problem import stage_problem
from tightspot.vehicles import vehicle

CAR = vehicle("paper")


def problem(*boxes, goal=(9, 1, 0, 0, 0), steps=12, formulation=None, **settings):
    scenario = Scenario(
        name="field",
        workspace=ConvexPolygon.rectangle(-10, 25, -10, 10),
        obstacles=tuple(Obstacle(f"box {i}", ConvexPolygon.rectangle(*box).vertices) for i, box in enumerate(boxes)),
        start=[0, 0, 0, 0, 0],
        goal=list(goal),
    )
    guess = LinearInterpolation().make(scenario, CAR, margin=0.0).trajectory
    states = guess.states.copy()
    states[1:-1, 3] = 0.7
    guess = replace(guess, states=states)
    arguments = {"formulation": formulation or UnitNormalLine(), "margin": 0.05, "substeps": 2} | settings
    return stage_problem(scenario, CAR, guess, Settings(**arguments), grid=TimeGrid.uniform(steps))


def violation(given, report):
    """Of a knots-only problem's rows, by geometry: least clearance of the body at the knots."""
    body = transform(CAR.parts[0].polygon.vertices, report.states[1:, :3])
    first = given.obstacle_first
    obstacles = [given.obstacle_vertices[a:b] for a, b in pairwise(first)]
    return min((float(clearance(body, obstacle).min()) for obstacle in obstacles), default=np.inf)


@pytest.mark.parametrize("seed", range(12))
def test_random_fields(seed):
    rng = np.random.default_rng(seed)
    corners = [(rng.uniform(-8, 18), rng.uniform(-8, 8), rng.uniform(0.1, 4), rng.uniform(0.1, 4)) for _ in range(4)]
    boxes = [(x, x + w, y, y + h) for x, y, w, h in corners]
    given = problem(*boxes, goal=(rng.uniform(4, 12), rng.uniform(-2, 2), rng.uniform(-0.3, 0.3), 0, 0))
    report = Stagewise(max_iterations=150, time_limit=5).solve_stages(given)
    assert report.iterations <= 150
    if report.status.success:
        assert report.violation <= 1e-6
        assert violation(given, report) >= 0.05 - 1e-6


def test_the_impossible_is_not_solved():
    across = problem((5, 6, -10, 10), final_time=(0.1, 30.0))  # with longer steps the knots could jump over it
    covered = problem((7, 14, -1, 3))
    hurried = problem(final_time=(0.1, 2.0))
    for given in (across, covered, hurried):
        report = Stagewise(max_iterations=200, time_limit=5).solve_stages(given)
        assert not report.status.success
        assert report.violation > 1e-4
        assert report.worst


def test_coincident_obstacles_and_points():
    one = problem((4, 7, -6, -1.5))
    three = problem((4, 7, -6, -1.5), (4, 7, -6, -1.5), (4, 7, -6, -1.5))
    reports = [Stagewise().solve_stages(given) for given in (one, three)]
    assert all(report.status.success for report in reports)
    assert reports[1].objective == pytest.approx(reports[0].objective, rel=1e-6)


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e300])
def test_bad_numbers(bad):
    given = problem((4, 7, -6, -1.5))
    states = given.states.copy()
    states[3, 1] = bad
    assert not Stagewise(max_iterations=50).solve_stages(given.replaced(states=states)).status.success
    vertices = given.obstacle_vertices.copy()
    vertices[0, 0] = bad
    spoiled = given.replaced(obstacle_vertices=vertices)
    if np.isfinite(bad):
        assert Stagewise(max_iterations=50).solve_stages(spoiled).iterations <= 50
    else:
        with pytest.raises(InputError, match="obstacle_vertices"):
            Stagewise().solve_stages(spoiled)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("widths", np.zeros(0)),
        ("widths", np.full(12, -1.0)),
        ("pieces", np.zeros(12, np.int64)),
        ("pairs", np.array([[0, 0, 7]])),
        ("pairs", np.zeros((12, 3), np.int64) - 1),
        ("part_first", np.array([0, 400])),
        ("obstacle_first", np.array([0, 2**40])),
        ("goal", np.zeros(4)),
        ("pair_demands", np.zeros((3, 2))),
        ("parameters", np.zeros(1)),
        ("penetrations", np.zeros(3)),
        ("input_low", np.ones(2)),
        ("wall_lines", np.zeros((2, 3))),
        ("model", "spaceship"),
    ],
)
def test_arrays_that_do_not_fit_are_named(name, value):
    with pytest.raises(InputError):
        Stagewise().solve_stages(problem((4, 7, -6, -1.5)).replaced(**{name: value}))


def test_arrays_of_other_layouts_and_types_say_the_same():
    given = problem((4, 7, -6, -1.5))
    wanted = Stagewise().solve_stages(given)
    states, inputs = np.asfortranarray(given.states), np.repeat(given.inputs, 2, axis=1)[:, ::2]
    others = given.replaced(
        pairs=np.asfortranarray(given.pairs), pieces=given.pieces.astype(np.int32), states=states, inputs=inputs,
        pair_sides=np.repeat(given.pair_sides, 2, axis=0)[::2],
    )  # fmt: skip
    found = Stagewise().solve_stages(others)
    assert (found.status, found.iterations) == (wanted.status, wanted.iterations)
    assert (found.point.v == wanted.point.v).all()
    for name in ("widths", "time_low", "time_scaled"):
        with pytest.raises(InputError, match=f"{name} is not a"):
            core_solver(given.replaced(**{name: "text"}))


def test_limits_callback_and_exceptions():
    given = problem((4, 7, -6, -1.5))
    assert Stagewise(max_iterations=2).solve_stages(given).status.name == "ITERATION_LIMIT"
    seen = []
    report = Stagewise().solve_stages(given, callback=lambda news: seen.append(news) or len(seen) < 4)
    assert report.status.name == "STOPPED"
    assert [news.number for news in seen] == [0, 1, 2, 3]
    assert report.log.shape == (4, 10)

    def fail(news):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        Stagewise().solve_stages(given, callback=fail)
    for bad in (
        {"tolerance": 0.0},
        {"time_limit": -1.0},
        {"max_iterations": -1},
        {"initial_barrier": np.nan},
        {"slack_push": -1.0},
    ):
        with pytest.raises(InputError, match=next(iter(bad))):
            Stagewise(**bad)


def test_time_limit_is_kept():
    boxes = [(x, x + 0.4, y, y + 0.4) for x in np.linspace(-8, 20, 12) for y in (-7, -5, 5, 7)]
    given = problem(*boxes, steps=200, formulation=SweptUnitNormalLine(), poses=4)
    began = time.perf_counter()
    report = Stagewise(time_limit=0.05, tolerance=1e-30).solve_stages(given)
    assert report.status.name in ("TIME_LIMIT", "NUMERICAL", "INFEASIBLE")
    assert time.perf_counter() - began < 10


def test_deterministic_and_the_same_on_many_threads():
    given = [problem((4, 7, -6, -1.5 - 0.1 * i)) for i in range(6)]
    alone = [Stagewise().solve_stages(each) for each in given]
    together = Stagewise().solve_many(given, threads=3)
    for a, b in zip(alone, together, strict=True):
        assert a.status is b.status
        np.testing.assert_array_equal(a.x, b.x)
    assert threading.active_count() < 10
    with pytest.raises(InputError, match="threads"):
        Stagewise().solve_many(given, threads=0)


def test_warm_start_from_a_nearby_solution():
    given = problem((4, 7, -6, -1.5))
    cold = Stagewise().solve_stages(given)
    moved = given.replaced(start=given.start + np.array([0.05, 0.02, 0.01, 0, 0]))
    warm = Stagewise(initial_barrier=1e-4).solve_stages(moved, warm=cold.point)
    again = Stagewise().solve_stages(moved)
    assert warm.status.success
    assert warm.objective == pytest.approx(again.objective, rel=1e-6)
    assert warm.iterations < again.iterations
    with pytest.raises(InputError):
        Stagewise().solve_stages(problem(), warm=cold.point)


@pytest.mark.parametrize("distance", [0.02, 0.1])
def test_warm_starts_save_most_iterations(distance):
    given = problem((4, 7, -6, -1.5))
    cold = Stagewise().solve_stages(given)
    rng = np.random.default_rng(0)
    warm, anew = [], []
    for _ in range(20):
        angle = rng.uniform(0, 2 * np.pi)
        shift = [distance * np.cos(angle), distance * np.sin(angle), rng.uniform(-1, 1) * distance / 3, 0, 0]
        moved = given.replaced(start=given.start + shift)
        warm.append(Stagewise().solve_stages(moved, warm=cold.point))
        anew.append(Stagewise().solve_stages(moved))
        assert warm[-1].status.success
        assert warm[-1].attempts[0].start == "warm"
        assert violation(moved, warm[-1]) >= 0.05 - 1e-6
    assert 2 * np.median([one.iterations for one in warm]) <= np.median([one.iterations for one in anew])


def test_a_core_serves_again_when_start_and_goal_move():
    given = problem((4, 7, -6, -1.5))
    core = core_solver(given)
    cold = Stagewise().solve_stages(given, core=core)
    np.testing.assert_array_equal(cold.x, Stagewise().solve_stages(given).x)
    moved = given.replaced(start=given.start + np.array([0.05, 0.02, 0.01, 0, 0]), goal=given.goal + 0.01)
    again, new = (Stagewise().solve_stages(moved, warm=cold.point, core=kept) for kept in (core, None))
    assert again.iterations == new.iterations
    np.testing.assert_array_equal(again.x, new.x)
    np.testing.assert_allclose(again.states[0], moved.start)
    free = given.start.copy()
    free[4] = np.nan
    with pytest.raises(InputError, match="core"):
        Stagewise().solve_stages(given.replaced(start=free), core=core)


def test_a_hopeless_warm_start_falls_back_to_the_given_one():
    given = problem((4, 7, -6, -1.5))
    cold = Stagewise().solve_stages(given)
    nonsense = replace(cold.point, v=np.full_like(cold.point.v, np.nan))
    report = Stagewise().solve_stages(given, warm=nonsense)
    assert report.status.success
    assert [attempt.start for attempt in report.attempts] == ["warm", "given"]
    assert report.iterations == sum(attempt.iterations for attempt in report.attempts)
    assert "earlier solution" in report.note
    assert not Stagewise(robust=False).solve_stages(given, warm=nonsense).status.success
