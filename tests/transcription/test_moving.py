"""Moving obstacles: poses at knots and samples, both forms of the program, and derivatives with respect to t_f."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.transcription.test_stage_problem import FORMULATIONS, compare, same_start, scene

from tightspot.errors import InputError
from tightspot.formulations import SeparatingLine, SweptLine, SweptUnitNormalLine, UnitNormalLine
from tightspot.geometry import ConvexPolygon
from tightspot.geometry.transforms import transform, wrap_angle
from tightspot.guesses import LinearInterpolation
from tightspot.solvers.stage_core import core_solver
from tightspot.transcription import (
    MovingObstacle,
    ObstacleMotion,
    Settings,
    TimedPoses,
    TimeGrid,
    stage_problem,
    transcribe,
)
from tightspot.transcription.moving import bulges, sampled
from tightspot.vehicles import vehicle

BOX = ConvexPolygon.rectangle(-1.0, 1.5, -0.5, 0.6)
TRIANGLE = ConvexPolygon.from_vertices([(0.0, 0.0), (1.2, 0.1), (0.3, 0.9)])


def random_motions(rng, steps, count=2):
    """Turning and sliding obstacle parts near the small scene's middle, each for a final time of its own."""
    return [
        ObstacleMotion(
            (BOX, TRIANGLE)[index % 2],
            rng.normal([4.0, -1.0, 0.5], 0.7, (steps + 1, 3)),
            rng.normal(0.0, 0.5, (steps + 1, 3)),
            float(rng.uniform(4.0, 9.0)),
        )
        for index in range(count)
    ]


def both(formulation, *, steps=3, seed=0, car="paper", **changes):
    """The Nlp and the stage problem of the small scene with two moving obstacle parts and random masks."""
    rng = np.random.default_rng(seed)
    body, scenario = vehicle(car), scene()
    guess = LinearInterpolation().make(scenario, body, margin=0.0).trajectory
    fractions = np.concatenate([[0], np.cumsum(rng.uniform(0.5, 1.5, steps))])
    grid = TimeGrid(fractions / fractions[-1])
    arguments = {"margin": 0.3, "end_margin": 0.1, "workspace_margin": 0.05, "substeps": 3}
    if formulation.holds == "interval":
        arguments["poses"] = tuple(int(count) for count in rng.integers(1, 4, steps))
    settings = Settings(formulation=formulation, **arguments | changes)
    others = {
        "motions": random_motions(rng, steps),
        "active": rng.random((steps, len(body.parts), 4)) < 0.8,
        "grid": grid,
    }
    args = (scenario, body, guess, settings)
    return transcribe(*args, **others).nlp, stage_problem(*args, **others)


CASES = [
    *((member, {}) for member in FORMULATIONS),
    *((member, {"seed": 5, "car": "forklift", "steps": 2}) for member in (UnitNormalLine, SweptUnitNormalLine)),
    (SweptLine, {"seed": 6, "final_time": 7.0}),
    (SeparatingLine, {"seed": 7, "steps": 5}),
    (SweptLine, {"seed": 8, "poses": (0, 2, 1)}),
]


@pytest.mark.parametrize(("member", "changes"), CASES)
def test_stage_problem_and_nlp_are_the_same_program(member, changes):
    nlp, problem = both(member(), **changes)
    assert problem.motion_obstacles.tolist() == [2, 3]
    assert set(problem.pairs[:, 2]) == {0, 1, 2, 3}
    compare(nlp, problem)


@pytest.mark.parametrize("member", FORMULATIONS)
def test_starts_at_the_same_point(member):
    same_start(*both(member(), final_time=6.0))


