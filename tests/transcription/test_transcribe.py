"""The nonlinear program: counts, structure, and what its rows and objective say."""

import casadi as ca
import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.formulations import FORMULATIONS, SeparatingLine, SweptLine, SweptUnitNormalLine, UnitNormalLine
from tightspot.geometry import ConvexPolygon, clearance, transform
from tightspot.guesses import LinearInterpolation
from tightspot.scenarios import Obstacle, Scenario
from tightspot.scenarios.library import builtin
from tightspot.trajectory import Trajectory
from tightspot.transcription import EnergyForm, Objective, Settings, TimeGrid, transcribe
from tightspot.vehicles import vehicle

CAR = vehicle("paper")
MEMBERS = [member() for member in FORMULATIONS.values()]


def scene(**changes):
    """A box with a triangle and a square in it: different numbers of corners."""
    arguments = {
        "name": "small",
        "workspace": ConvexPolygon.rectangle(-6, 12, -6, 6),
        "obstacles": (
            Obstacle("triangle", np.array([(3, 3), (6, 3), (5, 5)])),
            Obstacle("square", np.array([(7, -5), (9, -5), (9, -3), (7, -3)])),
        ),
        "start": [0, 0, 0, 0, 0],
        "goal": [6, 0.5, 0.2, 0, 0],
    }
    return Scenario(**arguments | changes)


def make(scenario=None, settings=None, *, steps=4, car=CAR, guess=None, **arguments):
    scenario = scenario or scene()
    guess = guess or LinearInterpolation().make(scenario, car, margin=0.0).trajectory
    return transcribe(scenario, car, guess, settings or Settings(), grid=TimeGrid.uniform(steps), **arguments)


def rows_of(nlp, x):
    return np.array(ca.Function("g", [nlp.x, nlp.p], [nlp.g])(x, nlp.p0)).ravel()


def objective_of(nlp, x):
    return float(ca.Function("f", [nlp.x, nlp.p], [nlp.f])(x, nlp.p0))


def by_kind(nlp, kind, knot=None):
    return [block for block in nlp.blocks if block.kind == kind and knot in (None, block.knot)]


def random_point(nlp, rng):
    """Near the starting point, with a final time of seconds."""
    x = nlp.x0 + 0.1 * rng.normal(size=nlp.n_variables)
    x[nlp.shared] = 5.0
    return x


def test_variables_and_rows_of_the_paper_s_scene_are_the_paper_s():
    car, scenario = vehicle("paper-recovered"), builtin("vertical")
    nlp = make(scenario, Settings(formulation=SeparatingLine(), margin=2e-3), steps=20, car=car).nlp
    assert nlp.n_variables == 5 * 21 + 2 * 20 + 1 + 3 * 2 * 20  # VN of Table II
    dynamics, workspace, separation = 5 * 20, 4 * 4 * 20, (4 + 4 + 1) * 2 * 20
    assert nlp.n_rows == dynamics + workspace + separation
    assert sum(block.rows.stop - block.rows.start for block in by_kind(nlp, "separation")) == separation
    # the paper also counts each bound of each variable as a constraint, once
    assert nlp.n_variables + nlp.n_rows + 3 * 2 * 20 == 1166


@pytest.mark.parametrize(("member", "auxiliary", "extra"), [(SeparatingLine(), 3, 1), (UnitNormalLine(), 2, 0)])
def test_counts_with_different_polygons(member, auxiliary, extra):
    nlp = make(settings=Settings(formulation=member), steps=4).nlp
    assert nlp.n_variables == 5 * 5 + 2 * 4 + 1 + auxiliary * 2 * 4
    assert nlp.n_rows == 5 * 4 + 4 * 4 * 4 + ((4 + 3 + extra) + (4 + 4 + extra)) * 4


@pytest.mark.parametrize(("member", "auxiliary", "extra"), [(SweptLine(), 3, 1), (SweptUnitNormalLine(), 2, 0)])
@pytest.mark.parametrize("poses", [(3, 3, 3, 3), (1, 3, 2, 1)])
def test_counts_of_a_line_shared_by_an_interval(member, auxiliary, extra, poses):
    nlp = make(settings=Settings(formulation=member, poses=poses), steps=4).nlp
    assert nlp.n_variables == 5 * 5 + 2 * 4 + 1 + auxiliary * 2 * 4
    standing = sum(poses) + 4  # at both ends of an interval and in between
    workspace = 4 * 4 * (standing - 1)  # the start is given
    assert nlp.n_rows == 5 * 4 + workspace + 2 * 4 * standing + (3 + 4) * 4 + 2 * extra * 4
    same = make(settings=Settings(formulation=member, poses=3), steps=4).nlp
    assert (same.n_rows == nlp.n_rows) == (poses == (3, 3, 3, 3))


