"""What the documentation shows is what happens."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tightspot.errors import SceneError
from tightspot.safe_yaml import load_yaml
from tightspot.scenarios import Scenario, load
from tightspot.scenarios.schema import KNOWN

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "scene-files.md").read_text(encoding="utf-8")


def test_the_pages_example_is_the_file_beside_it():
    block = re.search(r'```yaml title="driveway.yaml"\n(.*?)```', PAGE, re.DOTALL)
    assert block
    shown = Scenario.from_dict(load_yaml(block[1])).to_dict()
    shipped = load(ROOT / "examples" / "driveway.yaml").to_dict()
    assert {**shipped, "description": ""} == shown


def test_the_page_names_every_field():
    for keys in KNOWN.values():
        for key in keys:
            assert f"`{key}`" in PAGE or f"{key}:" in PAGE, key


def test_the_messages_shown_are_the_messages_given(scene):
    scene["start"]["theta"] = 90
    scene["goal"]["yaw"] = scene["goal"].pop("theta")
    scene["obstacles"][1]["vertices"] = [[0, 0], [1, 1], [1, 0], [0, 1]]
    scene["workspace"]["x"] = [20, -10]
    with pytest.raises(SceneError) as caught:
        Scenario.from_dict(scene)
    shown = [
        line
        for line in PAGE.splitlines()
        if line.startswith(("start.theta", "goal.yaw", "obstacles[1]", "workspace.x"))
    ]
    assert len(shown) == 4
    for line in shown:
        assert line in str(caught.value).splitlines()
