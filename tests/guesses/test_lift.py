"""Arcs lifted to a trajectory: drivable exactly, within the limits, along the path and nothing else."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tightspot.guesses import Arc, lift_arcs
from tightspot.guesses.lift import merge_arcs
from tightspot.vehicles import Limits, SingleTrack, vehicle

CAR = SingleTrack.rectangular(
    "car",
    wheelbase=2.5,
    length=4.0,
    width=1.8,
    rear_overhang=0.8,
    limits=Limits((-1.0, 1.6), (-0.7, 0.9), 0.6, 0.3),
)
SHARPEST = np.tan(0.6) / 2.5
START = np.array([1.0, 2.0, 0.5, 0.0, 0.1])

arcs_strategy = st.lists(
    st.builds(Arc, st.floats(-6, 6), st.floats(-1, 1).map(lambda value: value * SHARPEST)), max_size=5
)


def exact_path(start, arcs, spacing=0.02):
    """Poses along the arcs, by circle geometry alone."""
    poses = [np.array(start[:3], float)]
    for length, curvature in arcs:
        x, y, theta = poses[-1]
        s = np.sign(length) * np.r_[np.arange(spacing, abs(length), spacing), abs(length)]
        turned = theta + curvature * s
        if abs(curvature) > 1e-9:
            moved = [np.sin(turned) - np.sin(theta), np.cos(theta) - np.cos(turned)]
            along = np.array(moved) / curvature
        else:
            along = np.array([s * np.cos(theta), s * np.sin(theta)])
        poses += list(np.column_stack([x + along[0], y + along[1], turned]))
    return np.array(poses)


def replay(trajectory, car=CAR, rate=100):
    """States at many times by RK4 from the first state, and the states at the knots that this gives."""
    now, dense, knots = trajectory.states[0], [trajectory.states[0]], [trajectory.states[0]]
    for control, duration in zip(trajectory.inputs, np.diff(trajectory.t), strict=True):
        count = max(2, int(np.ceil(duration * rate)))
        h = duration / count
        for _ in range(count):
            k1 = np.array(car.dynamics(now, control, np))
            k2 = np.array(car.dynamics(now + h / 2 * k1, control, np))
            k3 = np.array(car.dynamics(now + h / 2 * k2, control, np))
            k4 = np.array(car.dynamics(now + h * k3, control, np))
            now = now + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
            dense.append(now)
        knots.append(now)
    return np.array(dense), np.array(knots)


def assert_within_limits(trajectory, car=CAR, slack=1e-9):
    (low, high), (input_low, input_high) = car.state_bounds, car.input_bounds
    assert (trajectory.states >= low - slack).all()
    assert (trajectory.states <= high + slack).all()
    assert (trajectory.inputs >= input_low - slack).all()
    assert (trajectory.inputs <= input_high + slack).all()


@given(arcs=arcs_strategy, goal_steering=st.one_of(st.just(np.nan), st.floats(-0.6, 0.6)))
def test_the_states_are_what_the_inputs_do_and_the_limits_are_kept(arcs, goal_steering):
    trajectory = lift_arcs(arcs, START, goal_steering, CAR)
    _, knots = replay(trajectory)
    np.testing.assert_allclose(trajectory.states, knots, atol=1e-6)
    assert_within_limits(trajectory)
    np.testing.assert_array_equal(trajectory.states[0], START)
    assert trajectory.states[-1, 3] == pytest.approx(0.0, abs=1e-9)
    if np.isfinite(goal_steering):
        assert trajectory.states[-1, 4] == pytest.approx(goal_steering, abs=1e-9)


@given(arcs=arcs_strategy)
def test_the_car_drives_the_arcs_and_nothing_else(arcs):
    """Every replayed pose lies on the path of the arcs, and the path's end is reached."""
    trajectory = lift_arcs(arcs, START, np.nan, CAR)
    path = exact_path(START, arcs)
    dense, _ = replay(trajectory, rate=20)
    np.testing.assert_allclose(trajectory.states[-1, :3], path[-1], atol=1e-6)
    off_path = np.abs(dense[::5, None, :3] - path[None]).max(axis=2).min(axis=1)
    assert off_path.max() < 0.02, "no further away than the path's sampling"
    off_drive = np.abs(path[::5, None] - dense[None, :, :3]).max(axis=2).min(axis=1)
    assert off_drive.max() < 0.06