@pytest.mark.parametrize("member", [UnitNormalLine, SweptUnitNormalLine])
def test_derivatives_along_t_f_by_differences(member):
    _, problem = both(member(), seed=9)
    core = core_solver(problem)
    rng = np.random.default_rng(0)
    v = problem.starting_point() + 0.1 * rng.normal(size=problem.starting_point().size)
    lam, z = rng.normal(size=problem.steps * 5), rng.uniform(0.1, 2.0, core.sizes["rows"])
    time = problem.states.size + problem.inputs.size
    v[time] = 6.5

    def at(final_time):
        moved = v.copy()
        moved[time] = final_time
        answer = core.derivatives(moved, lam, z)
        return answer["objective"] + lam @ answer["defects"] - z @ answer["rows"], answer["gradient"]

    h = 1e-5
    (low, low_gradient), (high, high_gradient) = at(6.5 - h), at(6.5 + h)
    here = core.derivatives(v, lam, z)
    assert here["gradient"][time] == pytest.approx((high - low) / (2 * h), rel=1e-6, abs=1e-6)
    difference = (high_gradient - low_gradient) / (2 * h)
    assert here["hessian"][time] == pytest.approx(difference, rel=1e-5, abs=1e-5)
    standing = core_solver(problem.replaced(motion_slopes=np.zeros_like(problem.motion_slopes)))
    assert abs(standing.derivatives(v, lam, z)["gradient"][time] - here["gradient"][time]) > 1e-2


def test_rows_are_distances_to_the_moved_obstacle():
    """Rows of the obstacle's line, put into the world at the knot, against vertices moved there by hand."""
    _, problem = both(SeparatingLine(), seed=11)
    core, rng = core_solver(problem), np.random.default_rng(1)
    v = problem.starting_point() + 0.1 * rng.normal(size=problem.starting_point().size)
    states, _, final_time, lines, _ = problem.unpack(v)
    rows = core.derivatives(v, np.zeros(problem.steps * 5), np.zeros(core.sizes["rows"]))["rows"]
    last = np.cumsum(problem.pieces + 1) - 1
    seen = 0
    for (k, part, obstacle), (phi, mu) in zip(problem.pairs, lines, strict=True):
        if obstacle < 2:
            continue
        m = obstacle - 2
        frame = (
            problem.motion_poses[m, last[k]]
            + (final_time - problem.motion_times[m]) * problem.motion_slopes[m, last[k]]
        )
        n = np.array([np.cos(phi + frame[2]), np.sin(phi + frame[2])])
        offset = mu + n @ frame[:2]
        corners = slice(*problem.obstacle_first[obstacle : obstacle + 2])
        O = transform(problem.obstacle_vertices[corners], frame)
        V = transform(problem.part_vertices[slice(*problem.part_first[part : part + 2])], states[k + 1, :3])
        half = (0.1 if k == problem.steps - 1 else 0.3) / 2
        expected = np.concatenate([offset - O @ n - half, V @ n - offset - half])
        assert any(np.allclose(rows[i : i + expected.size], expected) for i in range(rows.size - expected.size + 1))
        seen += 1
    assert seen


def weaving(t):
    return np.column_stack([2 * t + np.sin(t), 0.3 * t**2, 0.5 * np.sin(0.7 * t)])


def test_poses_and_rates_of_a_function_of_time():
    grid = TimeGrid(np.array([0.0, 0.2, 0.7, 1.0]))
    motion = MovingObstacle(BOX, weaving).on(grid, 5.0)
    t = 5.0 * grid.fractions
    rates = np.column_stack([2 + np.cos(t), 0.6 * t, 0.35 * np.cos(0.7 * t)])
    assert motion.poses == pytest.approx(weaving(t))
    assert motion.rates == pytest.approx(rates, abs=1e-6)


def test_a_heading_that_jumps_by_whole_turns_is_the_same_motion():
    def jumping(t):
        poses = weaving(t)
        poses[:, 2] = wrap_angle(poses[:, 2] + 3.0)
        return poses

    def smooth(t):
        poses = weaving(t)
        poses[:, 2] += 3.0
        return poses

    grid, pieces = TimeGrid.uniform(9), np.full(9, 3)
    one, two = (sampled(MovingObstacle(BOX, motion).on(grid, 6.0), grid, pieces) for motion in (jumping, smooth))
    assert np.cos(one.poses[:, 2] - two.poses[:, 2]) == pytest.approx(1.0)
    assert one.slopes == pytest.approx(two.slopes, abs=1e-6)
    assert one.fastest.turn == pytest.approx(two.fastest.turn, abs=1e-5)


