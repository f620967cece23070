"""``tightspot convert``, and start, goal and vehicle on the command line."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from examples.garage_map import garage

from tightspot.scenarios import builtin, load
from tightspot.verification import load_plan, verify_plan

FILES = ["scene.yaml", "scene.json", "scene.geojson", "scene.wkt", "scene.xml"]


def test_a_scene_goes_round_all_formats_and_comes_back(cli):
    before = "garage"
    for name in [*FILES, "again.yaml"]:
        result = cli("convert", before, name)
        assert (result.code, result.err) == (0, "")
        assert result.out.strip() == f"scene: {name}"
        before = name
    assert load("again.yaml").to_dict() == builtin("garage").to_dict()
    assert sorted(os.listdir()) == sorted([*FILES, "again.yaml"])


def test_what_is_left_out_is_told(cli):
    refused = cli("convert", "vertical", "vertical.csv")
    assert refused.code == 2
    assert "vehicle: TPCAP files cannot hold it" in refused.err
    assert "--lossy" in refused.err
    assert os.listdir() == []
    done = cli("convert", "vertical", "vertical.csv", "--lossy", "--json")
    assert done.code == 0
    assert done.json["status"] == "converted"
    assert done.json["files"] == {"scene": "vertical.csv"}
    assert any(sentence.startswith("vehicle") for sentence in done.json["left_out"])
    told = cli("convert", "vertical", "vertical.csv", "--lossy")
    assert "left out: vehicle" in told.err
    assert load("vertical.csv").start[:3].tolist() == builtin("vertical").start[:3].tolist()


def test_formats_may_be_named(cli):
    assert cli("convert", "vertical", "scene", "--format", "wkt").code == 0
    Path("other.dat").write_text(Path("scene").read_text())
    assert cli("convert", "other.dat", "b.yaml").code == 0
    assert cli("convert", "scene", "c.yaml", "--input-format", "wkt").code == 0
    assert load("b.yaml").to_dict() == load("c.yaml").to_dict()
    wrong = cli("convert", "vertical", "d.yaml", "--format", "wtk")
    assert wrong.code == 2
    assert "did you mean 'wkt'" in wrong.err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["vertical", "a.dxf"], "unknown extension"),
        (["nosuch", "a.yaml"], "neither a built-in scene nor a file"),
        (["vertical", "nowhere/a.yaml"], "cannot be written"),
        (["vertical", "a.yaml", "--start", "1,2"], "start: '1,2' must be x,y,theta"),
        (["vertical", "a.yaml", "--unknown", "perhaps"], "'perhaps' must be occupied or free"),
        (["vertical", "a.yaml", "--vehicle", "tank"], "vehicle"),
        (["vertical"], "Missing argument"),
    ],
)
def test_bad_requests_write_nothing(cli, arguments, words):
    result = cli("convert", *arguments)
    assert result.code == 2
    assert words in result.err
    assert all(line.startswith("error: ") for line in result.err.splitlines())
    assert os.listdir() == []


def test_a_map_becomes_a_scene_file(cli, tmp_path):
    made = garage()
    path = made.write(tmp_path)
    missing = cli("convert", path, "garage.yaml")
    assert missing.code == 2
    assert "start: is missing; give --start x,y,theta" in missing.err
    ends = [f"--start={','.join(map(str, made.start))}", f"--goal={','.join(map(str, made.goal))}"]
    assert cli("convert", path, "garage.yaml", *ends, "--vehicle", "tpcap", "--margin", "0.02").code == 0
    scenario = load("garage.yaml")
    assert (scenario.vehicle, scenario.margin) == ("tpcap", 0.02)
    assert scenario.start[:3].tolist() == list(made.start)


def test_start_and_goal_on_the_command_line_go_before_the_scene(cli, quick_planner, monkeypatch):
    from tightspot import planner

    seen = {}
    answer = planner.plan
    monkeypatch.setattr(planner, "plan", lambda scenario, **options: seen.update(s=scenario) or answer(scenario))
    result = cli("plan", "oblique", "--start=-1,0.5,0.25", "--goal", "4,-5,0.7,0,free", "--vehicle", "tpcap", "-q")
    assert result.code == 0, result.err
    assert seen["s"].start[:3].tolist() == [-1, 0.5, 0.25]
    assert seen["s"].goal[2] == 0.7
    assert np.isnan(seen["s"].goal[4])
    assert seen["s"].vehicle == "tpcap"


@pytest.mark.parametrize(("turned", "origin"), [(0.0, (0.0, 0.0, 0.0)), (0.3, (-20.0, 35.5, 0.6))])
def test_a_garage_map_is_planned_on_directly(cli, tmp_path, turned, origin):
    made = garage(turned=turned, origin=origin, seed=2)
    ends = [f"--start={','.join(map(str, made.start))}", f"--goal={','.join(map(str, made.goal))}"]
    options = ["--vehicle", "tpcap", "--margin", "0.02", "-o", "out", "--no-picture", "-q"]
    result = cli("plan", made.write(tmp_path), *ends, *options)
    assert result.code == 0, result.err
    plan = load_plan(Path("out/plan.json"))
    assert verify_plan(plan).upheld
    corners = made.corners(*np.nonzero(made.occupied)) - plan.scenario.offset
    body = plan.vehicle.parts[0].polygon
    for x, y, theta in plan.trajectory.poses:
        near = corners[(np.abs(corners[:, 0] - (x, y)) < 6).all(axis=1)]
        assert not body.transformed(x, y, theta).contains(near.reshape(-1, 2)).any()