def test_a_straight_line_takes_the_time_of_a_trapezoid():
    trajectory = lift_arcs([Arc(8.0, 0.0)], np.zeros(5), 0.0, CAR)
    # rate 0.7 both ways: 1.6 m/s after 1.6/0.7 s, the rest cruising
    ramp = 1.6 / 0.7
    assert trajectory.duration == pytest.approx(2 * ramp + (8.0 - 1.6 * ramp) / 1.6)
    assert trajectory.column("v").max() == pytest.approx(1.6)
    np.testing.assert_allclose(trajectory.column("a"), [0.7, 0.0, -0.7])


def test_a_short_way_never_reaches_the_speed_limit():
    trajectory = lift_arcs([Arc(-0.35, 0.0)], np.zeros(5), 0.0, CAR)
    assert trajectory.column("v").min() == pytest.approx(-np.sqrt(0.35 * 0.7))
    assert trajectory.steps == 2


def test_the_car_stands_while_it_steers():
    trajectory = lift_arcs([Arc(2.0, SHARPEST), Arc(-2.0, -SHARPEST)], np.zeros(5), 0.0, CAR)
    steering = trajectory.column("omega") != 0
    assert steering.sum() == 3
    assert (trajectory.column("v")[:-1][steering] == 0).all()
    assert (trajectory.column("a")[steering] == 0).all()
    np.testing.assert_allclose(np.abs(trajectory.column("omega")[steering]), 0.3)


def test_neighbours_of_one_kind_are_merged_and_empty_arcs_dropped():
    arcs = [Arc(1.0, 0.1), Arc(0.0, 0.3), Arc(2.0, 0.1), Arc(-1.0, 0.1), Arc(-1.0, 0.2), Arc(1e-12, 0.0)]
    assert merge_arcs(arcs) == [Arc(3.0, 0.1), Arc(-1.0, 0.1), Arc(-1.0, 0.2)]
    assert merge_arcs([]) == []


def test_a_free_start_steering_is_that_of_the_first_arc():
    start = np.array([0, 0, 0, np.nan, np.nan])
    trajectory = lift_arcs([Arc(3.0, SHARPEST / 2)], start, np.nan, CAR)
    np.testing.assert_allclose(np.tan(trajectory.column("delta")) / 2.5, SHARPEST / 2)
    assert (trajectory.column("omega") == 0).all()


def test_without_a_way_the_car_stands_or_only_steers():
    still = lift_arcs([], START, np.nan, CAR)
    assert still.steps == 1
    assert (still.states == START).all()
    assert (still.inputs == 0).all()
    steers = lift_arcs([], START, -0.2, CAR)
    assert steers.duration == pytest.approx(0.3 / 0.3)
    np.testing.assert_allclose(steers.states[-1], [*START[:4], -0.2], atol=1e-12)


@pytest.mark.parametrize("speed", [0.7, -0.4])
def test_a_start_in_motion_is_lifted_from_rest(speed):
    """The path is driven from rest to rest; the optimiser restores the start's own speed."""
    moving = START + np.array([0, 0, 0, speed, 0])
    trajectory = lift_arcs([Arc(3.0, 0.1)], moving, np.nan, CAR)
    np.testing.assert_allclose(trajectory.states[-1, :3], exact_path(START, [Arc(3.0, 0.1)])[-1], atol=1e-6)
    _, knots = replay(trajectory)
    np.testing.assert_allclose(trajectory.states, knots, atol=1e-6)
    assert_within_limits(trajectory)


@pytest.mark.parametrize("name", ["paper", "tpcap", "obca", "forklift"])
def test_the_sharpest_curve_of_a_catalogue_vehicle_stays_within_its_steering(name):
    car = vehicle(name)
    trajectory = lift_arcs(
        [Arc(2.0, 1 / car.min_turning_radius), Arc(-1.0, -1 / car.min_turning_radius)], START * 0, 0.0, car
    )
    assert_within_limits(trajectory, car)
    _, knots = replay(trajectory, car)
    np.testing.assert_allclose(trajectory.states, knots, atol=1e-6)
