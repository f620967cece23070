"""plan.sample and plan.trajectory.sample: the certified motion at any time."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.verification import DrivenTrajectory, Plan, load_plan, save_plan, write_trajectory_csv

from .oracles import driven

TIMES = np.array([0.0, 0.3, 0.83, 1.2345, 2.5, 2.87, 3.333, 4.4, 5.3])


def test_it_is_the_motion_that_the_inputs_make(plan: Plan) -> None:
    assert np.abs(plan.sample(TIMES) - driven(plan, TIMES)).max() < 1e-6


def test_it_is_not_the_knots_interpolated(plan: Plan) -> None:
    middle = plan.trajectory.t[:2].mean()
    straight = plan.trajectory.states[:2].mean(axis=0)
    assert np.hypot(*(plan.sample(middle) - straight)[:2]) > 0.05


def test_at_the_knots_it_is_the_knots(plan: Plan) -> None:
    assert np.abs(plan.sample(plan.trajectory.t) - plan.trajectory.states).max() < 1e-8


def test_any_shape_of_times_may_be_asked_for(plan: Plan) -> None:
    assert plan.sample(1.0).shape == (5,)
    assert plan.sample([]).shape == (0, 5)
    grid = plan.sample(TIMES.reshape(3, 3))
    assert grid.shape == (3, 3, 5)
    assert np.array_equal(grid.reshape(9, 5), plan.sample(TIMES))
    assert np.array_equal(plan.sample(TIMES[::-1]), plan.sample(TIMES)[::-1])
    assert plan.sample_inputs(TIMES.reshape(3, 3)).shape == (3, 3, 2)


def test_inputs_hold_from_their_knot_on(plan: Plan) -> None:
    t, inputs = plan.trajectory.t, plan.trajectory.inputs
    assert np.array_equal(plan.sample_inputs(t[:-1]), inputs)
    assert np.array_equal(plan.sample_inputs(t[1:-1] - 1e-6), inputs[:-1])
    assert np.array_equal(plan.sample_inputs(t[-1]), inputs[-1])


def test_the_plan_answers_in_original_coordinates_its_trajectory_in_its_own(far_plan: Plan) -> None:
    there, here = far_plan.sample(TIMES), far_plan.trajectory.sample(TIMES)
    assert np.abs(there[:, :2] - here[:, :2] - far_plan.scenario.offset).max() < 1e-6
    assert np.array_equal(there[:, 2:], here[:, 2:])
    assert np.abs(here[:, :2]).max() < 100


@pytest.mark.parametrize("time", [-1e-3, 5.4, np.nan, np.inf])
def test_times_outside_are_refused(plan: Plan, time: float) -> None:
    for ask in (plan.sample, plan.trajectory.sample, plan.sample_inputs):
        with pytest.raises(InputError, match=r"is outside \[0, 5.3\] s"):
            ask([0.1, time])


def test_rounding_beyond_the_ends_is_forgiven(plan: Plan) -> None:
    end = plan.trajectory.t[-1]
    assert np.array_equal(plan.sample([-1e-12, end + 1e-12]), plan.sample([0.0, end]))


def test_what_is_no_time_is_refused(plan: Plan) -> None:
    with pytest.raises(InputError, match="must be a number"):
        plan.sample("soon")


def test_a_plan_read_from_a_file_can_be_sampled(plan: Plan, tmp_path) -> None:
    save_plan(plan, tmp_path / "plan.json")
    read = load_plan(tmp_path / "plan.json")
    assert isinstance(read.trajectory, DrivenTrajectory)
    assert np.array_equal(read.trajectory.sample(TIMES), plan.trajectory.sample(TIMES))


def test_a_trajectory_without_a_vehicle_says_what_it_needs(plan: Plan) -> None:
    lonely = dataclasses.replace(plan.trajectory, vehicle=None)
    with pytest.raises(InputError, match=r"DrivenTrajectory\.of\(trajectory, vehicle\)"):
        lonely.sample(0.0)
    assert DrivenTrajectory.of(lonely, plan.vehicle).sample(0.0) == pytest.approx(plan.trajectory.states[0])


def test_the_table_holds_these_states(plan: Plan, tmp_path) -> None:
    write_trajectory_csv(plan, tmp_path / "t.csv", dt=0.1)
    table = np.genfromtxt(tmp_path / "t.csv", delimiter=",", names=True)
    columns = np.column_stack([table[name] for name in table.dtype.names])
    assert table.dtype.names == ("t", "x", "y", "theta", "v", "delta", "a", "omega")
    assert np.array_equal(columns[:, 1:6], plan.sample(columns[:, 0]))
    assert set(plan.trajectory.t) <= set(columns[:, 0])
    assert np.diff(columns[:, 0]).max() <= 0.1 + 1e-12


@pytest.mark.parametrize("dt", [0.0, -1.0, np.nan, 1e-9])
def test_impossible_steps_are_refused(plan: Plan, dt: float, tmp_path) -> None:
    with pytest.raises(InputError, match="dt: "):
        write_trajectory_csv(plan, tmp_path / "t.csv", dt=dt)
    assert list(tmp_path.iterdir()) == []
