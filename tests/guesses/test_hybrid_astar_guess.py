"""Hybrid A* as a guess: free of collisions at all times, drivable, from start to goal."""

import numpy as np
import pytest

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


def test_no_collision_at_any_time(found):
    scene, car, result = found
    series = minimum_clearance(scene, car, result.trajectory, dt=0.02)
    assert series.minimum > 0
    assert series.workspace.min() > -1e-9


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
