"""Soft pairs: exact where there is a way, true depths where there is none, and what becomes of bad penalties."""

import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.formulations import SoftSweptUnitNormalLine, SoftUnitNormalLine, SweptUnitNormalLine, UnitNormalLine
from tightspot.geometry import ConvexPolygon, clearance, transform
from tightspot.guesses import HybridAStar, LinearInterpolation
from tightspot.scenarios import Obstacle, Scenario
from tightspot.scenarios.library import builtin
from tightspot.solvers import Ipopt, SolveStatus, Stagewise, WarmStart
from tightspot.transcription import Objective, Settings, TimeGrid, stage_problem, transcribe
from tightspot.vehicles import vehicle

CAR = vehicle("paper")
MARGIN = 0.05
TWINS = [(UnitNormalLine, SoftUnitNormalLine), (SweptUnitNormalLine, SoftSweptUnitNormalLine)]


def box(name, x_min, x_max, y_min, y_max):
    return Obstacle(name, ConvexPolygon.rectangle(x_min, x_max, y_min, y_max).vertices)


def corridor(*obstacles):
    workspace = ConvexPolygon.rectangle(-3, 20, -3, 3)
    ends = {"start": [0, 0, 0, 0, 0], "goal": [14, 0, 0, 0, 0]}
    return Scenario(name="corridor", workspace=workspace, obstacles=obstacles, vehicle="paper", **ends)


def blocked(gap=1.9):
    """Too narrow by 0.2 m for a car of 2.1 m."""
    return corridor(box("left", 6, 8, gap / 2, 3), box("right", 6, 8, -3, -gap / 2))


def arguments(scenario, member, guess=None, **settings):
    found = (guess or LinearInterpolation()).make(scenario, CAR, margin=MARGIN).trajectory
    return (scenario, CAR, found, Settings(Objective(), member, **{"margin": MARGIN} | settings))


@pytest.mark.parametrize(("hard", "soft"), TWINS)
@pytest.mark.parametrize("scene", ["vertical", "oblique"])
def test_where_there_is_a_way_a_large_weight_costs_nothing(hard, soft, scene):
    grid = TimeGrid.uniform(30)
    given = [arguments(builtin(scene), member(), HybridAStar(), penalty_weight=1000.0) for member in (hard, soft)]
    wanted, report = (Stagewise(robust=False).solve_stages(stage_problem(*each, grid=grid)) for each in given)
    assert wanted.status.success
    assert report.status.success
    assert report.objective == pytest.approx(wanted.objective, rel=1e-5)
    np.testing.assert_allclose(report.penetrations, 0.0, atol=1e-6)
    np.testing.assert_allclose(report.states, wanted.states, atol=1e-3)
    assert not wanted.penetrations.any()


def test_penetrations_are_what_the_clearance_lacks():
    scenario = blocked()
    problem = stage_problem(*arguments(scenario, SoftUnitNormalLine()), grid=TimeGrid.uniform(30))
    report = Stagewise().solve_stages(problem)
    assert report.status.success
    knots = report.pairs[:, 0] + 1
    body = transform(CAR.parts[0].polygon.vertices, report.states[knots, :3])
    lacking = np.array(
        [
            MARGIN - float(clearance(V, scenario.obstacle_parts[j][1].vertices))
            for V, j in zip(body, report.pairs[:, 2], strict=True)
        ]
    )
    inner = knots < 30
    np.testing.assert_allclose(report.penetrations[inner], np.maximum(0.0, lacking)[inner], atol=1e-5)
    both = [report.penetrations[report.pairs[:, 2] == j].max() for j in (0, 1)]
    assert sum(both) == pytest.approx(np.ptp(CAR.parts[0].polygon.vertices[:, 1]) - 1.9 + 2 * MARGIN, abs=0.02)


def test_the_solution_is_one_of_the_symbolic_program():
    given, grid = arguments(blocked(), SoftUnitNormalLine()), TimeGrid.uniform(20)
    report = Stagewise().solve_stages(stage_problem(*given, grid=grid))
    program = transcribe(*given, grid=grid)
    assert report.status.success
    assert program.nlp.violation(report.g).max() < 1e-7
    theirs = Ipopt().solve(program.nlp, warm=WarmStart(report.x, report.lam_x, report.lam_g))
    assert theirs.status.success
    assert theirs.objective == pytest.approx(report.objective, rel=1e-4)


def test_some_pairs_may_give_way_and_others_not():
    scenario = corridor(box("curtain", 6.5, 6.9, -3, 3), box("post", 9.5, 10.0, -3.0, -0.9))
    problem = stage_problem(*arguments(scenario, UnitNormalLine()), grid=TimeGrid.uniform(30))
    penalties = np.where((problem.pairs[:, 2] == 0)[:, None], [20.0, 1.0], np.nan)
    report = Stagewise().solve_stages(problem.softened(penalties))
    assert report.status.success
    curtain = problem.pairs[:, 2] == 0
    assert report.penetrations[curtain].max() > 0.5
    assert not report.penetrations[~curtain].any()
    body = transform(CAR.parts[0].polygon.vertices, report.states[1:-1, :3])
    assert clearance(body, scenario.obstacle_parts[1][1].vertices).min() >= MARGIN - 1e-6


def test_coincident_obstacles_share_what_must_give_way():
    wall = (6.5, 6.9, -3, 3)
    once, twice = (
        stage_problem(*arguments(corridor(*walls), SoftUnitNormalLine()), grid=TimeGrid.uniform(20))
        for walls in ([box("wall", *wall)], [box("wall", *wall), box("again", *wall)])
    )
    one, two = (Stagewise().solve_stages(problem) for problem in (once, twice))
    assert one.status.success
    assert two.status.success
    assert two.penetrations.max() > 0.5


def test_what_the_report_says_when_there_is_no_way():
    problem = stage_problem(*arguments(blocked(), SweptUnitNormalLine()), grid=TimeGrid.uniform(30))
    report = Stagewise().solve_stages(problem)
    assert report.status is SolveStatus.INFEASIBLE
    assert "Locally infeasible" in report.note
    assert "part 0 against obstacle part" in report.note
    assert report.least is not None
    assert report.least.penetrations.max() > 0.05
    assert any(attempt.start.endswith("soft obstacles") for attempt in report.attempts)
    assert report.iterations == sum(attempt.iterations for attempt in report.attempts) <= Stagewise().max_iterations
    assert Stagewise().solve_stages(problem).note == report.note


def test_a_penetration_must_cost_something():
    with pytest.raises(InputError, match="penalty_weight: 0 leaves the penetrations"):
        stage_problem(*arguments(blocked(), SoftUnitNormalLine(), penalty_weight=0.0), grid=TimeGrid.uniform(5))
    with pytest.raises(InputError, match="penalty_weight: nan"):
        arguments(blocked(), SoftUnitNormalLine(), penalty_weight=np.nan)
    problem = stage_problem(*arguments(blocked(), SoftUnitNormalLine()), grid=TimeGrid.uniform(5))
    for bad in ([0.0, 0.0], [-1.0, 1.0], [1.0, np.nan], [np.inf, 0.0]):
        with pytest.raises(InputError, match="pair_penalties"):
            Stagewise().solve_stages(problem.softened(np.tile(bad, (len(problem.pairs), 1))))
    with pytest.raises(InputError, match="pair_penalties"):
        Stagewise().solve_stages(problem.softened(np.ones((1, 2))))