@pytest.mark.parametrize("member", MEMBERS, ids=lambda member: member.name)
def test_stages_and_blocks_partition_variables_and_rows(member):
    nlp = make(settings=Settings(formulation=member), car=vehicle("forklift")).nlp
    places = [place for stage in nlp.stages for place in (stage.state, stage.control, stage.auxiliary)]
    assert partition([*places, nlp.shared]) == nlp.n_variables
    assert partition([block.rows for block in nlp.blocks]) == nlp.n_rows
    rows = [place for stage in nlp.stages for place in (stage.path, stage.dynamics)]
    assert partition(sorted(rows, key=lambda place: (place.start, place.stop))) == nlp.n_rows
    assert [stage.dynamics.stop - stage.dynamics.start for stage in nlp.stages] == [5, 5, 5, 5, 0]
    assert [stage.k for stage in nlp.stages] == list(range(5))
    sizes = [stage.control.stop - stage.control.start for stage in nlp.stages]
    assert sizes == [2, 2, 2, 2, 0]


def partition(slices):
    """The end of the range that the slices cover without gap or overlap, in their order."""
    end = 0
    for place in slices:
        assert place.start == end, (place, end)
        end = place.stop
    return end


def test_rows_of_a_stage_touch_only_its_own_and_the_neighbouring_stage():
    nlp = make(settings=Settings(formulation=UnitNormalLine())).nlp
    pattern = np.array(ca.DM(ca.jacobian(nlp.g, nlp.x).sparsity(), 1).full(), bool)
    for stage in nlp.stages:
        own = np.zeros(nlp.n_variables, bool)
        own[stage.state] = own[stage.auxiliary] = own[stage.control] = own[nlp.shared] = True
        assert not pattern[stage.path][:, ~own].any()
        if stage.k < len(nlp.stages) - 1:
            own[nlp.stages[stage.k + 1].state] = True
            assert not pattern[stage.dynamics][:, ~own].any()


@pytest.mark.parametrize("member", MEMBERS, ids=lambda member: member.name)
def test_derivatives_match_central_differences(member):
    rng = np.random.default_rng(5)
    nlp = make(settings=Settings(formulation=member, margin=0.03, objective=Objective(0.5)), steps=3).nlp
    functions = ca.Function("fg", [nlp.x, nlp.p], [nlp.f, nlp.g])
    jacobians = ca.Function("J", [nlp.x, nlp.p], [ca.gradient(nlp.f, nlp.x), ca.jacobian(nlp.g, nlp.x)])
    lam = rng.normal(size=nlp.n_rows)
    lagrangian = nlp.f + ca.dot(ca.DM(lam), nlp.g)
    hessian = ca.Function("H", [nlp.x, nlp.p], [ca.hessian(lagrangian, nlp.x)[0]])
    x, step = random_point(nlp, rng), 1e-5
    directions = rng.normal(size=(6, nlp.n_variables))
    for d in directions / np.linalg.norm(directions, axis=1)[:, None]:
        (f_up, g_up), (f_down, g_down) = functions(x + step * d, nlp.p0), functions(x - step * d, nlp.p0)
        grad, jac = (np.array(value) for value in jacobians(x, nlp.p0))
        assert float(f_up - f_down) / (2 * step) == pytest.approx(grad.ravel() @ d, rel=1e-6, abs=1e-7)
        np.testing.assert_allclose(np.array(g_up - g_down).ravel() / (2 * step), jac @ d, atol=2e-7)
        up, down = (jacobians(x + sign * step * d, nlp.p0) for sign in (1, -1))
        change = [np.array(u - v) / (2 * step) for u, v in zip(up, down, strict=True)]
        expected = change[0].ravel() + change[1].T @ lam
        np.testing.assert_allclose(np.array(hessian(x, nlp.p0)) @ d, expected, atol=2e-6 * (1 + np.abs(expected).max()))


