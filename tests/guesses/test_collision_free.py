"""The simplified model among the obstacles, eq. (27)."""

import numpy as np
import pytest

from tightspot.formulations import FarkasDual, SeparatingLine
from tightspot.geometry import ConvexPolygon, clearance, transform
from tightspot.guesses import GUESSES, CollisionFreeModel, SimplifiedModel, guess
from tightspot.scenarios import Obstacle, Scenario
from tightspot.scenarios.library import builtin
from tightspot.solvers import Ipopt
from tightspot.vehicles import vehicle

CAR = vehicle("paper-recovered")
MARGIN = 2e-3
SCENES = [builtin(name) for name in ("vertical", "oblique")]
each_scene = pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)


def clearances(scene, trajectory):
    """Of the body from each obstacle part at the knots after the start, m."""
    V = transform(CAR.parts[0].polygon.vertices, trajectory.poses[1:])
    return np.stack([clearance(V, polygon.vertices) for _, polygon in scene.obstacle_parts])


@pytest.fixture(scope="module")
def results():
    return {scene.name: CollisionFreeModel(heading_limit=np.pi).make(scene, CAR, margin=MARGIN) for scene in SCENES}


def test_the_registry_knows_it_by_all_its_names():
    assert GUESSES["collision-free"] is CollisionFreeModel
    assert isinstance(guess("collision_free"), CollisionFreeModel)
    assert isinstance(guess("CollisionFreeModel"), CollisionFreeModel)


def test_the_paper_s_formulation_is_the_default():
    assert CollisionFreeModel().formulation == FarkasDual()
    assert CollisionFreeModel.collision_free
    assert not SimplifiedModel.collision_free


@each_scene
def test_it_goes_from_start_to_goal_and_keeps_clear_at_the_knots(results, scene):
    trajectory = results[scene.name].trajectory
    np.testing.assert_allclose(trajectory.states[0], scene.start, atol=1e-7)
    np.testing.assert_allclose(trajectory.states[-1], scene.goal, atol=1e-7)
    assert clearances(scene, trajectory).min() >= MARGIN - 1e-6


@each_scene
def test_limits_and_workspace_hold(results, scene):
    trajectory = results[scene.name].trajectory
    (low, high), (input_low, input_high) = CAR.state_bounds, CAR.input_bounds
    assert (trajectory.states >= low - 1e-7).all()
    assert (trajectory.states <= high + 1e-7).all()
    assert (trajectory.inputs >= input_low).all()
    assert (trajectory.inputs <= input_high).all()
    assert (np.abs(trajectory.column("theta")) <= np.pi + 1e-7).all()
    V = transform(CAR.parts[0].polygon.vertices, trajectory.poses)
    assert (scene.workspace.b + 1e-6 >= V @ scene.workspace.A.T).all()


def test_seeing_the_obstacles_is_what_distinguishes_it(results):
    scene = SCENES[0]
    blind = SimplifiedModel(heading_limit=np.pi).make(scene, CAR, margin=MARGIN)
    assert clearances(scene, blind.trajectory).min() < 0 < clearances(scene, results[scene.name].trajectory).min()


def test_another_formulation_can_be_chosen():
    scene = SCENES[0]
    result = CollisionFreeModel(formulation=SeparatingLine()).make(scene, CAR, margin=0.02)
    assert clearances(scene, result.trajectory).min() >= 0.02 - 1e-6


def test_without_obstacles_it_is_the_simplified_model():
    free = Scenario(
        name="free",
        workspace=ConvexPolygon.rectangle(-5, 25, -10, 10),
        obstacles=(),
        start=[0, 0, 0, 0, 0],
        goal=[12, 2, 0.2, 0, 0],
    )
    ours, theirs = (member().make(free, CAR, margin=0.1) for member in (CollisionFreeModel, SimplifiedModel))
    np.testing.assert_allclose(ours.trajectory.states, theirs.trajectory.states, atol=1e-4)


def test_no_solution_is_a_result_with_its_reason():
    wall = Obstacle("wall", ConvexPolygon.rectangle(5, 6, -10, 10).vertices)
    walled = Scenario(
        name="walled",
        workspace=ConvexPolygon.rectangle(-5, 25, -10, 10),
        obstacles=(wall,),
        start=[0, 0, 0, 0, 0],
        goal=[12, 2, 0.2, 0, 0],
    )
    result = CollisionFreeModel(solver=Ipopt(max_iterations=150, time_limit=5.0)).make(walled, CAR, margin=0.1)
    assert result.trajectory is None
    assert "with obstacles has no solution" in result.reason
    assert result.report["status"] != "SOLVED"
