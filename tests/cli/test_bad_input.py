"""Bad input of every kind gets its sentence and exit code 2, and leaves no file behind."""

from __future__ import annotations

import copy
import json
import os
from collections.abc import Callable
from typing import Any

import pytest

from tightspot.scenarios import builtin

Scene = dict[str, Any]


def _set(path: str, value: Any) -> Callable[[Scene], None]:
    """A change that puts ``value`` at a path such as ``obstacles.0.vertices``."""

    def change(scene: Scene) -> None:
        *way, last = [int(word) if word.isdigit() else word for word in path.split(".")]
        target: Any = scene
        for key in way:
            target = target[key]
        target[last] = value

    return change


# What is wrong, the change that makes it so, and words that the sentence must contain.
SCENES = {
    "NaN": (_set("start.x", float("nan")), ["start.x"]),
    "infinity": (_set("obstacles.0.vertices.1.0", float("inf")), ["obstacles[0].vertices[1]"]),
    "text for a number": (_set("goal.y", "north"), ["goal.y", "north"]),
    "too few vertices": (_set("obstacles.1.vertices", [[0, 0], [1, 1]]), ["obstacles[1].vertices"]),
    "zero area": (_set("obstacles.0.vertices", [[0, 0], [1, 1], [2, 2]]), ["obstacles[0].vertices"]),
    "self-intersection": (
        _set("obstacles.0.vertices", [[0, -8], [5, -2], [5, -8], [0, -2]]),
        ["obstacles[0].vertices", "crosses"],
    ),
    "inverted bounds": (_set("workspace", {"x": [15, -2], "y": [-8, 8]}), ["workspace.x", "below"]),
    "steering of 90 degrees": (_set("start.delta", 1.6), ["start.delta", "1.6"]),
    "steering beyond the vehicle's": (_set("goal.delta", 1.2), ["goal.delta"]),
    "start in collision": (_set("start", {"x": 2, "y": -3, "theta": 0}), ["start", "left", "m"]),
    "goal in collision": (_set("goal.x", 5.0), ["goal", "left", "m"]),
    "start outside W": (_set("start.x", -10.0), ["start", "workspace"]),
    "unknown key": (_set("obstacels", []), ["obstacels", "obstacles"]),
    "heading in degrees": (_set("goal.theta", 90), ["goal.theta", "radians"]),
    "missing goal": (lambda scene: scene.pop("goal"), ["goal", "missing"]),
    "negative margin": (_set("margin", -0.1), ["margin"]),
    "unknown vehicle": (_set("vehicle", "paperr"), ["vehicle", "paper"]),
    "vehicle with inverted limits": (
        _set("vehicle", {"wheelbase": 2.7, "body": {"length": 4, "width": 2, "rear_overhang": 1}, "limits": {
            "speed": [1, -1], "acceleration": [-1, 1], "steering": 0.6, "steering_rate": 0.5}}),
        ["vehicle.limits.speed"],
    ),
    "unknown format": (_set("format", "tightspot-scene/9"), ["format"]),
}  # fmt: skip

FILES = {
    "empty.yaml": (b"", ["empty"]),
    "not.yaml": (b"[1, {", ["not.yaml"]),
    "list.json": (b"[1, 2, 3]", ["list.json", "not a scene"]),
    "broken.json": (b'{"start": ', ["broken.json"]),
    "binary.yaml": (bytes(range(256)), ["UTF-8"]),
    "huge.yaml": (b"# " + b"x" * 10_000_001, ["MB"]),
    "bomb.yaml": (
        b"a: &a [x, x, x, x, x, x, x, x, x]\n"
        + b"".join(b"%c: &%c [%s]\n" % (98 + i, 98 + i, b", ".join([b"*%c" % (97 + i)] * 9)) for i in range(9)),
        [],
    ),
    "object.yaml": (b"!!python/object/apply:os.system ['true']", []),
    "entities.xml": (b'<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>', ["DOCTYPE"]),
    "unknown.dxf": (b"0", ["unknown.dxf", ".yaml"]),
    "short.csv": (b"1,2,3", ["short.csv", "3"]),
    "words.csv": (b"x,y,theta", ["value 1", "TPCAP"]),
    "cut.csv": (b"0,0,0,5,0,0,1,4,1,2,3,4", ["cut.csv"]),
}

