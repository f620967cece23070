"""Hybrid A* as a guess: free of collisions, from start to goal, drivable."""

import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.geometry import ConvexPolygon, clearance, transform
from tightspot.guesses import HybridAStar
from tightspot.scenarios import Obstacle, Scenario
from tightspot.scenarios.library import builtin
from tightspot.verification import minimum_clearance

NAMES = ("vertical", "parallel", "oblique", "forklift-pallet")


@pytest.fixture(scope="module", params=NAMES)
def found(request):
    scene = builtin(request.param)
    car = scene.vehicle_model()
    return scene, car, HybridAStar().make(scene, car, margin=0.05)


def test_start_goal_and_limits(found):
    scene, car, result = found
    trajectory = result.trajectory
    known = ~np.isnan(scene.goal)
    np.testing.assert_allclose(trajectory.states[0, :3], scene.start[:3], atol=1e-9)
    difference = (trajectory.states[-1] - scene.goal)[known]
    difference[2] = (difference[2] + np.pi) % (2 * np.pi) - np.pi
    assert np.abs(difference).max() < 0.02
    (low, high), (input_low, input_high) = car.state_bounds, car.input_bounds
    assert (trajectory.states >= low - 1e-9).all()
    assert (trajectory.states <= high + 1e-9).all()
    assert (trajectory.inputs >= input_low - 1e-9).all()
    assert (trajectory.inputs <= input_high + 1e-9).all()


def test_the_standing_lift_has_no_collision_at_any_time(found):
    scene, car, _ = found
    result = HybridAStar(lift="standing").make(scene, car, margin=0.05)
    series = minimum_clearance(scene, car, result.trajectory, dt=0.02)
    assert series.minimum > 0
    assert series.workspace.min() > -1e-9


def test_the_rolling_lift_has_no_collision_at_its_poses(found):
    scene, car, result = found
    for part in car.parts:
        bodies = transform(part.polygon.vertices, result.trajectory.poses)
        for _, obstacle in scene.obstacle_parts:
            assert clearance(bodies, obstacle.vertices).min() > 0.05 - 2.5e-3
        assert (bodies @ scene.workspace.A.T <= scene.workspace.b + 2.5e-3).all()


def test_both_lifts_drive_the_same_path(found):
    scene, car, rolling = found
    standing = HybridAStar(lift="standing").make(scene, car, margin=0.05)
    np.testing.assert_array_equal(standing.details.path.arcs, rolling.details.path.arcs)
    turns = (standing.trajectory.states[-1, :3] - rolling.trajectory.states[-1, :3]) / (2 * np.pi)
    np.testing.assert_allclose(turns, [0, 0, np.round(turns[2])], atol=1e-4)
    assert rolling.trajectory.duration < standing.trajectory.duration


def test_an_unknown_lift_is_refused():
    with pytest.raises(InputError, match="rolling, standing"):
        HybridAStar(lift="flying")


def test_seeds_lead_to_other_courses_and_the_same_to_the_same():
    scene = builtin("parallel")
    car = scene.vehicle_model()
    first, again, other = (HybridAStar(seed=seed).make(scene, car, margin=0.05) for seed in (3, 3, 4))
    np.testing.assert_array_equal(first.trajectory.states, again.trajectory.states)
    assert first.details.path.arcs.tolist() != other.details.path.arcs.tolist()


@pytest.mark.parametrize("seed", [-1, 0.5, np.nan, "x", True])
def test_a_seed_is_a_whole_number(seed):
    scene = builtin("vertical")
    with pytest.raises(InputError, match="seed"):
        HybridAStar(seed=seed).make(scene, scene.vehicle_model(), margin=0.05)


def test_the_report_says_what_was_tried(found):
    _, _, result = found
    assert result.report["expansions"] > 0
    assert result.report["path_length"] > 1
    assert result.reason
    assert result.details.path is not None


def test_no_way_is_a_result_with_its_reason():
    wall = Obstacle("wall", np.array([(5, -4), (6, -4), (6, 4), (5, 4)]))
    scene = Scenario(
        name="divided",
        workspace=ConvexPolygon.rectangle(-2, 14, -4, 4),
        obstacles=(wall,),
        start=[0, 0, 0, 0, 0],
        goal=[8, 0, 0, 0, 0],
        vehicle="forklift",
    )
    car = scene.vehicle_model()
    result = HybridAStar().make(scene, car, margin=0.0)
    assert result.trajectory is None
    assert result.reason
    start = transform(car.parts[0].polygon.vertices, scene.start[:3])
    assert float(clearance(start, wall.parts[0].vertices)) > 0, "the start itself is free"
