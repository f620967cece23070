"""Scenarios: immutability, parts, round trips, recentring."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from tightspot.errors import GeometryError, SceneError, VehicleError
from tightspot.geometry import ConvexPolygon
from tightspot.scenarios import Obstacle, Scenario, Tolerance


def test_plain_data_makes_the_round_trip_exactly(scene):
    scene["goal"]["v"] = None
    scene["obstacles"][0]["holes"] = [[[4.1, 4.1], [4.2, 4.1], [4.2, 4.2]]]
    first = Scenario.from_dict(scene).to_dict()
    text = json.dumps(first, allow_nan=False)
    assert Scenario.from_dict(json.loads(text)).to_dict() == first
    assert first["goal"]["v"] is None
    assert first["obstacles"][1]["vertices"] == scene["obstacles"][1]["vertices"]


@pytest.mark.parametrize("far", [(4484378811, -354286007), (2e4, 0), (123456.0, 1e7)])
def test_far_scenes_are_recentred_and_put_back(scene, far):
    near = Scenario.from_dict(scene)
    moved = near.with_(offset=np.array(far)).to_dict()
    scenario = Scenario.from_dict(moved)
    assert scenario.offset == pytest.approx(np.array(far), abs=1)
    assert np.abs(scenario.start[:2]).max() <= 1
    assert scenario.to_dict() == moved
    shift = scenario.offset - far
    for ours, theirs in zip(scenario.obstacles, near.obstacles, strict=True):
        assert ours.exterior + shift == pytest.approx(theirs.exterior, abs=1e-6)
        assert sum(p.area for p in ours.parts) == pytest.approx(sum(p.area for p in theirs.parts))


@pytest.mark.parametrize("start", [(4484378811.3, -354286007.7), (18000.11, 0.3), (1e9 + 0.1, -1e9 - 0.3)])
def test_a_far_scene_is_written_back_bit_for_bit(scene, start):
    x, y = start
    scene["start"] |= {"x": x, "y": y}
    left = x - 18000.1 if x < 1e5 else x - 50.1
    scene["goal"] |= {"x": left, "y": y + 1 / 3}
    scene["workspace"] = [[x - 9, y - 9], [x + 30.1, y - 9.3], [x + 30.7, y + 0.1], [left, y + 20]][::-1]
    scene["obstacles"] = [{"vertices": [[left, y], [x + 1 / 7, y - 0.1], [x, y + 1 / 3]]}]
    first = Scenario.from_dict(scene)
    assert first.offset.any()
    data = first.to_dict()
    assert data["obstacles"][0]["vertices"] == scene["obstacles"][0]["vertices"]
    assert {tuple(p) for p in data["workspace"]} == {tuple(p) for p in scene["workspace"]}
    assert (data["start"]["x"], data["goal"]["x"], data["goal"]["y"]) == (x, left, y + 1 / 3)
    assert Scenario.from_dict(data).to_dict() == data
    moved = first.with_(goal=first.goal + np.array([1, 0, 0, 0, 0]))
    assert moved.to_dict()["goal"]["x"] == pytest.approx(left + 1, abs=1e-6)


def test_near_scenes_stay_where_they_are(scene):
    scene["start"]["x"] = 9_000
    scenario = Scenario.from_dict(scene)
    assert (scenario.offset == 0).all()
    assert scenario.recentred() is scenario


def test_recentred_moves_everything_alike(scene):
    base = Scenario.from_dict(scene)
    step = np.array([30_000.0, -20_000.0])
    far = base.with_(
        workspace=base.workspace.transformed(*step, 0.0),
        obstacles=tuple(obstacle.shifted(step) for obstacle in base.obstacles),
        start=base.start + np.array([*step, 0, 0, 0]),
        goal=base.goal + np.array([*step, 0, 0, 0]),
    )
    near = far.recentred()
    assert near.offset == pytest.approx(step)
    assert near.start == pytest.approx(base.start)
    assert near.goal == pytest.approx(base.goal)
    assert near.workspace.vertices == pytest.approx(base.workspace.vertices)
    assert near.obstacles[1].exterior == pytest.approx(base.obstacles[1].exterior)
    assert near.to_dict()["start"] == far.to_dict()["start"]


def test_parts_have_unique_names_and_cover_the_obstacle(scene):
    names = [name for name, _ in Scenario.from_dict(scene).obstacle_parts]
    assert names == ["block/0", "L/0", "L/1"]


def test_a_scenario_cannot_be_changed_only_replaced(scene):
    scenario = Scenario.from_dict(scene)
    with pytest.raises(dataclasses.FrozenInstanceError):
        scenario.margin = 1.0
    with pytest.raises(ValueError, match="read-only"):
        scenario.start[0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        scenario.obstacles[0].exterior[0] = 1.0
    assert scenario.with_(margin=0.2).margin == 0.2
    assert scenario.margin == 0.05


def test_the_arrays_given_are_not_kept(scene):
    start = np.zeros(5)
    scenario = Scenario.from_dict(scene).with_(start=start)
    start[0] = 99.0
    assert scenario.start[0] == 0


def test_scenarios_made_in_python_are_checked_too(problems):
    square = ConvexPolygon.rectangle(-9, 9, -9, 9)
    wall = Obstacle("wall", [(1, 1), (2, 1), (2, 2)])

    def make():
        Scenario(
            name="bad",
            workspace=square,
            obstacles=(wall, wall),
            start=[0, np.nan, 0, 0, 0],
            goal=[0, 0, 90, 0, 2],
            margin=-1,
            tolerance=Tolerance(position=0.0),
            offset=np.array([np.nan, 0]),
        )

    assert set(problems(make)) == {
        "start.y",
        "goal.theta",
        "goal.delta",
        "margin",
        "offset",
        "tolerance.position",
        "obstacles[1].name",
    }


@pytest.mark.parametrize("state", [[0, 0], [0] * 4, "here", [[0] * 5], [0, 0, 0, "a", 0]])
def test_a_state_has_five_numbers(scene, state):
    with pytest.raises(SceneError, match="five numbers"):
        Scenario.from_dict(scene).with_(goal=state)


def test_a_pose_stands_still_with_straight_wheels(scene):
    assert Scenario.from_dict(scene).with_(goal=(1, 2, 3)).goal.tolist() == [1, 2, 3, 0, 0]


def test_an_obstacle_names_its_ring_when_it_is_none():
    with pytest.raises(GeometryError) as caught:
        Obstacle("bad", [(0, 0), (4, 0), (4, 4)], ([(1, 0.5), (2, 0.5)],))
    assert caught.value.problems[0].path.startswith("holes[0]")
    with pytest.raises(GeometryError) as caught:
        Obstacle("bad", [(0, 0), (1, np.nan), (4, 4)])
    assert caught.value.problems[0].path == "vertices[1]"


def test_an_unknown_vehicle_is_refused_when_it_is_asked_for(scene):
    with pytest.raises(VehicleError):
        Scenario.from_dict(scene).with_(vehicle="tank").vehicle_model()


@pytest.mark.parametrize("far", [0.0, 4.5e9, 2.00001e4 + 0.1])
def test_free_steering_leaves_all_else_bit_for_bit(scene, far):
    for key in ("start", "goal"):
        scene[key]["x"] += far
    scene["workspace"]["x"] = [far - 10, far + 20]
    scene["obstacles"] = []
    scenario = Scenario.from_dict(scene)
    freed = scenario.with_free_steering()
    assert np.isnan([freed.start[4], freed.goal[4]]).all()
    expected = scenario.to_dict()
    for key in ("start", "goal"):
        expected[key]["delta"] = None
    assert freed.to_dict() == expected
    assert freed.with_free_steering().to_dict() == expected
