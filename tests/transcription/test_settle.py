"""Planning among obstacles that move: same optima as IPOPT, replays among the true motions, and t_f that settles."""

import numpy as np
import pytest
import shapely
from tests.solvers.test_stagewise import kkt_residuals

from tightspot.errors import InputError
from tightspot.formulations import NormalisedFarkasDual, SeparatingLine, SweptLine, SweptUnitNormalLine, UnitNormalLine
from tightspot.geometry import ConvexPolygon
from tightspot.geometry.transforms import transform
from tightspot.guesses import LinearInterpolation
from tightspot.scenarios import Obstacle, Scenario
from tightspot.solvers import Fatrop, Ipopt, SolveStatus, Stagewise, WarmStart
from tightspot.transcription import (
    MovingObstacle,
    ObstacleMotion,
    Settings,
    TimedPoses,
    TimeGrid,
    solve_moving,
    stage_problem,
    transcribe,
)
from tightspot.vehicles import vehicle
from tightspot.verification import replay

CAR = vehicle("paper")
BODY = ConvexPolygon.rectangle(-1.0, 3.5, -0.9, 0.9)
MARGIN = 0.1
GRID = TimeGrid.uniform(16)


def street(**changes):
    """A lane that is too narrow to go round anything in it."""
    arguments = {
        "name": "street",
        "workspace": ConvexPolygon.rectangle(-3.0, 20.0, -2.2, 2.2),
        "obstacles": (),
        "start": [0, 0, 0, 0, 0],
        "goal": [14, 0, 0, 0, 0],
    }
    return Scenario(**arguments | changes)


SCENE = street()
GUESS = LinearInterpolation().make(SCENE, CAR, margin=0.0).trajectory


def leaving(t):
    """Stands across the lane and drives off it, faster and faster, turning a little: there is but one way, to wait."""
    return np.column_stack([np.full_like(t, 8.0), -1 + 0.02 * t**2, np.pi / 2 + 0.02 * t])


def weaving(t):
    return np.column_stack([8 + np.sin(0.4 * t), -12 + 0.9 * t, np.pi / 2 + 0.4 * np.sin(0.3 * t)])


def steady(t):
    return np.column_stack([np.full_like(t, 8.0), -9 + 0.9 * t, np.full_like(t, np.pi / 2)])


def solved(motion, formulation=None, *, solver=None, grid=GRID, guess=GUESS, scene=SCENE, **changes):
    settings = Settings(formulation=formulation or UnitNormalLine(), margin=MARGIN, **changes)
    moving = [MovingObstacle(BODY, motion)]
    return solve_moving(scene, CAR, guess, settings, moving, grid=grid, solver=solver)


def distances(solution, motion, t, states):
    """Of car and obstacle at times t, by shapely, the obstacle where it really is."""
    body, other = CAR.parts[0].polygon.vertices, BODY.vertices
    mine = shapely.polygons(transform(body, states[:, :3]))
    theirs = shapely.polygons(transform(other, motion(t)))
    return shapely.distance(mine, theirs)


@pytest.mark.parametrize("member", [UnitNormalLine, SeparatingLine, SweptLine, SweptUnitNormalLine])
@pytest.mark.parametrize("motion", [leaving, weaving, steady])
def test_settles_and_keeps_the_margin(motion, member):
    solution = solved(motion, member())
    assert solution.success, solution.sentence
    assert abs(solution.trajectory.duration - solution.final_times[-1]) <= 1e-4
    assert len(solution.final_times) <= 12
    at_knots = distances(solution, motion, solution.trajectory.t, solution.trajectory.states)
    assert at_knots.min() >= MARGIN - 1e-6
    assert solution.motions[0].poses == pytest.approx(motion(solution.final_times[-1] * GRID.fractions))


@pytest.mark.parametrize("motion", [leaving, weaving])
def test_the_swept_line_keeps_the_margin_between_the_knots(motion):
    """The inputs replayed, 50 times an interval; the obstacle by its own function of time."""
    solution = solved(motion, SweptLine())
    assert solution.success, solution.sentence
    t = np.linspace(0.0, solution.trajectory.duration, 50 * GRID.steps + 1)
    states = replay(CAR, solution.trajectory).at(t)
    assert distances(solution, motion, t, states).min() >= MARGIN - 1e-3