def test_dynamics_rows_vanish_on_an_integrated_trajectory():
    rng = np.random.default_rng(6)
    steps, final_time = 5, 6.0
    inputs = rng.uniform(-0.05, 0.05, (steps, 2))
    states = [np.zeros(5)]
    for control in inputs:
        states.append(finely_integrated(states[-1], control, final_time / steps))
    guess = Trajectory(np.linspace(0, final_time, steps + 1), np.array(states), inputs)
    transcription = make(scene(goal=states[-1]), Settings(formulation=UnitNormalLine()), steps=steps, guess=guess)
    nlp = transcription.nlp
    rows = rows_of(nlp, nlp.x0)
    for block in by_kind(nlp, "dynamics"):
        np.testing.assert_allclose(rows[block.rows], 0.0, atol=1e-9)
    np.testing.assert_allclose(transcription.trajectory(nlp.x0).states, guess.states, atol=1e-14)


def finely_integrated(state, control, duration, count=2000, car=CAR):
    h = duration / count
    for _ in range(count):
        k1 = np.array(car.dynamics(state, control, np))
        k2 = np.array(car.dynamics(state + h * k1, control, np))
        state = state + h / 2 * (k1 + k2)
    return state


def test_a_defect_shows_in_its_own_dynamics_row_only():
    nlp = make(settings=Settings(formulation=UnitNormalLine())).nlp
    before = rows_of(nlp, nlp.x0)
    moved = nlp.x0.copy()
    moved[nlp.stages[2].state.start] += 0.25  # x of knot 2
    change = rows_of(nlp, moved) - before
    assert change[nlp.stages[1].dynamics] == pytest.approx([-0.25, 0, 0, 0, 0], abs=1e-12)
    assert change[nlp.stages[2].dynamics] == pytest.approx([0.25, 0, 0, 0, 0], abs=1e-12)
    assert not change[nlp.stages[0].dynamics].any()


@pytest.mark.parametrize("form", list(EnergyForm))
def test_the_program_s_objective_is_that_of_the_trajectory(form):
    rng = np.random.default_rng(7)
    objective = Objective(0.7, (1.5, 30.0), form)
    transcription = make(settings=Settings(objective=objective))
    x = random_point(transcription.nlp, rng)
    trajectory = transcription.trajectory(x)
    assert objective_of(transcription.nlp, x) == pytest.approx(
        objective.value(trajectory.t, trajectory.inputs), rel=1e-12
    )


def test_workspace_rows_are_the_body_s_distance_outside_w():
    rng = np.random.default_rng(8)
    scenario, settings = scene(), Settings(formulation=UnitNormalLine(), workspace_margin=0.2)
    nlp = make(scenario, settings).nlp
    x = random_point(nlp, rng)
    rows, W = rows_of(nlp, x), scenario.workspace
    for stage in nlp.stages[1:]:
        (block,) = by_kind(nlp, "workspace", stage.k)
        V = transform(CAR.parts[0].polygon.vertices, x[stage.state][:3])
        demanded = 0.0 if stage.k == 4 else 0.2
        expected = (V @ W.A.T - W.b).max() + demanded
        assert rows[block.rows].max() == pytest.approx(expected, abs=1e-12)
        assert (nlp.ubg[block.rows] == 0).all()


def test_margins_demand_what_they_say_at_free_and_at_fixed_poses():
    """At the closed-form start the two sides of a row share what is missing to the margin."""
    guess_states = np.linspace([0, 0, 0, 0, 0], [6, 0.5, 0.2, 0, 0], 5)
    guess = Trajectory(np.linspace(0, 8, 5), guess_states, np.zeros((4, 2)))
    scenario = scene()
    settings = Settings(formulation=UnitNormalLine(), margin=9.0, end_margin=5.0)
    nlp = make(scenario, settings, guess=guess).nlp
    obstacles = [polygon.vertices for _, polygon in scenario.obstacle_parts]
    for k in range(1, 5):
        demanded = 5.0 if k == 4 else 9.0
        V = transform(CAR.parts[0].polygon.vertices, guess_states[k, :3])
        missing = []
        for block in range(0, len(by_kind(nlp, "separation", k)), 2):
            rows = nlp.violation(rows_of(nlp, nlp.x0))
            pair = by_kind(nlp, "separation", k)[block : block + 2]
            missing.append(sum(rows[half.rows].max() for half in pair))
        expected = [demanded - float(clearance(V, O)) for O in obstacles]
        np.testing.assert_allclose(missing, expected, atol=1e-9)


