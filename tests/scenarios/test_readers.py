"""Which file is read how, and every way in which a file can be no scene."""

from __future__ import annotations

import json
import os
import time
from pathlib import Path

import pytest
import yaml

from tightspot.errors import SceneError
from tightspot.scenarios import load, names
from tightspot.scenarios.readers.files import MAX_BYTES

EXAMPLES = Path(__file__).parents[2] / "examples"
LAUGHS = "\n".join(
    [
        "a0: &a0 [x, x, x, x, x, x, x, x, x, x]",
        *(f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, 10)),
    ]
)


@pytest.mark.parametrize("extension", [".yaml", ".yml", ".json", ".YAML"])
def test_scenes_are_read_by_extension_and_named_after_the_file(tmp_path, scene, extension):
    del scene["name"]
    path = tmp_path / f"my scene{extension}"
    path.write_text(json.dumps(scene) if extension == ".json" else yaml.safe_dump(scene))
    for argument in (path, str(path)):
        assert load(argument).name == "my scene"
        assert len(load(argument).obstacles) == 2


def test_a_byte_order_mark_and_windows_line_ends_are_fine(tmp_path, scene):
    path = tmp_path / "s.yaml"
    path.write_bytes(b"\xef\xbb\xbf" + yaml.safe_dump(scene).replace("\n", "\r\n").encode())
    assert load(path).name == "test"


def test_the_scene_inside_a_plan_file_is_read(tmp_path, scene, problems):
    path = tmp_path / "plan.json"
    path.write_text(json.dumps({"format": "tightspot-plan/1", "scenario": scene, "certificate": {}}))
    assert load(path).name == "test"
    scene["start"]["theta"] = 90
    path.write_text(json.dumps({"format": "tightspot-plan/1", "scenario": scene}))
    assert set(problems(lambda: load(path))) == {"scenario.start.theta"}
    path.write_text(json.dumps({"format": "tightspot-plan/1"}))
    assert "no scene" in problems(lambda: load(path))["scenario"]
    path.write_text(json.dumps({"format": "tightspot-plan/9", "scenario": scene}))
    assert "not known to this version" in problems(lambda: load(path))["format"]