def test_the_swept_line_holds_between_the_knots_against_what_turns_and_weaves():
    """Random obstacles in a wide yard, replayed 100 times an interval; what is solved keeps the margin at all times."""
    yard = street(workspace=ConvexPolygon.rectangle(-4.0, 20.0, -7.0, 7.0))
    solved_ones = 0
    for seed in range(12):
        rng = np.random.default_rng(seed)
        (x, y, theta), (sway, speed, turn) = rng.uniform([6, -6, -2], [9, 2, 2]), rng.uniform([-0.6, 0, -0.4], 0.5)

        def motion(t, x=x, y=y, theta=theta, sway=sway, speed=speed, turn=turn):
            return np.column_stack([x + sway * np.sin(0.4 * t), y + speed * t, theta + turn * t])

        solution = solved(motion, SweptUnitNormalLine(), solver=Stagewise(), scene=yard)
        if not solution.success:
            continue
        solved_ones += 1
        t = np.linspace(0.0, solution.trajectory.duration, 100 * GRID.steps + 1)
        states = replay(CAR, solution.trajectory).at(t)
        assert distances(solution, motion, t, states).min() >= MARGIN - 1e-3
    assert solved_ones >= 6


@pytest.mark.parametrize("final_time", [(0.1, 1000.0), 24.0])
def test_as_good_as_ipopt_from_each_others_solutions(final_time):
    """Lines and multipliers made anew, t_f free or fixed: neither solver turns the other's optimum into a worse one."""
    settings = {"final_time": final_time}
    ours, theirs = solved(leaving, **settings), solved(leaving, **settings, solver=Ipopt())
    for one, other in ((ours, Ipopt()), (theirs, Stagewise())):
        assert one.success, one.sentence
        again = solved(leaving, **settings, solver=other, guess=one.trajectory)
        assert again.success, again.sentence
        assert again.report.objective <= 1.01 * one.report.objective


@pytest.mark.parametrize("member", [UnitNormalLine, SeparatingLine, SweptLine])
def test_satisfies_the_programs_optimality_conditions_and_ipopt_stays(member):
    solution = solved(weaving, member())
    assert solution.success, solution.sentence
    settings = Settings(formulation=member(), margin=MARGIN)
    nlp = transcribe(SCENE, CAR, GUESS, settings, grid=GRID, motions=solution.motions).nlp
    for residual in kkt_residuals(nlp, solution.report):
        assert residual < 1e-6
    report = solution.report
    again = Ipopt().solve(nlp, warm=WarmStart(report.x, report.lam_x, report.lam_g))
    assert again.status.success
    assert again.objective == pytest.approx(report.objective, rel=1e-6)


def test_settled_is_optimal_among_fixed_final_times():
    """With t_f fixed the tangents are the motion itself; next to the settled t_f no other is better."""
    solution = solved(leaving)
    assert solution.success, solution.sentence
    best, near = solution.trajectory.duration, []
    for final_time in (best - 0.3, best - 0.03, best, best + 0.03, best + 0.3):
        fixed = solved(leaving, final_time=final_time, guess=solution.trajectory)
        assert len(fixed.final_times) == 1
        near.append(fixed.report.objective if fixed.success else np.inf)
    assert near[2] == pytest.approx(solution.report.objective, rel=1e-6)
    assert min(near) >= near[2] - 1e-7
    assert min(near[0], near[4]) > near[2] + 1e-4


def test_a_steady_motion_settles_at_once():
    """Its tangent is the motion: the second solve only finds that out."""
    solution = solved(steady)
    assert solution.success, solution.sentence
    assert len(solution.final_times) == 2
    assert "2 solves" in solution.sentence


def test_a_table_of_poses_moves_like_the_function_it_was_taken_from():
    t = np.linspace(0.0, 60.0, 241)
    one, two = solved(TimedPoses(t, leaving(t))), solved(leaving)
    assert one.success, one.sentence
    assert one.trajectory.duration == pytest.approx(two.trajectory.duration, abs=1e-2)


def test_beside_standing_obstacles_and_for_any_formulation_and_solver():
    """The duals see the moved geometry, too; fatrop takes the rows' dependence on t_f."""
    wall = Obstacle("kerb", np.array([(4.0, 1.9), (9.0, 1.9), (9.0, 3.0), (4.0, 3.0)]))
    scene = street(obstacles=(wall,))
    for formulation, solver in ((NormalisedFarkasDual(), Ipopt()), (UnitNormalLine(), Fatrop())):
        solution = solved(leaving, formulation, solver=solver, scene=scene, final_time=24.0)
        assert solution.success, solution.sentence
        states = solution.trajectory.states
        assert distances(solution, leaving, solution.trajectory.t, states).min() >= MARGIN - 1e-6
    assert any("against moving" in block.detail for block in _blocks(scene))