def test_samples_between_knots_converge_with_the_fourth_power():
    errors = []
    for steps in (4, 8, 16):
        grid, pieces = TimeGrid.uniform(steps), np.full(steps, 4)
        table = sampled(MovingObstacle(BOX, weaving).on(grid, 6.0), grid, pieces)
        share = np.concatenate([(k + np.linspace(0, 1, 5)) / steps for k in range(steps)])
        errors.append(np.abs(table.poses - weaving(6.0 * share)).max())
        moved = (weaving(6.01 * share) - weaving(5.99 * share)) / 0.02
        assert np.abs(table.slopes - moved).max() < 3.0 / steps**2
    assert errors[0] / errors[1] > 10
    assert errors[1] / errors[2] > 10


@given(seed=st.integers(0, 2**32 - 1))
def test_body_points_leave_their_chords_by_no_more_than_the_bulge(seed):
    """A point that drives straight at its top speed, seen from the obstacle, against chords between the samples."""
    rng = np.random.default_rng(seed)
    grid, car, margin = TimeGrid.uniform(2), vehicle("paper"), 0.1
    motion = ObstacleMotion(BOX, rng.normal(0, 1, (3, 3)), rng.normal(0, 1, (3, 3)), 3.0)
    pieces = np.array([2, 3])
    allowed = bulges(car, motion, margin, grid, pieces)
    fine = [np.full(2, 60)] * 2
    table = sampled(motion, grid, fine[0])
    speed = car.fastest()[0].speed[0] * rng.uniform(0, 1)
    direction = rng.normal(size=2)
    velocity = speed * direction / np.linalg.norm(direction)
    for k, count in enumerate(pieces):
        frames = table.poses[k * 61 : (k + 1) * 61]
        t = np.linspace(0, 1.5, 61)
        meeting = rng.integers(0, 61)  # where the point is next to the obstacle
        near = frames[meeting, :2] + rng.uniform(-1, 1, 2)
        points = near + (t - t[meeting])[:, None] * velocity
        d = points - frames[:, :2]
        c, s = np.cos(frames[:, 2]), np.sin(frames[:, 2])
        seen = np.column_stack([c * d[:, 0] + s * d[:, 1], c * d[:, 1] - s * d[:, 0]])
        step = 60 // count
        first = min(meeting // step, count - 1) * step
        share = np.linspace(0, 1, step + 1)[:, None]
        chord = (1 - share) * seen[first] + share * seen[first + step]
        assert np.linalg.norm(seen[first : first + step + 1] - chord, axis=1).max() <= allowed[k].max() + 1e-12


def test_a_table_of_poses_is_passed_through_and_stands_outside():
    table = TimedPoses([0.0, 1.0, 3.0, 4.0], [(0, 0, 3.0), (1, 0, -3.0), (2, 2, -2.0), (2, 3, -2.0)])
    poses = table(np.array([-5.0, 0.0, 1.0, 3.0, 4.0, 99.0]))
    assert poses[[0, 4], :2].tolist() == [[0, 0], [2, 3]]
    assert poses[2:5, :2].tolist() == [[1, 0], [2, 2], [2, 3]]
    assert np.abs(np.diff(table(np.linspace(0, 4, 401))[:, 2])).max() < 0.05
    fine = np.diff(table(np.linspace(1, 4, 301)), axis=0)
    assert (fine[:, :2] >= 0).all()  # swings nowhere beyond the poses
    waiting = TimedPoses([0.0, 1.0, 1.5, 40.0], [(0, 0, 0), (1, 0, 0), (1.2, 0, 0), (1.2, 0, 0)])
    assert waiting(np.linspace(1.5, 40, 99))[:, 0] == pytest.approx(1.2)
    h = 1e-6
    for knot in (1.0, 3.0):
        before, here, after = table(np.array([knot - h, knot, knot + h]))
        assert (after - here) / h == pytest.approx((here - before) / h, abs=1e-4)


GOOD = {"polygon": BOX, "poses": np.zeros((4, 3)), "rates": np.zeros((4, 3)), "final_time": 5.0}


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"poses": np.full((4, 3), np.nan)}, "poses.*knot 0 is not finite"),
        ({"rates": np.full((4, 3), np.inf)}, "rates.*not finite"),
        ({"poses": np.zeros((4, 2))}, "poses.*shape"),
        ({"poses": np.zeros(3)}, "poses.*shape"),
        ({"poses": "far away"}, "poses.*shape"),
        ({"poses": np.full((4, 3), 1e300)}, "poses.*beyond"),
        ({"polygon": BOX.vertices}, "polygon.*ndarray"),
        ({"rates": np.zeros((3, 3))}, "rates.*shape"),
        ({"final_time": 0.0}, "final_time.*positive"),
        ({"final_time": np.nan}, "final_time.*positive"),
    ],
)
def test_bad_motions_are_refused_with_their_field(changes, sentence):
    with pytest.raises(InputError, match=sentence):
        ObstacleMotion(**GOOD | changes)


