"""Scenes to files and back: bit for bit, or refused with a reason."""

from __future__ import annotations

import json
import math
import os

import numpy as np
import pytest

from tightspot.errors import InputError, SceneError
from tightspot.scenarios import FORMATS, Obstacle, Scenario, builtin, load, names, save

LOSSLESS = ("yaml", "json", "geojson", "wkt", "commonroad")
ENDING = {"yaml": ".yaml", "json": ".json", "geojson": ".geojson", "wkt": ".wkt", "commonroad": ".xml", "tpcap": ".csv"}


@pytest.mark.parametrize("kind", LOSSLESS)
@pytest.mark.parametrize("name", names())
def test_built_in_scenes_come_back_bit_for_bit(tmp_path, name, kind):
    path = tmp_path / f"scene{ENDING[kind]}"
    assert save(builtin(name), path) == []
    assert load(path).to_dict() == builtin(name).to_dict()


def test_competition_scenes_come_back_in_every_format(tpcap, tmp_path):
    for file in sorted(tpcap.glob("*.csv")):
        scenario = load(file)
        for kind in ENDING:
            again = tmp_path / f"{file.stem}{ENDING[kind]}"
            assert save(scenario, again) == []
            back = load(again)
            assert back.to_dict() | {"source": ""} == scenario.to_dict() | {"source": ""}
            for (name, part), (name_2, part_2) in zip(scenario.obstacle_parts, back.obstacle_parts, strict=True):
                assert name == name_2
                np.testing.assert_array_equal(part.vertices, part_2.vertices)


@pytest.mark.parametrize("kind", LOSSLESS)
def test_everything_a_scene_can_say_survives(tmp_path, scene, kind):
    ring = [[4, 4], [6, 4], [6, 6], [4, 6], [4, 4]]
    scene |= {
        "name": 'odd; "name", <&> ü',
        "description": "two\nlines; = # \\",
        "source": "--> 'quoted'",
        "vehicle": builtin("forklift-pallet").vehicle_model().to_dict(),
        "margin": 0.1 + 0.2,
        "tolerance": {"position": 0.123, "heading": 1 / 3, "speed": 1e-3, "steering": 0.2},
        "workspace": {
            "vertices": [[-10, -10], [20, -10], [20, 10], [0.1, 10], [-3, 7], [-10, 10]],
            "holes": [[[1, 6], [2, 6], [2, 7]]],
        },
        "start": {"x": 1e9 + 0.1, "y": -1e9 - 0.3, "theta": 9.5, "v": None, "delta": 0.1},
        "goal": {"x": 1e9 + 8, "y": -1e9 - 3, "theta": -7.25, "v": 0.5, "delta": None},
    }
    shift = np.array([1e9, -1e9])
    scene["workspace"] = {
        "vertices": (np.array(scene["workspace"]["vertices"]) + shift).tolist(),
        "holes": [(np.array(hole) + shift).tolist() for hole in scene["workspace"]["holes"]],
    }
    scene["obstacles"] = [
        {"name": "closed; ring", "vertices": (np.array(ring) + shift).tolist()},
        {"name": "clockwise", "vertices": (np.array(ring[::-1]) + shift + 3).tolist()},
        {
            "name": "with a hole",
            "vertices": (np.array(ring[:4]) + shift + (6.1, 0)).tolist(),
            "holes": [(0.5 * (np.array(ring[:3]) - 5) + 5 + shift + (6.1, 0)).tolist()],
        },
    ]
    scenario = Scenario.from_dict(scene)
    path = tmp_path / f"scene{ENDING[kind]}"
    assert save(scenario, path) == []
    assert load(path).to_dict() == scenario.to_dict()


def test_the_extension_or_the_name_chooses_the_format(tmp_path):
    scenario = builtin("vertical")
    for name, begins in {
        "a.yml": "format: tightspot",
        "a.json": '{\n "format"',
        "a.geojson": '{\n "type"',
        "a.wkt": "scene; ",
        "a.txt": "scene; ",
        "a.xml": "<?xml",
    }.items():
        save(scenario, tmp_path / name)
        assert (tmp_path / name).read_text().startswith(begins)
        assert load(tmp_path / name).to_dict() == scenario.to_dict()
    save(scenario, tmp_path / "b.json", format="geojson")
    save(scenario, tmp_path / "scene", format="yaml")
    assert load(tmp_path / "b.json").to_dict() == scenario.to_dict()
    assert load(tmp_path / "scene", format="yaml").to_dict() == scenario.to_dict()


@pytest.mark.parametrize(
    ("path", "kind", "words"),
    [
        ("a.dxf", None, "unknown extension '.dxf'"),
        ("a", None, "unknown extension ''"),
        ("a.yaml", "yml", "did you mean 'yaml'"),
        ("a.yaml", "magic", "choose one of yaml, json, geojson"),
        ("a.yaml", "map", "only read"),
        ("nowhere/a.yaml", None, "cannot be written: no such file or directory"),
        ("", None, "unknown extension"),
    ],
)
def test_what_cannot_be_written_is_explained(tmp_path, monkeypatch, path, kind, words):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=words):
        save(builtin("vertical"), path, format=kind)
    assert os.listdir(tmp_path) == []


