"""Bad scene objects: each kind is refused with its path in the file and a sentence; what is input passes."""

from __future__ import annotations

import json
import math
from typing import Any

import jsonschema
import numpy as np
import pytest
from shapely import Polygon
from shapely.ops import unary_union

from tightspot.errors import SceneError
from tightspot.scenarios import Scenario, json_schema
from tightspot.scenarios.schema import MAX_CORNERS, MAX_VERTICES

Path = tuple[Any, ...]
REMOVE = object()
BOW_TIE = [[0, 0], [1, 1], [1, 0], [0, 1]]

BAD = [
    # what is set where, the path of the problem, words of its sentence
    (("start",), REMOVE, "start", "missing"),
    (("goal",), None, "goal", "missing"),
    (("goal", "theta"), REMOVE, "goal.theta", "missing"),
    (("start",), [0, 0, 0], "start", "an object with keys"),
    (("start", "x"), "far", "start.x", "must be a number, but is 'far'"),
    (("start", "x"), None, "start.x", "nothing"),
    (("start", "x"), True, "start.x", "YAML also reads yes"),
    (("start", "x"), float("nan"), "start.x", "not finite"),
    (("start", "x"), float("inf"), "start.x", "not finite"),
    (("start", "x"), 10**400, "start.x", "not finite"),
    (("start", "x"), 1e12, "start.x", "are these metres"),
    (("start", "theta"), 90, "start.theta", "90 deg = 1.5708 rad"),
    (("goal", "theta"), -180.0, "goal.theta", "looks like degrees"),
    (("goal", "delta"), 30, "goal.delta", "30 deg = 0.523599 rad"),
    (("goal", "delta"), math.pi / 2, "goal.delta", "not below pi/2"),
    (("start", "heading"), 0.0, "start.heading", "did you mean 'theta'"),
    (("start", "speed"), 0.0, "start.speed", "did you mean 'v'"),
    (("obstacle",), [], "obstacle", "did you mean 'obstacles'"),
    (("polygons",), [], "polygons", "known are"),
    (("bounds",), {}, "bounds", "did you mean 'workspace'"),
    (("obstacles",), {}, "obstacles", "must be a list"),
    (("obstacles", 0), 7, "obstacles[0]", "an object with keys"),
    (("obstacles", 0, "vertices"), REMOVE, "obstacles[0].vertices", "missing"),
    (("obstacles", 0, "vertices"), [], "obstacles[0].vertices", "no points"),
    (("obstacles", 0, "vertices"), [[0, 0], [1, 1]], "obstacles[0].vertices", "three"),
    (("obstacles", 0, "vertices"), [[0, 0], [1, 1], [0, 0]], "obstacles[0].vertices", "three"),
    (("obstacles", 0, "vertices"), [[0, 0], [1, 1], [2, 2], [3, 3]], "obstacles[0].vertices", "zero area"),
    (("obstacles", 1, "vertices"), BOW_TIE, "obstacles[1].vertices", "crosses"),
    (("obstacles", 0, "vertices", 2), [1], "obstacles[0].vertices[2]", "two numbers [x, y]"),
    (("obstacles", 0, "vertices", 2), [1, 2, 3], "obstacles[0].vertices[2]", "two numbers [x, y]"),
    (("obstacles", 0, "vertices", 2), [1, "a"], "obstacles[0].vertices[2]", "'a'"),
    (("obstacles", 0, "vertices", 2), [1, float("nan")], "obstacles[0].vertices[2]", "not finite"),
    (("obstacles", 0, "vertices", 2), [1, 1e308], "obstacles[0].vertices[2]", "are these metres"),
    (("obstacles", 0, "polygon"), [], "obstacles[0].polygon", "did you mean 'vertices'"),
    (("obstacles", 0, "name"), "a\nb", "obstacles[0].name", "cannot be printed"),
    (("obstacles", 0, "name"), "", "obstacles[0].name", "is empty"),
    (("obstacles", 0, "holes"), [[[7, 7], [8, 7], [8, 8]]], "obstacles[0].holes[0]", "outside"),
    (("obstacles", 0, "holes"), [[[5, 5]]], "obstacles[0].holes[0]", "three"),
    (("workspace",), "big", "workspace", "list of corners or an object"),
    (("workspace",), {"x": [0, 1]}, "workspace.y", "missing"),
    (("workspace", "x"), [20, -10], "workspace.x", "lower bound 20 is not below the upper bound -10"),
    (("workspace", "x"), [3, 3], "workspace.x", "not below"),
    (("workspace", "z"), [0, 1], "workspace.z", "known are x, y"),
    (("workspace",), [[0, 0], [1, 0]], "workspace", "three"),
    (("workspace",), [[0, 0], [1, "b"], [1, 1]], "workspace[1]", "'b'"),
    (("workspace",), BOW_TIE, "workspace", "crosses"),
    (("workspace",), [[0, 0], [2, 0], [2, 2], [4, 2], [4, 4], [2, 4], [2, 2], [0, 2]], "workspace", "touches itself"),
    (
        ("workspace",),
        {"vertices": [[0, 0], [9, 0], [9, 9]], "holes": [[[1, 8], [2, 8], [2, 9]]]},
        "workspace.holes[0]",
        "outside the exterior",
    ),
    (("workspace",), {"vertices": [[0, 0], [9, 0]]}, "workspace", "three"),
    (("workspace",), {"vertices": [[0, 0], [9, 0], [9, 9]], "hols": []}, "workspace.hols", "did you mean 'holes'"),
    (("format",), "tightspot-scene/2", "format", "not known to this version"),
    (("name",), 5, "name", "must be text"),
    (("name",), "x" * 300, "name", "too long"),
    (("margin",), -0.1, "margin", "at least 0"),
    (("margin",), 50, "margin", "at most 10"),
    (("tolerance",), {"position": 0}, "tolerance.position", "more than 0"),
    (("tolerance",), {"heading": 5}, "tolerance.heading", "at most 3.14"),
    (("tolerance",), {"angle": 0.1}, "tolerance.angle", "known are"),
    (("vehicle",), "papre", "vehicle", "did you mean 'paper'"),
    (("vehicle",), 5, "vehicle", "a name or an object"),
    (("vehicle",), {"wheelbase": -1}, "vehicle.wheelbase", "more than 0"),
]


