"""A vehicle of one's own, derived from a known one: what its parent states of its motion is not taken for its own."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import tightspot
from tightspot.errors import InputError, PlanFileError, VehicleError
from tightspot.geometry import clearance, transform
from tightspot.scenarios.library import builtin
from tightspot.trajectory import Trajectory
from tightspot.vehicles import SingleTrack, VehicleModel, vehicle
from tightspot.verification import check_certificate, replay, save_plan, verify
from tightspot.verification.lemma import Lemma

DRAG = 0.02


class Dragging:
    """v' = a - DRAG v."""

    def dynamics(self, state, control, ns):
        rates = SingleTrack.dynamics(self, state, control, ns)
        return [*rates[:3], rates[3] - DRAG * state[3], rates[4]]


class Unstated(Dragging, SingleTrack):
    """Its motion bounds would be those of a car without drag."""


class Stated(Unstated):
    def motion_bounds(self, before, after, controls):
        fastest = np.maximum(np.abs(before), np.abs(after))
        slowed = np.abs(controls) + [DRAG, 0.0] * fastest[:, [3, 4]]
        return SingleTrack.motion_bounds(self, fastest, fastest, slowed)


class Sideways(SingleTrack):
    """The body's frame is elsewhere."""

    def frames(self, state, ns):
        return [(state[0] + 1.0, state[1], state[2])]


def car(kind):
    known = vehicle("paper")
    return kind("mine", known.wheelbase, known.body, known.limits)


def integrated(model, trajectory):
    """The states at the knots, by another library."""
    states = [trajectory.states[0]]
    for t, u in zip(zip(trajectory.t[:-1], trajectory.t[1:], strict=True), trajectory.inputs, strict=True):
        flow = solve_ivp(lambda _, x, u=u: model.dynamics(x, u, np), t, states[-1], rtol=1e-10, atol=1e-12)
        states.append(flow.y[:, -1])
    return np.array(states)


def drive():
    t, inputs = np.linspace(0.0, 8.0, 9), np.tile([[0.4, 0.1], [-0.3, -0.1]], (4, 1))
    states = np.zeros((9, 5))
    return Trajectory(t, states, inputs)


@pytest.mark.parametrize("kind", [Unstated, Stated, SingleTrack])
def test_the_judge_replays_the_models_own_dynamics(kind):
    np.testing.assert_allclose(replay(car(kind), drive()).knots, integrated(car(kind), drive()), atol=1e-5)


def test_the_checker_moves_as_the_model_does():
    trajectory = drive()
    moved = Lemma.of(car(Stated), trajectory, trajectory.t).motion
    at_knots = moved.states[np.searchsorted(moved.times, trajectory.t)]
    np.testing.assert_allclose(at_knots, integrated(car(Stated), trajectory), atol=1e-4)


@pytest.mark.parametrize("kind", [Unstated, Sideways])
def test_bounds_of_another_motion_are_asked_for(kind):
    sentence = f"{kind.__name__} has dynamics or frames of its own; define motion_bounds"
    with pytest.raises(VehicleError, match=sentence):
        car(kind).fastest()
    with pytest.raises(VehicleError, match=sentence):
        verify(builtin("oblique"), car(kind), drive())


def test_a_plan_asks_for_them_too():
    with pytest.raises(VehicleError, match="Unstated has dynamics or frames of its own"):
        tightspot.plan("oblique", vehicle=car(Unstated))


def test_what_is_stated_of_the_same_motion_is_kept():
    class Renamed(SingleTrack):
        """Only another name."""

    assert Renamed.cascade == SingleTrack.cascade
    assert Renamed.motion_bounds is SingleTrack.motion_bounds
    assert Renamed.acceleration_bound is SingleTrack.acceleration_bound
    assert Unstated.cascade == Stated.cascade == ()
    assert Unstated.acceleration_bound is VehicleModel.acceleration_bound
    assert Sideways.cascade == SingleTrack.cascade


def test_the_acceleration_bound_is_that_of_the_stated_motion():
    mine = car(Stated)
    (bounds,) = mine.fastest()
    rho = 3.0
    wanted = bounds.acceleration[0] + (bounds.yaw_acceleration[0] + bounds.yaw_rate[0] ** 2) * rho
    assert mine.acceleration_bound(0, rho, [0.0] * 5, [0.0] * 2, 0.5, np) == pytest.approx(wanted)


def test_a_certified_plan_is_free_when_another_library_drives_it():
    mine = car(Stated)
    plan = tightspot.plan("oblique", vehicle=mine, margin=0.02)
    states = integrated(mine, plan.trajectory)
    body = transform(mine.parts[0].polygon.vertices, states[:, :3])
    assert np.abs(states[-1, :2] - plan.scenario.goal[:2]).max() < plan.scenario.tolerance.position
    assert min(clearance(body, part.vertices).min() for _, part in plan.scenario.obstacle_parts) >= 0.02 - 1e-4
    assert check_certificate(plan.scenario, mine, plan.trajectory, plan.certificate).ok


def test_a_plan_of_another_motion_is_not_written_as_one_of_a_single_track(tmp_path):
    plan = tightspot.plan("oblique", vehicle=car(Stated), margin=0.02)
    with pytest.raises(PlanFileError, match="vehicle: class Stated has a motion of its own"):
        save_plan(plan, tmp_path / "plan.json")
    assert not list(tmp_path.iterdir())


class Towing(Dragging, SingleTrack):
    """One more state than scenes speak of."""

    state_names = (*SingleTrack.state_names, "theta1")
    state_units = (*SingleTrack.state_units, "rad")


def test_a_model_of_other_states_than_a_scene_s_is_told_apart():
    with pytest.raises(InputError, match=r"vehicle: model Towing has the 6 states .*theta1.* choose a model with 5"):
        tightspot.plan("vertical", vehicle=car(Towing))