@pytest.mark.parametrize("free", ["start", "goal"])
@pytest.mark.parametrize("member", [UnitNormalLine(), SweptUnitNormalLine()], ids=lambda member: member.name)
def test_a_free_pose_demands_the_full_margin(member, free):
    """Whether a pose is fixed is asked of the end at which it stands."""
    scenario = scene()
    ends = {"start": scenario.start.copy(), "goal": scenario.goal.copy()}
    ends[free][:3] = np.nan
    nlp = make(scenario, Settings(formulation=member, margin=0.3, end_margin=0.1), steps=3, **ends).nlp
    at_start, at_goal = ("margin", "end_margin") if free == "start" else ("end_margin", "margin")
    between = ["margin"] if member.holds == "interval" else []
    start = [at_start] if member.holds == "interval" else []
    assert margins_used(nlp, member, 1) == [*start, *between, "margin"]
    assert margins_used(nlp, member, 3) == [*(between * 2), at_goal]


def margins_used(nlp, member, knot):
    """Which margin each pose of a knot's first pair demands: the derivatives of the gap by the margins."""
    blocks = [block for block in by_kind(nlp, "separation", knot) if block.key[1] == 0]
    obstacle, *body = blocks if member.holds == "interval" else blocks[::-1]
    used = []
    for block in body:
        gap = nlp.g[obstacle.rows.start] - nlp.g[block.rows.start]
        slope = ca.Function("s", [nlp.x, nlp.p], [ca.jacobian(gap, nlp.p)])(nlp.x0, nlp.p0)
        names = {(1.0, 0.0): "margin", (0.0, 1.0): "end_margin"}
        used.append(names[tuple(np.array(slope).ravel()[3:5])])
    return used


def test_pairs_left_out_add_neither_variables_nor_rows():
    active = np.ones((4, 1, 2), bool)
    active[0] = active[2, 0, 1] = False
    nlp = make(settings=Settings(formulation=UnitNormalLine()), active=active).nlp
    assert nlp.n_variables == 5 * 5 + 2 * 4 + 1 + 2 * 5
    kept = {(block.knot, str(block.key[1])) for block in by_kind(nlp, "separation")}
    assert kept == {(2, "0"), (2, "1"), (3, "0"), (4, "0"), (4, "1")}
    none = make(active=np.zeros((4, 1, 2), bool)).nlp
    assert not by_kind(none, "separation")


def test_start_and_goal_are_bounds_and_nan_is_free():
    scenario = scene(start=[0, 0, 0, np.nan, 0.1], goal=[6, 0.5, 0.2, 0, np.nan])
    nlp = make(scenario).nlp
    low, high = CAR.state_bounds
    first, last = nlp.stages[0].state, nlp.stages[-1].state
    np.testing.assert_array_equal(nlp.lbx[first], [0, 0, 0, low[3], 0.1])
    np.testing.assert_array_equal(nlp.ubx[first], [0, 0, 0, high[3], 0.1])
    np.testing.assert_array_equal(nlp.lbx[last], [6, 0.5, 0.2, 0, low[4]])
    np.testing.assert_array_equal(nlp.ubx[last], [6, 0.5, 0.2, 0, high[4]])
    middle = nlp.stages[2]
    np.testing.assert_array_equal(nlp.lbx[middle.state], low)
    np.testing.assert_array_equal(nlp.ubx[middle.control], CAR.input_bounds[1])


@pytest.mark.parametrize("turns", [-2, -1, 0, 1])
def test_the_goal_s_heading_is_the_one_nearest_the_guess(turns):
    scenario = scene()
    end = scenario.goal + np.array([0, 0, 2 * np.pi * turns + 0.5, 0, 0])
    guess = Trajectory([0, 10], [scenario.start, end], [[0, 0]])
    nlp = make(scenario, guess=guess).nlp
    heading = nlp.stages[-1].state.start + 2
    assert nlp.lbx[heading] == nlp.ubx[heading] == pytest.approx(0.2 + 2 * np.pi * turns, abs=1e-12)