def _changed(data: dict[str, Any], where: Path, value: Any) -> dict[str, Any]:
    target: Any = data
    for key in where[:-1]:
        target = target[key]
    if value is REMOVE:
        del target[where[-1]]
    else:
        target[where[-1]] = value
    return data


@pytest.mark.parametrize(("where", "value", "path", "words"), BAD)
def test_each_kind_of_mistake_has_its_path_and_sentence(scene, problems, where, value, path, words):
    found = problems(lambda: Scenario.from_dict(_changed(scene, where, value)))
    assert path in found
    assert words in found[path]


def test_all_problems_are_told_at_once(scene, problems):
    scene["obstacles"][0]["vertices"][1] = [1, None]
    scene["obstacles"][1]["vertices"] = BOW_TIE
    scene["start"]["theta"] = 90
    scene["goal"]["y"] = "south"
    scene["workspace"]["y"] = [10, -10]
    scene["vehicle"] = "tank"
    scene["colour"] = "red"
    assert set(problems(lambda: Scenario.from_dict(scene))) == {
        "obstacles[0].vertices[1]",
        "obstacles[1].vertices",
        "start.theta",
        "goal.y",
        "workspace.y",
        "vehicle",
        "colour",
    }


@pytest.mark.parametrize("data", [None, 5, "scene", [], [1, 2], {}, {1: 2}, {None: {}}, {"start": {}, 3: []}])
def test_what_is_no_scene_is_refused(data):
    with pytest.raises(SceneError):
        Scenario.from_dict(data)


def test_the_text_lists_every_problem_with_its_path(scene):
    scene["start"]["x"] = "a"
    scene["goal"]["x"] = "b"
    with pytest.raises(SceneError) as caught:
        Scenario.from_dict(scene)
    assert str(caught.value).splitlines() == [
        "start.x: must be a number, but is 'a'",
        "goal.x: must be a number, but is 'b'",
    ]


def test_a_flood_of_problems_is_cut_and_counted(scene):
    scene["obstacles"] = [{} for _ in range(1000)]
    with pytest.raises(SceneError) as caught:
        Scenario.from_dict(scene)
    assert len(caught.value.problems) == 100
    assert caught.value.problems[-1].message == "and more problems, which are not listed"


