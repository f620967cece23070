"""Legs and samples of a motion."""

from __future__ import annotations

import numpy as np
import pytest

from tightspot.plotting.motion import Leg, dense_motion, drive_legs, spaced, travelled
from tightspot.trajectory import Trajectory
from tightspot.verification import Plan


def straight(speeds: list[float]) -> Trajectory:
    """Along x, with these speeds at knots one second apart, by the trapezium rule."""
    v = np.array(speeds)
    x = np.concatenate([[0.0], np.cumsum((v[:-1] + v[1:]) / 2)])
    states = np.zeros((v.size, 5))
    states[:, 0], states[:, 3] = x, v
    return Trajectory(np.arange(v.size, dtype=float), states, np.zeros((v.size - 1, 2)))


def test_legs_begin_where_the_speed_changes_sign(plan: Plan) -> None:
    motion = dense_motion(plan.vehicle, plan.trajectory)
    legs = drive_legs(motion)
    assert [leg.gear for leg in legs] == [1, -1, 1]
    assert motion.t[[leg.first for leg in legs]] == pytest.approx([0.0, 8.0, 14.0])
    assert motion.t[[leg.last for leg in legs]] == pytest.approx([8.0, 14.0, 18.0])


def test_standing_still_belongs_to_the_leg_before() -> None:
    assert drive_legs(straight([0, 1, 0, 0, 0, -1, 0])) == [Leg(1, 0, 4), Leg(-1, 4, 6)]


def test_waiting_at_the_start_belongs_to_the_first_leg() -> None:
    assert drive_legs(straight([0, 0, -1, 0])) == [Leg(-1, 0, 3)]


def test_a_solvers_rounding_is_no_gear_change() -> None:
    assert drive_legs(straight([0, 1, 1e-4, -1e-4, 1e-4, 1, 0])) == [Leg(1, 0, 6)]
    assert drive_legs(straight([0, -1e-7, 1, 0])) == [Leg(1, 0, 3)]


def test_a_motion_that_never_moves_is_one_leg() -> None:
    assert drive_legs(straight([0, 0, 0])) == [Leg(1, 0, 2)]


def test_travelled_counts_both_directions() -> None:
    assert travelled(straight([0, 2, 0, -2, 0]).poses) == pytest.approx([0, 1, 2, 3, 4])


def test_dense_motion_passes_through_the_knots_with_the_knots_inputs(plan: Plan) -> None:
    motion = dense_motion(plan.vehicle, plan.trajectory)
    at_knots = np.searchsorted(motion.t, plan.trajectory.t)
    assert motion.t[at_knots] == pytest.approx(plan.trajectory.t)
    assert motion.states[at_knots] == pytest.approx(plan.trajectory.states, abs=1e-6)
    assert np.diff(motion.t).max() <= 0.02 + 1e-9
    middles = (motion.t[:-1] + motion.t[1:]) / 2
    assert (motion.inputs == plan.trajectory.inputs[middles.astype(int)]).all()


def test_spaced_samples_are_even_and_keep_both_ends() -> None:
    states = np.column_stack([np.linspace(0, 10, 1001), np.zeros(1001), np.zeros(1001)])
    chosen = spaced(states, 1.0)
    assert len(chosen) == 11
    assert states[chosen, 0] == pytest.approx(np.arange(11.0), abs=0.011)


def test_spaced_samples_see_a_turn_on_the_spot() -> None:
    states = np.column_stack([np.zeros(101), np.zeros(101), np.linspace(0, np.pi, 101)])
    assert len(spaced(states, 0.5)) == 7


def test_spaced_samples_of_a_standing_vehicle() -> None:
    assert spaced(np.zeros((5, 3)), 1.0) == [0, 4]