def changed(**changes):
    """A scene that a TPCAP file can hold, but for the changes."""
    return load_tpcap().with_(**changes)


def load_tpcap():
    start, goal = {"x": 0.0, "y": 0.0, "theta": 0.1}, {"x": 9.0, "y": 1.0, "theta": 0.0}
    obstacles = [{"vertices": [[3, 3], [5, 3], [5, 5]]}]
    scene = {"vehicle": "tpcap", "margin": 0.02, "start": start, "goal": goal, "obstacles": obstacles}
    return Scenario.from_dict(scene | {"workspace": {"x": [-15, 24], "y": [-15, 16]}})


REFUSED = {
    "vehicle": ({"vehicle": "paper"}, "it is read as 'tpcap'"),
    "margin": ({"margin": 0.05}, "it is read as 0.02"),
    "start": ({"start": [0, 0, 0.1, 1.0, 0]}, "it is read with v 0"),
    "goal": ({"goal": [9, 1, 0, 0, np.nan]}, "it is read with delta 0"),
    "workspace": ({"workspace": builtin("vertical").workspace}, "it is read as (-15, -15)"),
    "obstacles": (
        {"obstacles": (Obstacle("frame", [(3, 3), (5, 3), (5, 5)], ([(4, 3.2), (4.5, 3.2), (4.5, 4)],)),)},
        "their holes are read as filled",
    ),
}


@pytest.mark.parametrize("field", REFUSED)
def test_a_competition_file_holds_what_it_can_and_refuses_the_rest(tmp_path, field):
    changes, words = REFUSED[field]
    with pytest.raises(InputError) as caught:
        save(changed(**changes), tmp_path / "a.csv")
    (problem,) = caught.value.problems
    assert problem.path == field
    assert words in problem.message
    assert "--lossy" in problem.message
    assert os.listdir(tmp_path) == []
    assert any(words in sentence for sentence in save(changed(**changes), tmp_path / "a.csv", lossy=True))
    load(tmp_path / "a.csv")


def test_names_and_whole_turns_are_left_out_but_told(tmp_path):
    scenario = changed(name="hall", description="big", start=[0, 0, 0.1 + 2 * math.pi, 0, 0])
    told = save(scenario, tmp_path / "a.csv")
    assert [sentence.split(":")[0] for sentence in told] == [
        "the name",
        "the description",
        "where the geometry comes from",
        "whole turns of the headings",
    ]
    assert load(tmp_path / "a.csv").start[2] == pytest.approx(0.1)


def test_formats_say_what_they_are():
    assert set(FORMATS) == {*LOSSLESS, "tpcap", "map"}
    for name, kind in FORMATS.items():
        assert kind.name == name
        assert kind.title
        assert (kind.write is None) == (name == "map")


GIVEN = [
    ({"start": (1, 2)}, "start", "must be x,y,theta"),
    ({"goal": "1,2,3,4,5,6"}, "goal", "must be x,y,theta"),
    ({"start": "1,north,0"}, "start.y", "'north' is not a number"),
    ({"start": (1, 2, float("nan"))}, "start.theta", "not finite"),
    ({"start": 5}, "start", "5 must be x,y,theta"),
    ({"goal": (1, 2, 90)}, "goal.theta", "looks like degrees"),
    ({"goal": {"x": 1, "yy": 2}}, "goal.yy", "not a known key"),
    ({"margin": -1}, "margin", "at least 0"),
    ({"margin": "a"}, "margin", "must be a number"),
]


@pytest.mark.parametrize(("given", "path", "words"), GIVEN, ids=range(len(GIVEN)))
def test_what_the_caller_gives_is_checked(given, path, words):
    with pytest.raises(SceneError) as caught:
        load("vertical", **given)
    found = {problem.path: problem.message for problem in caught.value.problems}
    assert words in found[path]


def test_what_the_caller_gives_goes_before_the_file(tmp_path, scene):
    paths = []
    for kind in ENDING:
        paths.append(tmp_path / f"scene{ENDING[kind]}")
        save(load_tpcap(), paths[-1])
    for path in [*paths, "vertical"]:
        scenario = load(path, start=(1, -2, 0.5, None), goal="7,-3,0.25,0.5,free", vehicle="lincoln-mkz", margin=0.3)
        assert scenario.to_dict()["start"] == {"x": 1, "y": -2, "theta": 0.5, "v": None, "delta": 0}
        assert math.isnan(scenario.start[3])
        assert scenario.goal[3] == 0.5
        assert math.isnan(scenario.goal[4])
        assert (scenario.vehicle, scenario.margin) == ("lincoln-mkz", 0.3)
    del scene["start"]
    (tmp_path / "walls.json").write_text(json.dumps(scene))
    assert load(tmp_path / "walls.json", start=(0, 0, 0)).name == "test"


def test_a_given_vehicle_may_be_a_file_or_an_object(tmp_path):
    car = builtin("forklift-pallet").vehicle_model()
    path = tmp_path / "car.json"
    path.write_text(json.dumps(car.to_dict()))
    for vehicle in (car, car.to_dict(), path, str(path)):
        assert load("vertical", vehicle=vehicle).vehicle_model().to_dict() == car.to_dict()
    with pytest.raises(InputError):
        load("vertical", vehicle="no such car")