def test_too_many_vertices_are_refused_before_anything_is_built(scene, problems):
    ring = [[i, 0] for i in range(1000)]
    scene["obstacles"] = [{"vertices": ring} for _ in range(MAX_VERTICES // 1000 + 1)]
    assert f"at most {MAX_VERTICES}" in problems(lambda: Scenario.from_dict(scene))["obstacles"]


def test_a_polygon_with_too_many_corners_is_refused(scene, problems):
    turn = np.linspace(0, 2 * np.pi, MAX_CORNERS + 2)[:-1]
    scene["obstacles"][0]["vertices"] = np.column_stack([np.cos(turn), np.sin(turn)]).tolist()
    assert "simplify or split" in problems(lambda: Scenario.from_dict(scene))["obstacles[0].vertices"]


@pytest.mark.parametrize(
    "change",
    [
        lambda ring: ring[::-1],
        lambda ring: [*ring, ring[0]],
        lambda ring: [point for point in ring for _ in range(3)],
        lambda ring: ring[2:] + ring[:2],
        lambda ring: [*ring[:1], [10.5, 5.0], *ring[1:]],
    ],
    ids=["clockwise", "closed", "repeated", "rotated", "collinear"],
)
def test_untidy_rings_are_input(scene, change):
    ring = scene["obstacles"][1]["vertices"]
    scene["obstacles"][1]["vertices"] = change(ring)
    obstacle = Scenario.from_dict(scene).obstacles[1]
    cover = unary_union([part.to_shapely() for part in obstacle.parts])
    assert cover.symmetric_difference(Polygon(ring)).area < 1e-9
    assert len(obstacle.parts) == 2


def test_holes_overlaps_and_obstacles_outside_the_workspace_are_input(scene):
    hole = [[4.5, 4.5], [5.5, 4.5], [5.5, 5.5], [4.5, 5.5]]
    scene["obstacles"][0]["holes"] = [hole]
    scene["obstacles"].append({"vertices": [[5, 5], [40, 5], [40, 40]]})
    scenario = Scenario.from_dict(scene)
    assert sum(part.area for part in scenario.obstacles[0].parts) == pytest.approx(3)
    assert [obstacle.name for obstacle in scenario.obstacles] == ["block", "L", "obstacle-2"]


def test_null_means_absent_where_a_default_exists_and_free_in_v_and_delta(scene):
    scene |= {"obstacles": None, "workspace": None, "margin": None, "description": None}
    scene["goal"] |= {"v": None, "delta": None}
    scenario = Scenario.from_dict(scene)
    assert scenario.obstacles == ()
    assert scenario.margin == 0.05
    assert np.isnan(scenario.goal[3:]).all()
    assert (scenario.start[3:] == 0).all()


def test_numbers_without_a_point_before_the_exponent_are_numbers(scene):
    scene["start"]["x"] = "1e-3"  # what YAML 1.1 makes of 1e-3
    assert Scenario.from_dict(scene).start[0] == 1e-3


def test_equal_names_are_made_different(scene):
    names = ["wall", "wall", None, "wall", "wall-2"]
    rings = [[[x, 5], [x + 1, 5], [x + 1, 6]] for x in range(0, 10, 2)]
    scene["obstacles"] = [{"name": name, "vertices": ring} for name, ring in zip(names, rings, strict=True)]
    scenario = Scenario.from_dict(scene)
    assert [o.name for o in scenario.obstacles] == ["wall", "wall-2", "obstacle-2", "wall-3", "wall-2-2"]
    assert len({name for name, _ in scenario.obstacle_parts}) == 5


def test_the_workspace_defaults_to_a_box_around_the_ends_that_takes_in_the_obstacles(scene):
    del scene["workspace"]
    scene["obstacles"] = [{"vertices": [[0, 5], [1000, 5], [1000, 12]]}]
    W = Scenario.from_dict(scene).workspace.vertices
    assert W.min(axis=0).tolist() == [-10, -13]
    assert W.max(axis=0).tolist() == [8 + 50, 12]


def test_the_workspace_may_be_a_list_of_corners_in_either_direction(scene):
    scene["workspace"] = [[-5, 0], [0, 9], [12, 0], [0, -9]]
    assert Scenario.from_dict(scene).workspace.area == pytest.approx(17 * 18 / 2)


def test_a_vehicle_may_stand_in_the_file(scene):
    scene["vehicle"] = {
        "name": "cart",
        "wheelbase": 1.0,
        "body": {"length": 1.5, "width": 0.8, "rear_overhang": 0.2},
        "limits": {"speed": [-1, 1], "acceleration": [-1, 1], "steering": 0.6, "steering_rate": 0.5},
    }
    assert Scenario.from_dict(scene).vehicle_model().name == "cart"


def test_problems_of_a_vehicle_in_the_file_keep_their_paths(scene, problems):
    scene["vehicle"] = {
        "wheelbase": 1.0,
        "body": [{"vertices": BOW_TIE}],
        "limits": {"speed": [-1, 1], "acceleration": [-1, 1], "steering": 0.6, "steering_rate": 0.5},
    }
    found = problems(lambda: Scenario.from_dict(scene))
    assert [path.startswith("vehicle.body[0].vertices") for path in found] == [True]


def test_the_printed_schema_accepts_what_is_read_and_explains_every_field(scene):
    schema = json_schema()
    json.dumps(schema)
    validator = jsonschema.Draft202012Validator(schema)
    validator.check_schema(schema)
    for data in (scene, Scenario.from_dict(scene).to_dict()):
        assert list(validator.iter_errors(data)) == []
    assert list(validator.iter_errors({**scene, "colour": "red"}))
    ours = ("SceneSpec", "StateSpec", "BoxSpec", "ObstacleSpec", "ToleranceSpec")
    models = [schema, *(schema["$defs"][name] for name in ours if name in schema["$defs"])]
    assert len(models) == len(ours)
    for model in models:
        for name, field in model["properties"].items():
            assert field.get("description"), name