@pytest.mark.parametrize("write", [transcribe, stage_problem])
def test_a_motion_with_other_knots_is_refused(write):
    car, scenario = vehicle("paper"), scene()
    guess = LinearInterpolation().make(scenario, car, margin=0.0).trajectory
    with pytest.raises(InputError, match="4 rows, but the grid has 6 knots"):
        write(scenario, car, guess, Settings(), grid=TimeGrid.uniform(5), motions=[ObstacleMotion(**GOOD)])


@pytest.mark.parametrize(
    ("motion", "sentence"),
    [
        (lambda t: np.zeros((t.size, 2)), "shape"),
        (lambda t: np.full((t.size, 3), np.nan), "at 0 s"),
        (lambda t: "later", "no table"),
        (lambda t: 3.0, "shape"),
        (lambda t: np.where(t[:, None] > 2.0, np.inf, np.zeros((1, 3))), "inf.* at "),
    ],
)
def test_bad_functions_of_time_are_refused(motion, sentence):
    with pytest.raises(InputError, match=sentence):
        MovingObstacle(BOX, motion).on(TimeGrid.uniform(4), 5.0)
    with pytest.raises(InputError, match="final_time"):
        MovingObstacle(BOX, weaving).on(TimeGrid.uniform(4), np.nan)


@pytest.mark.parametrize(
    ("t", "poses", "sentence"),
    [
        ([0.0], [(0, 0, 0)], "two or more"),
        ([0.0, 1.0], [(0, 0), (1, 0)], "shapes"),
        ([0.0, 0.0], [(0, 0, 0), (1, 0, 0)], "increase"),
        ([0.0, np.nan], [(0, 0, 0), (1, 0, 0)], "finite"),
    ],
)
def test_bad_tables_are_refused(t, poses, sentence):
    with pytest.raises(InputError, match=sentence):
        TimedPoses(t, poses)


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"motion_obstacles": np.array([2, 9])}, "motion_obstacles"),
        ({"motion_obstacles": np.array([2, -1])}, "motion_obstacles"),
        ({"motion_obstacles": np.array([2, 2])}, "motion_obstacles"),
        ({"motion_times": np.array([1.0, np.nan])}, "motion_times"),
        ({"motion_times": np.array([1.0])}, "motion_times"),
        ({"motion_poses": np.full((2, 7, 3), 0.0)}, "motion_"),
        ({"pair_extras": np.array([np.nan])}, "pair_extras"),
    ],
)
def test_the_core_refuses_arrays_that_do_not_fit(changes, field):
    _, problem = both(UnitNormalLine())
    with pytest.raises(InputError, match=field):
        core_solver(problem.replaced(**changes))
    poses = problem.motion_poses.copy()
    poses[0, 0, 0] = np.nan
    with pytest.raises(InputError, match="motion_poses"):
        core_solver(problem.replaced(motion_poses=poses))
