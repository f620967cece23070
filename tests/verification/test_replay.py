"""The replay against closed forms, its own convergence order and a far finer integration."""

import copy
from dataclasses import replace

import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.trajectory import Trajectory
from tightspot.vehicles import vehicle
from tightspot.verification import replay


def test_straight_drive_is_exact(kit):
    car = kit.box_car()
    played = replay(car, kit.drive(car, [0, 1, 3], [[1, 0], [-0.5, 0]], start=(1, 2, np.pi / 2, 0, 0)))
    assert played.knots[-1] == pytest.approx([1, 2 + 0.5 + 1, np.pi / 2, 0, 0], abs=1e-12)
    assert played.at(2.0) == pytest.approx([1, 2.5 + 0.75, np.pi / 2, 0.5, 0], abs=1e-12)


def test_circle_at_constant_steering(kit):
    car = kit.box_car(wheelbase=2.0)
    delta = 0.4
    trajectory = kit.drive(car, [0, 5, 11], np.zeros((2, 2)), start=(0, 0, 0, 1.5, delta))
    times = np.linspace(0, 11, 301)
    rate, radius = 1.5 * np.tan(delta) / 2.0, 2.0 / np.tan(delta)
    exact = np.stack([radius * np.sin(rate * times), radius * (1 - np.cos(rate * times)), rate * times], axis=1)
    played = replay(car, trajectory)
    error = np.abs(played.at(times)[:, :3] - exact)
    assert np.hypot(error[:, 0], error[:, 1]).max() <= played.position_error <= 2e-7
    assert error[:, 2].max() <= played.heading_error


@pytest.mark.parametrize("seed", range(8))
def test_reported_error_covers_the_true_one_at_all_times(kit, seed):
    car = kit.box_car()
    trajectory = kit.wander(car, seed, steps=10, dt=1.7)
    coarse, fine = replay(car, trajectory, tolerance=1e-4), replay(car, trajectory, tolerance=1e-10)
    times = np.linspace(0, trajectory.t[-1], 4001)
    error = coarse.at(times) - fine.at(times)
    assert np.hypot(error[:, 0], error[:, 1]).max() <= coarse.position_error <= 1.1e-4
    assert np.abs(error[:, 2]).max() <= coarse.heading_error
    assert fine.substeps.sum() > 5 * coarse.substeps.sum()