def _blocks(scene):
    motion = MovingObstacle(BODY, leaving).on(GRID, 20.0)
    return transcribe(scene, CAR, GUESS, Settings(), grid=GRID, motions=[motion]).nlp.blocks


@pytest.mark.parametrize("member", [UnitNormalLine, SweptLine])
def test_an_obstacle_that_comes_onto_the_goal_is_never_solved(member):
    def onto_goal(t):
        return np.column_stack([np.full_like(t, 14.0), np.zeros_like(t), np.full_like(t, np.pi / 2)])

    def jumping(t):
        return np.column_stack([np.where(t > 1.0, 14.0, 99.0), np.zeros_like(t), np.zeros_like(t)])

    for motion in (onto_goal, jumping):
        solution = solved(motion, member(), solver=Stagewise(time_limit=2.0))
        assert not solution.success
        assert solution.trajectory is None
        assert solution.sentence == solution.report.status.sentence


def test_falls_back_to_ipopt_and_says_so():
    """A gate that closes: the guess is in it when it does, and whoever is to pass must have passed before."""
    gate = TimedPoses([0, 18, 20], [(8, -18, np.pi / 2), (8, -2, np.pi / 2), (8, -1, np.pi / 2)])
    given = solved(gate, SweptLine(), solver=Stagewise(time_limit=2.0))
    solution = solved(gate, SweptLine())
    assert solution.success, solution.sentence
    assert solution.report.solver == ("stagewise" if given.success else "ipopt")
    assert given.success or "stagewise came to nothing" in solution.report.note
    assert distances(solution, gate, solution.trajectory.t, solution.trajectory.states).min() >= MARGIN - 1e-6
    passed = solution.trajectory.t[np.argmax(solution.trajectory.states[:, 0] > 10.0)]
    assert passed < 20.0


def test_what_does_not_settle_says_so():
    solution = solve_moving(
        SCENE, CAR, GUESS, Settings(formulation=UnitNormalLine(), margin=MARGIN),
        [MovingObstacle(BODY, leaving)], grid=GRID, max_solves=1, solver=Stagewise(),
    )  # fmt: skip
    assert not solution.success
    assert "did not settle in 1 solves" in solution.sentence


@pytest.mark.parametrize(("changes", "sentence"), [({"tolerance": np.nan}, "tolerance"), ({"max_solves": 0}, "solves")])
def test_bad_limits_are_refused(changes, sentence):
    with pytest.raises(InputError, match=sentence):
        solve_moving(SCENE, CAR, GUESS, Settings(), [], grid=GRID, **changes)


def test_without_moving_obstacles_it_is_one_program():
    solution = solve_moving(SCENE, CAR, GUESS, Settings(), [], grid=GRID)
    report = Stagewise().solve_stages(stage_problem(SCENE, CAR, GUESS, Settings(), grid=GRID))
    assert solution.trajectory.duration == pytest.approx(report.final_time)


@pytest.mark.parametrize("seed", range(12))
def test_whatever_moves_how_it_ends_in_a_status_that_is_true(seed):
    """Random motions, some absurd, some onto the car; what is called solved is apart at the knots."""
    rng = np.random.default_rng(seed)
    member = (UnitNormalLine, SweptUnitNormalLine)[seed % 2]
    scale = 10.0 ** rng.integers(-1, 3) if seed % 4 else 1e9
    motions = [
        ObstacleMotion(
            BODY,
            rng.normal([7.0, 0.0, 0.0], scale, (GRID.steps + 1, 3)),
            rng.normal(0.0, scale, (GRID.steps + 1, 3)),
            float(rng.uniform(1.0, 40.0)),
        )
        for _ in range(rng.integers(1, 3))
    ]
    time_bounds = (1e-6, 1e-6) if seed == 3 else (0.1, 100.0)
    settings = Settings(formulation=member(), margin=0.02, final_time=time_bounds)
    problem = stage_problem(SCENE, CAR, GUESS, settings, grid=GRID, motions=motions)
    report = Stagewise(max_iterations=150, time_limit=3.0).solve_stages(problem)
    assert isinstance(report.status, SolveStatus)
    if not report.status.success:
        return
    last = np.cumsum(problem.pieces + 1) - 1
    for frames in problem.frames(report.final_time):
        theirs = shapely.polygons(transform(BODY.vertices, frames[last]))
        mine = shapely.polygons(transform(CAR.parts[0].polygon.vertices, report.states[1:, :3]))
        assert shapely.distance(mine, theirs).min() >= 0.02 - 1e-5
