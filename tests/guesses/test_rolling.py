"""Steering while rolling: on the path, within the limits, nearly what the inputs do."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from tightspot.guesses import Arc, lift_arcs, lift_rolling
from tightspot.search import Path
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

paths = st.lists(
    st.tuples(st.floats(-6, 6), st.floats(-1, 1).map(lambda value: value * SHARPEST)), min_size=1, max_size=5
)


def path_of(arcs, spacing=0.1):
    return Path.from_arcs(START[:3], np.array(arcs, float), spacing)


@given(arcs=paths, goal_steering=st.one_of(st.just(np.nan), st.floats(-0.6, 0.6)))
def test_limits_ends_and_poses(arcs, goal_steering):
    path = path_of(arcs)
    assume(path.length > 1e-3)
    trajectory = lift_rolling(path, START, goal_steering, CAR)
    (low, high), (input_low, input_high) = CAR.state_bounds, CAR.input_bounds
    assert (trajectory.states >= low - 1e-9).all()
    assert (trajectory.states <= high + 1e-9).all()
    assert (trajectory.inputs >= input_low - 1e-9).all()
    assert (trajectory.inputs <= input_high + 1e-9).all()
    assert (trajectory.states[[0, -1], 3] == 0).all()
    assert trajectory.states[0, 4] == pytest.approx(START[4], abs=1e-9)
    if np.isfinite(goal_steering):
        assert trajectory.states[-1, 4] == pytest.approx(goal_steering, abs=1e-9)
    on_path = np.abs(trajectory.poses[:, None] - path.poses[None]).max(axis=2).min(axis=1)
    assert on_path.max() == 0
    np.testing.assert_array_equal(trajectory.poses[0], path.poses[0])
    np.testing.assert_allclose(trajectory.poses[-1], path.poses[-1], atol=1e-6)


@given(arcs=paths)
def test_the_wheels_are_never_turned_faster_than_they_can_be(arcs):
    path = path_of(arcs)
    assume(path.length > 1e-3)
    trajectory = lift_rolling(path, START, 0.0, CAR)
    rates = np.abs(np.diff(trajectory.column("delta"))) / np.diff(trajectory.t)
    assert rates.max() <= CAR.limits.steering_rate * (1 + 1e-9)


def test_a_long_arc_is_driven_with_its_own_steering_angle_and_the_speed_of_a_trapezoid():
    curvature = 0.8 * SHARPEST
    trajectory = lift_rolling(path_of([(12.0, curvature)]), START, 0.0, CAR)
    middle = slice(trajectory.steps // 3, 2 * trajectory.steps // 3)
    np.testing.assert_allclose(trajectory.column("delta")[middle], np.arctan(2.5 * curvature))
    assert trajectory.column("v").max() == pytest.approx(1.6)


def test_the_car_stands_where_the_gear_changes_and_there_only():
    arcs = [(3.0, 0.1), (-2.0, -0.1), (-1.0, 0.2), (2.0, 0.0)]
    trajectory = lift_rolling(path_of(arcs), START, 0.0, CAR)
    v = trajectory.column("v")
    assert (v == 0).sum() == 4
    assert np.count_nonzero(np.diff(np.sign(v[v != 0]))) == 2


def replayed(trajectory, car, each=20):
    """Poses at the knots by small steps of the dynamics under the inputs, from the first state."""
    states = [trajectory.states[0]]
    for control, duration in zip(trajectory.inputs, np.diff(trajectory.t), strict=True):
        now = states[-1]
        for _ in range(each):
            half = now + duration / each / 2 * np.array(car.dynamics(now, control, np))
            now = now + duration / each * np.array(car.dynamics(half, control, np))
        states.append(now)
    return np.array(states)


def test_the_inputs_lead_near_the_goal_and_those_of_the_standing_lift_to_it():
    arcs = [(4.0, 0.9 * SHARPEST), (2.0, -0.5 * SHARPEST), (-5.0, 0.0), (-2.0, -0.9 * SHARPEST)]
    goal = path_of(arcs).poses[-1]
    rolling = replayed(lift_rolling(path_of(arcs), START, 0.0, CAR), CAR)[-1]
    standing = replayed(lift_arcs([Arc(*arc) for arc in arcs], START, 0.0, CAR), CAR, 200)[-1]
    assert np.abs(standing[:3] - goal).max() < 1e-3
    assert 0.01 < np.hypot(*(rolling[:2] - goal[:2])) < 2.0


def test_a_free_start_steering_is_that_of_the_first_arc():
    start = np.array([1.0, 2.0, 0.5, np.nan, np.nan])
    trajectory = lift_rolling(path_of([(5.0, SHARPEST / 2)]), start, np.nan, CAR)
    np.testing.assert_allclose(np.tan(trajectory.column("delta")) / 2.5, SHARPEST / 2)


@pytest.mark.parametrize("name", ["paper", "tpcap", "obca", "forklift"])
def test_a_tiny_way_and_a_long_one_with_the_catalogue_s_vehicles(name):
    car = vehicle(name)
    for length in (0.005, 0.2, 300.0):
        trajectory = lift_rolling(path_of([(length, 1 / car.min_turning_radius)]), START * 0, 0.0, car)
        assert np.isfinite(trajectory.states).all()
        assert trajectory.duration > length / car.limits.speed[1]
