"""A path given by the user: gear and steering from the poses, within the limits, rest where the gear changes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tightspot.errors import InputError
from tightspot.guesses import GivenPath
from tightspot.scenarios.library import builtin
from tightspot.vehicles import VehicleModel, vehicle

CAR = vehicle("paper")
SCENE = builtin("vertical")


def make(poses, scenario=SCENE, car=CAR):
    return GivenPath(poses).make(scenario, car, margin=0.0).trajectory


def assert_within_limits(trajectory, car=CAR, slack=1e-12):
    (low, high), (input_low, input_high) = car.state_bounds, car.input_bounds
    assert (trajectory.states >= low - slack).all()
    assert (trajectory.states <= high + slack).all()
    assert (trajectory.inputs >= input_low - slack).all()
    assert (trajectory.inputs <= input_high + slack).all()


def rates(trajectory):
    """(v', delta') that the states at the knots need."""
    return np.diff(trajectory.states[:, 3:], axis=0) / np.diff(trajectory.t)[:, None]


coordinate = st.floats(-8, 8)


@given(st.lists(st.tuples(coordinate, coordinate, st.floats(-7, 7)), min_size=2, max_size=8))
def test_any_poses_become_a_trajectory_within_the_limits(poses):
    trajectory = make(poses)
    assert_within_limits(trajectory)
    np.testing.assert_allclose(trajectory.states[0], SCENE.start, atol=1e-12)
    np.testing.assert_allclose(trajectory.states[-1, :2], SCENE.goal[:2], atol=1e-12)
    assert np.cos(trajectory.states[-1, 2] - SCENE.goal[2]) == pytest.approx(1.0)
    np.testing.assert_allclose(trajectory.states[-1, 3:], 0.0, atol=1e-12)
    np.testing.assert_allclose(trajectory.inputs, rates(trajectory), atol=1e-9)


@given(st.lists(st.tuples(coordinate, coordinate, st.floats(-3, 3)), min_size=2, max_size=6))
def test_the_given_poses_are_passed_in_their_order(poses):
    trajectory = make(poses)
    knots = trajectory.states[:, :2].tolist()
    at = [min(range(len(knots)), key=lambda i: np.hypot(*np.subtract(knots[i], pose[:2]))) for pose in poses]
    for pose in poses:
        assert min(np.hypot(*np.subtract(knot, pose[:2])) for knot in knots) < 2e-6
    if len({(round(x, 5), round(y, 5)) for x, y, _ in poses} | {(0.0, 0.0), (6.3, -6.7)}) == len(poses) + 2:
        assert at == sorted(at)


def test_gears_follow_from_the_order_of_the_poses():
    trajectory = make([(0, 0, 0), (4, 0, 0), (8, 0, 0), (6, -0.5, 0.4), (4, -2, 0.9)])
    v, x = trajectory.column("v"), trajectory.column("x")
    assert v[x == 4][0] > 0
    assert v[np.argmax(x)] == 0, "rest where the gear changes"
    assert v[x == 6][0] < 0
    assert (v[x == 4][1:] < 0).all()


def test_steering_is_that_of_the_circle_through_the_poses():
    radius = 6.0
    angles = np.linspace(0, 1.2, 13)
    poses = np.column_stack([radius * np.sin(angles), radius * (1 - np.cos(angles)), angles])
    scenario = SCENE.with_(goal=[*poses[-1], 0, 0])
    delta = make(poses, scenario).column("delta")
    np.testing.assert_allclose(np.tan(delta[3:-3]) / CAR.wheelbase, 1 / radius, rtol=1e-3)
    backwards = make(poses[::-1], scenario.with_(start=[*poses[-1], 0, 0], goal=[*poses[0], 0, 0]))
    np.testing.assert_allclose(np.tan(backwards.column("delta")[3:-3]) / CAR.wheelbase, 1 / radius, rtol=1e-3)
    assert (backwards.column("v")[1:-1] < 0).all()


def test_coordinates_are_those_of_the_file():
    far = SCENE.with_(offset=np.array([1000.0, -500.0]))
    trajectory = make([(1003.0, -500.0, 0.0), (1006.0, -502.0, 0.5)], far)
    near = make([(3.0, 0.0, 0.0), (6.0, -2.0, 0.5)])
    np.testing.assert_allclose(trajectory.states, near.states, atol=1e-9)


def test_headings_that_jump_by_a_turn_are_unwrapped():
    trajectory = make([(1, 0, 0.1), (2, 0.1, 0.1 - 2 * np.pi), (3, 0.2, 0.1 + 4 * np.pi)])
    assert np.abs(trajectory.column("theta")[:-1]).max() < 0.2


def test_only_start_and_goal_and_even_standing_still_are_paths():
    two = make([SCENE.start[:3], SCENE.goal[:3]])
    assert two.steps == 1
    still = make([SCENE.start[:3]] * 2, SCENE.with_(goal=SCENE.start))
    assert still.duration > 0
    assert_within_limits(still)


@pytest.mark.parametrize(
    "poses",
    [[], [[0, 0, 0]], [[0, 0], [1, 1]], [[0, 0, 0], [np.nan, 0, 0]], "path", None, [[0, 0, 0], [1, 1]], 7],
)
def test_what_is_no_path_is_refused(poses):
    with pytest.raises(InputError, match=r"guess.poses: must be"):
        GivenPath(poses)


def test_other_vehicle_models_are_refused_in_a_sentence():
    class Tram(VehicleModel):
        name = "tram"
        parts = state_bounds = input_bounds = ()
        dynamics = frames = motion_bounds = to_dict = lambda *arguments: None

    with pytest.raises(InputError, match="path is made for single-track vehicles, not for Tram"):
        GivenPath([[0, 0, 0], [1, 0, 0]]).make(SCENE, Tram(), margin=0.0)