def test_error_falls_with_the_fourth_power_of_the_step(kit):
    car = kit.box_car()
    trajectory = kit.wander(car, 5, steps=6, dt=2.0)
    reference = replay(car, trajectory, tolerance=1e-10).knots
    errors = []
    for step in (0.5, 0.25, 0.125, 0.0625):
        played = replay(car, trajectory, tolerance=10.0, first_step=step)
        errors.append(np.abs(played.knots - reference)[:, :2].max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(4, abs=0.35)


def test_defect_is_the_distance_of_stored_knots(kit):
    car = kit.box_car()
    trajectory = kit.wander(car, 1)
    assert replay(car, trajectory).defect == pytest.approx((0, 0), abs=1e-6)
    states = trajectory.states.copy()
    states[4, :3] += [0.03, -0.04, 0.01]
    states[7, 2] += 4 * np.pi
    position, heading = replay(car, Trajectory(trajectory.t, states, trajectory.inputs)).defect
    assert position == pytest.approx(0.05, abs=1e-6)
    assert heading == pytest.approx(0.01, abs=1e-6)


def test_intervals_and_dense_times(kit):
    car = kit.box_car()
    played = replay(car, kit.drive(car, [0, 0.3, 1.0], [[1, 0], [2, 0]]))
    assert played.interval([0, 0.299, 0.3, 0.5, 1.0]).tolist() == [0, 0, 1, 1, 1]
    times = played.dense(0.2)
    assert times.tolist() == pytest.approx([0, 0.15, 0.3, 0.475, 0.65, 0.825, 1.0])
    assert played.at(times).shape == (7, 5)
    assert played.at(np.zeros((0,))).shape == (0, 5)
    assert played.at(0.3).shape == (5,)


@pytest.mark.parametrize(
    ("t", "v", "steering", "a"),
    [
        (1e9, 1.0, 0.1, 0.0),
        (10.0, 1e308, 0.1, 1e308),
        (1e5, 1e7, 0.5, 0.0),
        (10.0, 1.0, np.pi / 2 - 1e-9, 0.0),
    ],
)
def test_what_cannot_be_integrated_is_refused_in_one_sentence(kit, t, v, steering, a):
    states = np.zeros((2, 5))
    states[0] = [0, 0, 0, v, steering]
    with pytest.raises(InputError, match="cannot be integrated"):
        replay(kit.box_car(), Trajectory([0, t], states, [[a, 0]]))


def test_wrong_columns_are_refused(kit):
    trajectory = Trajectory([0, 1], np.zeros((2, 3)), np.zeros((1, 1)), ("x", "y", "theta"), ("v",))
    with pytest.raises(InputError, match="state_names"):
        replay(kit.box_car(), trajectory)


@pytest.mark.parametrize("seed", range(5))
def test_all_times_at_once_are_the_steps_one_after_the_other(seed: int) -> None:
    """The cascade of the single-track model is summed, other models are stepped: the same scheme."""
    rng = np.random.default_rng(seed)
    t = np.concatenate([[0.0], np.cumsum(rng.uniform(0.05, 2.0, 12))])
    inputs = rng.uniform([-1.0, -0.05], [1.0, 0.05], (12, 2))
    states = np.zeros((13, 5))
    states[0] = rng.uniform([-50, -50, -3, -1, -0.5], [50, 50, 3, 1, 0.5])
    drive = Trajectory(t, states, inputs)
    car = vehicle("paper")
    stepped = copy.copy(car)
    object.__setattr__(stepped, "cascade", ())
    at_once, one_by_one = replay(car, drive), replay(stepped, drive)
    assert (at_once.substeps == one_by_one.substeps).all()
    np.testing.assert_allclose(at_once.node_states, one_by_one.node_states, rtol=0, atol=1e-11)
    assert at_once.position_error == pytest.approx(one_by_one.position_error, rel=1e-3)


def test_the_cascade_names_every_state_once_and_looks_back_only() -> None:
    car = vehicle("paper")
    assert sorted(i for group in car.cascade for i in group) == list(range(car.n_states))
    rng = np.random.default_rng(0)
    state, control = rng.uniform(-0.5, 0.5, car.n_states), [0.3, -0.2]
    known: set[int] = set()
    for group in car.cascade:
        for later in set(range(car.n_states)) - known:
            moved = state.copy()
            moved[later] += 0.1
            before, after = (car.dynamics(list(at), control, np) for at in (state, moved))
            assert all(before[i] == after[i] for i in group)
        known |= set(group)


@pytest.mark.parametrize("in_core", [True, False])
def test_a_known_replay_of_the_same_motion_is_not_integrated_again(kit, in_core):
    car = kit.box_car()
    trajectory = kit.wander(car, seed=1)
    known = replay(car, trajectory, in_core=in_core)
    played = replay(car, replace(trajectory, states=known.knots), in_core=in_core, known=known)
    assert played.node_states is known.node_states
    assert played.defect == (0.0, 0.0), "the knots that are compared with the motion are the new ones"


def test_a_known_replay_of_something_else_is_not_believed(kit):
    car = kit.box_car()
    trajectory = kit.wander(car, seed=1)
    known = replay(car, trajectory)
    first = trajectory.states.copy()
    first[0, 0] += 1e-12
    later = np.append(trajectory.t[:-1], trajectory.t[-1] + 1e-9)
    others = {
        "vehicle": (kit.box_car(wheelbase=3.0), trajectory, {}),
        "start": (car, replace(trajectory, states=first), {}),
        "inputs": (car, replace(trajectory, inputs=0.999 * trajectory.inputs), {}),
        "times": (car, replace(trajectory, t=later), {}),
        "tolerance": (car, trajectory, {"tolerance": 1e-9}),
        "first step": (car, trajectory, {"first_step": 0.1}),
        "in NumPy": (car, trajectory, {"in_core": False}),
    }
    for name, (of, driven, options) in others.items():
        alone, played = replay(of, driven, **options), replay(of, driven, known=known, **options)
        assert played.node_states is not known.node_states, name
        np.testing.assert_array_equal(played.node_states, alone.node_states, err_msg=name)
        assert played.position_error == alone.position_error, name