def test_a_built_in_name_goes_before_a_file(tmp_path, scene, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("vertical").write_text("no scene")
    assert load("vertical").name == "vertical"
    with pytest.raises(SceneError, match="unknown extension"):
        load("./vertical")


def test_every_built_in_scene_loads_by_name():
    assert [load(name).name for name in names()] == list(names())


CONTENTS = [
    ("empty.yaml", b"", "is empty"),
    ("blank.json", b" \n\n", "is empty"),
    ("comment.yaml", b"# nothing here\n", "is empty"),
    ("dots.yaml", b"---\n...\n", "is empty"),
    ("text.yaml", b"hello", "holds 'hello', not a scene"),
    ("list.yaml", b"[1, 2]", "holds a list of 2, not a scene"),
    ("number.json", b"5", "holds 5, not a scene"),
    ("null.json", b"null", "is empty"),
    ("broken.yaml", b"a: [1, 2\nb: 3", "not readable as YAML"),
    ("broken.yaml", b"a: 1\n b: 2", "(line 2"),
    ("tab.yaml", b"a:\n\t- 1", "not readable as YAML"),
    ("broken.json", b'{"a": 1,}', "not readable as JSON"),
    ("yaml.json", b"a: 1", "(line 1, column 1)"),
    ("binary.yaml", b"a: \x00\x01", "not readable as YAML"),
    ("png.yaml", b"\x89PNG\r\n\x1a\n", "not UTF-8"),
    ("utf16.yaml", "a: 1".encode("utf-16"), "not UTF-8"),
    ("two.yaml", b"a: 1\n---\nb: 2", "expected a single document"),
    ("tag.yaml", b"a: !!python/object/apply:os.system [ls]", "could not determine a constructor"),
    ("custom.yaml", b"a: !thing 5", "could not determine a constructor"),
    ("twice.yaml", b"start: 1\nobstacles: []\nstart: 2", "'start' twice in one object (line 3)"),
    ("twice.json", b'{"start": 1, "start": 2}', "'start' stands twice"),
    ("laughs.yaml", LAUGHS.encode(), "values (aliases written out)"),
    ("itself.yaml", b"a: &a [*a]", "not complete before it"),
    ("undefined.yaml", b"a: *b", "has an alias of 'b'"),
    ("deep.yaml", b"[" * 1_000_000, "levels deep"),
    ("deep-block.yaml", b"- " * 1_000_000, "levels deep"),
    ("deep-map.yaml", b"{a: " * 1_000_000, "levels deep"),
    ("deep.json", b"[" * 1_000_000, "levels deep"),
    ("deep-closed.json", b"[" * 500 + b"]" * 500, "levels deep"),
    ("many.json", b"[" + b"[1,1]," * 150_000 + b"1]", "holds more than"),
    ("many.yaml", b"[" + b"[1,1]," * 150_000 + b"1]", "holds more than"),
    ("digits.json", b'{"start": ' + b"9" * 5000 + b"}", "not readable as JSON"),
    ("digits.yaml", b"start: " + b"9" * 5000, "not readable as YAML"),
    ("date.yaml", b"start: 2001-99-99", "not readable as YAML"),
    ("key.yaml", b"? [1, 2]\n: 3", "not readable as YAML"),
    ("numbers.csv", b"", "is empty"),
]


@pytest.mark.parametrize(("name", "content", "words"), CONTENTS)
def test_a_file_that_is_no_scene_is_refused_quickly_and_by_name(tmp_path, problems, name, content, words):
    path = tmp_path / name
    path.write_bytes(content)
    began = time.monotonic()
    found = problems(lambda: load(path))
    assert time.monotonic() - began < 5
    assert list(found) == [str(path)]
    assert words in found[str(path)]
    assert len(found[str(path)]) < 300


def test_files_that_cannot_be_read_are_explained(tmp_path, problems, scene):
    def sentence(path: Path | str) -> str:
        return problems(lambda: load(path))[str(path)]

    (tmp_path / "scene.yaml").write_text("x")
    (tmp_path / "folder.yaml").mkdir()
    assert f"did you mean {tmp_path / 'scene.yaml'}?" in sentence(tmp_path / "scnee.yaml")
    assert "there is no directory" in sentence(tmp_path / "nowhere" / "scene.yaml")
    assert "is a directory" in sentence(tmp_path / "folder.yaml")
    assert "is a directory" in sentence(tmp_path)
    assert "does not exist" in sentence(tmp_path / "scene.xml")
    (tmp_path / "scene.txt").write_text("x")
    assert "unknown extension '.txt'" in sentence(tmp_path / "scene.txt")
    os.mkfifo(tmp_path / "pipe.yaml")
    assert "not a regular file" in sentence(tmp_path / "pipe.yaml")
    assert "does not exist" in sentence("x" * 90 + ".json")
    assert "cannot be read" in sentence("x" * 5000 + ".json")
    with (tmp_path / "huge.yaml").open("wb") as file:
        file.truncate(MAX_BYTES + 1)
    assert "at most 10 MB" in sentence(tmp_path / "huge.yaml")


@pytest.mark.parametrize("argument", ["", None, 5, "nul\0l", "nul\0l.yaml", "no-such-scene", "\ud800", "\ud800.csv"])
def test_what_is_neither_name_nor_file_is_refused(argument):
    with pytest.raises(SceneError) as caught:
        load(argument)
    str(caught.value).encode("utf-8", "backslashreplace")


def test_unknown_names_get_near_matches_and_how_to_list_them():
    with pytest.raises(SceneError, match=r"did you mean vertical\? `tightspot scenes` lists"):
        load("Verticall")


def test_aliases_of_a_reasonable_size_are_fine(tmp_path):
    path = tmp_path / "s.yaml"
    path.write_text(
        "obstacles:\n"
        "  - vertices: &ring [[5, 5], [6, 5], [6, 6]]\n"
        "  - vertices: *ring\n"
        "start: &here {x: 0, y: 0, theta: 0}\n"
        "goal: {<<: *here, x: 3}\n"
    )
    scenario = load(path)
    assert len(scenario.obstacles) == 2
    assert scenario.goal[0] == 3


@pytest.mark.parametrize("name", ["driveway.yaml", "courtyard.yaml"])
def test_the_examples_can_be_taken(name):
    from tightspot.scenarios import check

    scenario = load(EXAMPLES / name)
    check(scenario, scenario.vehicle_model(), scenario.margin)
    assert len(scenario.obstacle_parts) > len(scenario.obstacles)
