"""The simplified model of eq. (26): its own dynamics, W, the goal, and the full states made of it."""

import numpy as np
import pytest

from tightspot.geometry import ConvexPolygon, transform
from tightspot.guesses import SimplifiedModel
from tightspot.guesses.simplified import ReducedSingleTrack
from tightspot.scenarios import Scenario
from tightspot.scenarios.library import builtin
from tightspot.solvers import Ipopt
from tightspot.vehicles import vehicle

CAR = vehicle("paper")
SCENES = [builtin(name) for name in ("vertical", "parallel", "oblique")]
each_scene = pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)


@pytest.fixture(scope="module")
def guesses():
    return {scene.name: SimplifiedModel().make(scene, CAR, margin=0.05) for scene in SCENES}


@each_scene
def test_it_goes_from_start_to_goal(guesses, scene):
    trajectory = guesses[scene.name].trajectory
    assert trajectory.steps == 20
    np.testing.assert_allclose(trajectory.states[0], scene.start, atol=1e-8)
    np.testing.assert_allclose(trajectory.states[-1], scene.goal, atol=1e-8)


@each_scene
def test_speed_and_steering_are_within_the_limits(guesses, scene):
    trajectory = guesses[scene.name].trajectory
    (low, high), (input_low, input_high) = CAR.state_bounds, CAR.input_bounds
    assert (trajectory.states >= low - 1e-8).all()
    assert (trajectory.states <= high + 1e-8).all()
    assert (trajectory.inputs >= input_low).all()
    assert (trajectory.inputs <= input_high).all()


@each_scene
def test_the_body_stays_in_the_workspace_at_the_knots(guesses, scene):
    V = transform(CAR.parts[0].polygon.vertices, guesses[scene.name].trajectory.poses)
    assert (scene.workspace.b + 1e-6 >= V @ scene.workspace.A.T).all()


@each_scene
def test_each_step_is_an_arc_that_the_car_can_drive(guesses, scene):
    """The reduced dynamics: one constant speed and steering angle a step."""
    trajectory = guesses[scene.name].trajectory
    theta, steps = trajectory.column("theta"), np.diff(trajectory.poses, axis=0)
    turned = steps[:, 2]
    chord = np.hypot(steps[:, 0], steps[:, 1])
    along = steps[:, 0] * np.cos(theta[:-1] + turned / 2) + steps[:, 1] * np.sin(theta[:-1] + turned / 2)
    np.testing.assert_allclose(np.abs(along), chord, atol=1e-5, err_msg="an arc's chord has its mean heading")
    length = chord / np.sinc(turned / (2 * np.pi))
    assert (np.abs(turned) <= length / CAR.min_turning_radius + 1e-6).all()
    assert (length <= CAR.limits.speed[1] * np.diff(trajectory.t) + 1e-6).all()


def test_the_reduced_model_is_the_car_s_with_speed_and_steering_as_inputs():
    reduced = ReducedSingleTrack(CAR)
    full = CAR.dynamics([1, 2, 0.3, -0.8, 0.4], [0, 0], np)
    np.testing.assert_array_equal(reduced.dynamics([1, 2, 0.3], [-0.8, 0.4], np), full[:3])
    np.testing.assert_array_equal(reduced.input_bounds, np.array(CAR.state_bounds)[:, 3:])
    states, controls = np.zeros((2, 3)), np.array([[1.0, 0.2], [-0.5, -0.6]])
    (bounds,) = reduced.motion_bounds(states, states, controls)
    np.testing.assert_allclose(bounds.yaw_rate, np.abs(controls[:, 0]) * np.tan(np.abs(controls[:, 1])) / CAR.wheelbase)
    assert reduced.to_dict()["car"]["name"] == "paper"


def test_no_solution_is_a_result_with_its_reason():
    boxed = Scenario(
        name="boxed",
        workspace=ConvexPolygon.rectangle(-1.5, 4.5, -1.5, 1.5),
        obstacles=(),
        start=[0, 0, 0, 0, 0],
        goal=[0, 0, np.pi, 0, 0],
    )
    result = SimplifiedModel(solver=Ipopt(max_iterations=60)).make(boxed, CAR, margin=0.0)
    assert result.trajectory is None
    assert "no solution" in result.reason
    assert result.report["status"] != "SOLVED"