def test_the_guess_is_resampled_and_clipped_into_the_bounds():
    scenario = scene()
    fast = np.array([0, 0, 0, 99.0, -99.0])
    guess = Trajectory([0, 5, 10], [scenario.start, fast, scenario.goal], [[9, 9], [-9, -9]])
    transcription = make(scenario, guess=guess)
    nlp = transcription.nlp
    assert (nlp.lbx <= nlp.x0).all()
    assert (nlp.x0 <= nlp.ubx).all()
    start = transcription.trajectory(nlp.x0)
    assert start.duration == 10.0
    assert start.states[2, 3] == pytest.approx(CAR.limits.speed[1])
    assert start.states[2, 4] == pytest.approx(-CAR.limits.steering)
    np.testing.assert_array_equal(start.inputs[:2], np.broadcast_to(CAR.input_bounds[1], (2, 2)))


@pytest.mark.parametrize(("final_time", "bounds"), [(12.5, (12.5, 12.5)), ((3.0, 40.0), (3.0, 40.0))])
def test_the_final_time_is_fixed_or_bounded(final_time, bounds):
    nlp = make(settings=Settings(final_time=final_time)).nlp
    assert (nlp.lbx[nlp.shared][0], nlp.ubx[nlp.shared][0]) == bounds
    assert nlp.shared.stop - nlp.shared.start == 1


def test_the_heading_is_free_or_limited():
    heading = [stage.state.start + 2 for stage in make().nlp.stages[1:-1]]
    free, limited = make().nlp, make(settings=Settings(heading_limit=np.pi)).nlp
    assert np.isinf(free.lbx[heading]).all()
    np.testing.assert_array_equal(limited.lbx[heading], -np.pi)
    np.testing.assert_array_equal(limited.ubx[heading], np.pi)


def test_margins_too_small_for_the_formulation_are_raised():
    zero = make(settings=Settings(formulation=SeparatingLine(), margin=0.0, end_margin=0.0))
    assert zero.settings.margin == SeparatingLine.smallest_margin
    assert zero.settings.end_margin == SeparatingLine.smallest_margin
    assert make(settings=Settings(formulation=UnitNormalLine(), margin=0.0)).settings.margin == 0.0
    assert make(settings=Settings(formulation=SeparatingLine(), margin=0.3)).settings.end_margin == 0.3


def test_obstacles_and_weights_are_parameters():
    """The same symbols with another scene's numbers are that scene's program."""
    scenario = scene()
    moved = scene(
        obstacles=tuple(obstacle.shifted([0.5, -0.25]) for obstacle in scenario.obstacles),
    )
    guess = LinearInterpolation().make(scenario, CAR, margin=0.0).trajectory
    settings = Settings(formulation=UnitNormalLine(), margin=0.1, objective=Objective(0.2, (3.0, 4.0)))
    here, there = (make(scene_, settings, guess=guess).nlp for scene_ in (scenario, moved))
    x = random_point(here, np.random.default_rng(9))
    value = ca.Function("fg", [here.x, here.p], [ca.vertcat(here.f, here.g)])
    other = ca.Function("fg", [there.x, there.p], [ca.vertcat(there.f, there.g)])
    np.testing.assert_allclose(np.array(value(x, there.p0)), np.array(other(x, there.p0)), atol=1e-12)
    assert not np.allclose(np.array(value(x, there.p0)), np.array(value(x, here.p0)))


def test_swept_rows_ask_for_the_margin_and_the_cover_at_free_poses():
    """Against the rows written out by hand, with an independent integration of the poses in between."""
    rng = np.random.default_rng(10)
    settings = Settings(formulation=SweptUnitNormalLine(), margin=0.07, end_margin=0.01, poses=2, substeps=4)
    nlp = make(scene(), settings, steps=3).nlp
    x = random_point(nlp, rng)
    rows, k = rows_of(nlp, x), 2
    before, after = x[nlp.stages[1].state], x[nlp.stages[2].state]
    control, h = x[nlp.stages[1].control], 5.0 / 3
    part = CAR.parts[0].polygon
    bound = CAR.acceleration_bound(0, part.radius, (before + after) / 2, control, h / 2, np)
    cover = bound * (h / 2) ** 2 / 8
    phi, mu = x[nlp.stages[2].auxiliary][:2]
    n = np.array([np.cos(phi), np.sin(phi)])
    blocks = [block for block in by_kind(nlp, "separation", k) if block.key[1] == 0]
    triangle = scene().obstacle_parts[0][1].vertices
    base = (0.07 + cover) / 2
    np.testing.assert_allclose(rows[blocks[0].rows], triangle @ n - mu + base, atol=1e-12)
    poses = [before, finely_integrated(before, control, h / 2), after]
    for block, pose in zip(blocks[1:], poses, strict=True):
        V = transform(part.vertices, pose[:3])
        np.testing.assert_allclose(rows[block.rows], V @ n - mu - base, atol=1e-6)


