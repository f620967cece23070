"""The built-in scenes: complete, explained, takeable with their own vehicle and margin."""

from __future__ import annotations

import json

import numpy as np
import pytest

from tightspot.errors import SceneError
from tightspot.geometry import ConvexPolygon, clearance
from tightspot.scenarios import Scenario, builtin, check, load, names, summaries, workspace_excess
from tightspot.scenarios import clearance as standing_clearance
from tightspot.search import HybridAStarOptions, SearchStatus, search


@pytest.mark.parametrize("name", names())
def test_every_scene_is_explained_and_can_be_taken_with_a_reserve(name):
    scenario = builtin(name)
    assert scenario.name == name
    assert scenario.description
    assert scenario.source
    model = scenario.vehicle_model()
    check(scenario, model, 0.06)
    for state in (scenario.start, scenario.goal):
        assert standing_clearance(scenario, model, state).value > 0.09
        assert workspace_excess(scenario, model, state)[0] < -0.3


@pytest.mark.parametrize("name", names())
def test_scenes_make_the_round_trip(name):
    data = builtin(name).to_dict()
    assert Scenario.from_dict(json.loads(json.dumps(data))).to_dict() == data


def test_the_papers_geometry_is_table_one_with_its_misprints_mended():
    halfplanes = {
        "vertical": [
            [(0, 1, -2), (1, 0, 5), (0, -1, 8), (-1, 0, 0)],
            [(0, 1, -2), (-1, 0, -7.5), (0, -1, 8), (1, 0, 15)],
        ],
        "parallel": [
            [(0, 1, -3), (1, 0, 5), (0, -1, 6), (-1, 0, 0)],
            [(0, 1, -3), (-1, 0, -11.98), (0, -1, 6), (1, 0, 20)],
        ],
        "oblique": [
            [(0, 1, -2), (-1, 0, 7), (0, -1, 8), (1, 0, 2)],
            [(0, 1, -2), (-1, 1, -11), (0, -1, 8), (1, 0, 18)],
        ],
    }
    boxes = {"vertical": (-2, 15, -8, 8), "parallel": (-2, 22, -6, 8), "oblique": (-4, 20, -8, 4)}
    for name, table in halfplanes.items():
        scenario = builtin(name)
        for obstacle, rows in zip(scenario.obstacles, table, strict=True):
            expected = ConvexPolygon.from_halfplanes([row[:2] for row in rows], [row[2] for row in rows])
            assert np.array(sorted(obstacle.exterior.tolist())) == pytest.approx(
                np.array(sorted(expected.vertices.tolist()))
            )
        assert scenario.workspace == ConvexPolygon.rectangle(*boxes[name])
        assert (scenario.start == 0).all()
    assert builtin("vertical").goal[:3] == pytest.approx([6.3, -6.7, np.pi / 2])
    assert builtin("parallel").goal[:3] == pytest.approx([6.9, -4.3, 0])
    assert builtin("oblique").goal[:3] == pytest.approx([4, -5, np.pi / 4])


def test_our_own_scenes_have_nonconvex_obstacles():
    for name in ("garage", "dead-end", "loading-dock", "forklift-pallet"):
        scenario = builtin(name)
        assert len(scenario.obstacle_parts) > len(scenario.obstacles), name


def test_the_forklifts_bounding_box_would_collide():
    scenario = builtin("forklift-pallet")
    corners = np.vstack([part.polygon.vertices for part in scenario.vehicle_model().parts])
    (x0, y0), (x1, y1) = corners.min(axis=0), corners.max(axis=0)
    bounding_box = ConvexPolygon.rectangle(x0, x1, y0, y1).transformed(*scenario.goal[:3])
    gaps = [clearance(bounding_box.vertices, part.vertices) for _, part in scenario.obstacle_parts]
    assert min(gaps) < -0.5


def test_summaries_are_plain_data():
    listed = json.loads(json.dumps(summaries()))
    assert [item["name"] for item in listed] == list(names())
    assert all(item["description"] and item["margin"] == 0.05 for item in listed)
    assert {item["vehicle"] for item in listed} == {"paper", "tpcap", "lincoln-mkz", "forklift"}
    assert all(item["parts"] >= item["obstacles"] >= 2 for item in listed)


def test_unknown_names_get_the_nearest_and_how_to_list_them():
    with pytest.raises(SceneError, match=r"did you mean 'vertical'\?|did you mean vertical\?"):
        builtin("vertcal")
    with pytest.raises(SceneError, match=r"did you mean parallel\? `tightspot scenes`"):
        load("paralel")


@pytest.mark.parametrize("name", names())
def test_there_is_a_way_to_every_goal_with_a_reserve(name):
    scenario = builtin(name)
    result = search(
        scenario.workspace,
        [part for _, part in scenario.obstacle_parts],
        scenario.vehicle_model(),
        scenario.start[:3],
        scenario.goal[:3],
        HybridAStarOptions(margins=(0.06,), time_limit=60),
    )
    assert result.status is SearchStatus.FOUND
    assert result.path is not None
    for pose in result.path.poses:
        body = [part.polygon.transformed(*pose).vertices for part in scenario.vehicle_model().parts]
        gaps = [clearance(vertices, part.vertices) for vertices in body for _, part in scenario.obstacle_parts]
        assert min(gaps) > 0.06 - 0.002


def test_the_dead_end_needs_several_gear_changes():
    scenario = builtin("dead-end")
    parts = [part for _, part in scenario.obstacle_parts]
    options = HybridAStarOptions(margins=(0.05,), time_limit=60)
    result = search(scenario.workspace, parts, scenario.vehicle_model(), scenario.start[:3], scenario.goal[:3], options)
    assert result.path is not None
    assert result.path.gear_changes >= 3