OPTIONS = {
    "negative margin": (["--margin", "-0.1"], ["margin", "-0.1"]),
    "NaN margin": (["--margin", "nan"], ["margin", "nan"]),
    "huge margin": (["--margin", "1e9"], ["margin"]),
    "infinite margin": (["--margin", "inf"], ["margin"]),
    "margin wider than the slot": (["--margin", "0.5"], ["goal", "margin"]),
    "no steps": (["--steps", "0"], ["steps", "0"]),
    "negative steps": (["--steps", "-3"], ["steps", "-3"]),
    "a billion steps": (["--steps", "1000000000"], ["steps"]),
    "steps that are no number": (["--steps", "many"], ["--steps"]),
    "unknown formulation": (["--formulation", "magic"], ["formulation", "magic", "swept-line"]),
    "unknown guess": (["--guess", "magic"], ["guess", "magic", "hybrid-astar"]),
    "unknown solver": (["--solver", "magic"], ["solver", "magic", "ipopt"]),
    "unknown vehicle": (["--vehicle", "magic"], ["vehicle", "magic", "paper"]),
    "missing vehicle file": (["--vehicle", "magic.yaml"], ["vehicle", "magic.yaml"]),
    "negative time weight": (["--time-weight", "-1"], ["time_weight", "-1"]),
    "unknown option": (["--stepz", "3"], ["--stepz", "--help"]),
    "too many arguments": (["parallel"], ["parallel"]),
}


def check(result, words):
    """Exit code 2, every line on standard error a problem, nothing written, nothing on standard output."""
    assert result.code == 2, result.err
    lines = [line for line in result.err.splitlines() if not line.startswith("[")]  # progress begins with a time
    assert lines
    assert all(line.startswith("error: ") for line in lines), result.err
    assert "Traceback" not in result.err
    for word in words:
        assert word in result.err
    assert os.listdir() == []


@pytest.mark.parametrize("kind", SCENES)
def test_scene_files(kind, cli, tmp_path):
    change, words = SCENES[kind]
    scene = copy.deepcopy(builtin("vertical").to_dict())
    change(scene)
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(scene))
    result = cli("plan", path)
    check(result, words)
    assert result.out == ""


def test_all_problems_of_a_file_are_told_at_once(cli, tmp_path):
    scene = copy.deepcopy(builtin("vertical").to_dict())
    for kind in ("too few vertices", "heading in degrees", "unknown key", "negative margin"):
        SCENES[kind][0](scene)
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(scene))
    result = cli("plan", path, "--json")
    check(result, ["obstacles[1].vertices", "goal.theta", "obstacels", "margin"])
    assert result.json["status"] == "bad-input"
    assert {problem["path"] for problem in result.json["problems"]} >= {"goal.theta", "obstacels", "margin"}


@pytest.mark.parametrize("name", FILES)
def test_files_that_are_no_scenes(name, cli, tmp_path):
    content, words = FILES[name]
    (tmp_path / name).write_bytes(content)
    check(cli("plan", tmp_path / name), words)


@pytest.mark.parametrize("kind", OPTIONS)
def test_options(kind, cli):
    options, words = OPTIONS[kind]
    result = cli("plan", "vertical", *options, "--json")
    check(result, words)
    assert result.json["status"] == "bad-input"
    assert result.json["problems"]


@pytest.mark.parametrize("scene", ["", "nosuch", "nosuch.yaml", "/", "vertical/", "\u0000", "a" * 5000])
def test_scenes_that_do_not_exist(scene, cli):
    check(cli("plan", scene), [])


def test_a_misspelt_name_is_answered_with_the_nearest(cli):
    check(cli("plan", "verticle"), ["vertical"])


def test_a_directory_is_no_scene(cli, tmp_path):
    check(cli("plan", tmp_path), ["directory"])


def test_no_command_and_unknown_command(cli):
    assert cli("planify").code == 2
    help_text = cli()
    assert help_text.code == 0
    assert "Commands:" in help_text.out