@pytest.mark.parametrize(
    ("arguments", "path"),
    [
        ({"substeps": 0}, "substeps"),
        ({"poses": -1}, "poses"),
        ({"poses": (2, -1)}, "poses"),
        ({"poses": ()}, "poses"),
        ({"margin": -0.1}, "margin"),
        ({"margin": np.nan}, "margin"),
        ({"end_margin": np.inf}, "end_margin"),
        ({"workspace_margin": -1.0}, "workspace_margin"),
        ({"final_time": 0.0}, "final_time"),
        ({"final_time": (5.0, 3.0)}, "final_time"),
        ({"final_time": np.inf}, "final_time"),
        ({"final_time": (np.nan, 3.0)}, "final_time"),
        ({"heading_limit": -1.0}, "heading_limit"),
        ({"heading_limit": np.nan}, "heading_limit"),
    ],
)
def test_settings_without_sense_are_refused(arguments, path):
    with pytest.raises(InputError) as error:
        Settings(**arguments)
    assert [problem.path for problem in error.value.problems] == [path]


def test_arguments_that_do_not_fit_are_refused():
    with pytest.raises(InputError, match=r"active: has shape \(4, 1, 1\), but this problem needs \(4, 1, 2\)"):
        make(active=np.ones((4, 1, 1), bool))
    with pytest.raises(InputError, match=r"objective.input_weights: needs 2 numbers"):
        make(settings=Settings(objective=Objective(1.0, (1.0,))))
    with pytest.raises(InputError, match=r"poses: has 3 numbers for 4 intervals; give one or 4"):
        make(settings=Settings(formulation=SweptLine(), poses=(1, 2, 1)))
    with pytest.raises(InputError, match="guess"):
        make(guess=Trajectory([0, 1], np.zeros((2, 3)), np.zeros((1, 2)), ("x", "y", "theta")))
    with pytest.raises(InputError, match="goal"):
        make(goal=np.zeros(3))


@pytest.mark.parametrize(("poses", "substeps"), [(1, 4), (2, 4), (3, 4), (4, 4), (2, 3)])
def test_poses_between_the_knots_are_integrated_as_finely_as_the_knots(poses, substeps):
    """With at least the demanded substeps an interval, whatever their number has to do with the poses."""
    car, settings = vehicle("tpcap"), Settings(formulation=SweptUnitNormalLine(), poses=poses, substeps=substeps)
    nlp = make(settings=settings, steps=2, car=car).nlp
    x = nlp.x0.copy()
    before, control, h = np.array([0, 0, 0, 2.4, -0.7]), np.array([-0.9, 0.5]), 2.0
    x[nlp.stages[0].state], x[nlp.stages[0].control], x[nlp.shared] = before, control, 2 * h
    rows = rows_of(nlp, x)
    phi, mu = x[nlp.stages[1].auxiliary][:2]
    n = np.array([np.cos(phi), np.sin(phi)])
    blocks = [block for block in by_kind(nlp, "separation", 1) if block.key[1] == 0][2:-1]
    assert len(blocks) == poses - 1
    cover = float(
        rows[by_kind(nlp, "separation", 1)[0].rows].max() - (scene().obstacle_parts[0][1].vertices @ n - mu).max()
    )
    for index, block in enumerate(blocks, start=1):
        pose = finely_integrated(before, control, h * index / poses, car=car)
        V = transform(car.parts[0].polygon.vertices, pose[:3])
        # the start is fixed, so its margin (none here) is the obstacle's half; the rest is the body's
        body = V @ n - mu - rows[block.rows]
        np.testing.assert_allclose(body, body.mean(), atol=1.5e-3)
        assert cover == pytest.approx(0.0, abs=1e-12)
    after = finely_integrated(before, control, h, car=car)
    np.testing.assert_allclose(rows[nlp.stages[0].dynamics] + x[nlp.stages[1].state], after, atol=2e-3)
