"""``tightspot export``: a plan as files for others, judged first."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tightspot.scenarios.readers.commonroad import read_commonroad_solution, write_commonroad
from tightspot.verification import load_plan


def test_several_files_in_one_go(cli, plan_file, tmp_path):
    targets = [tmp_path / name for name in ("t.csv", "t.path.json", "t.trajectory.json", "t.svg")]
    result = cli("export", plan_file, *targets, "--json")
    assert (result.code, result.err) == (0, "")
    assert result.json["upheld"] is True
    assert [entry["format"] for entry in result.json["files"]] == ["csv", "ros-path", "ros-trajectory", "svg"]
    assert all(path.stat().st_size > 1000 for path in targets)


def test_the_format_may_be_named_and_options_reach_it(cli, plan_file, tmp_path):
    result = cli("export", plan_file, tmp_path / "x.json", "--format", "ros-path", "--dt", "0.5", "--frame-id", "odom")
    assert (result.code, result.err) == (0, "")
    message = json.loads((tmp_path / "x.json").read_text())
    assert message["header"]["frame_id"] == "odom"
    assert f"ros-path: {tmp_path / 'x.json'}" in result.out


def test_a_commonroad_solution_of_another_vehicle(cli, plan_file, tmp_path):
    solution, scenario = tmp_path / "s.xml", tmp_path / "scenario.xml"
    result = cli("export", plan_file, solution)
    assert result.code == 2
    assert "none of CommonRoad's" in result.err
    plan = load_plan(plan_file)
    write_commonroad(plan.scenario, scenario, reference="rear-axle", dt=0.25)
    result = cli(
        *("export", plan_file, solution, "--vehicle-type", "1", "--cost", "SM1"),
        *("--scenario", scenario, "--problem", "2", "--reference", "rear-axle"),
    )
    assert result.code == 0, result.err
    read = read_commonroad_solution(solution)
    assert (read.vehicle_type, read.cost, read.problem) == (1, "SM1", 2)
    assert np.diff(read.trajectory.t) == pytest.approx(0.25)


def test_what_is_not_upheld_is_written_only_on_request(cli, plan_file, tmp_path):
    plan = json.loads(plan_file.read_text())
    for point in plan["vehicle"]["body"][0]["vertices"]:
        point[1] *= 1.5
    plan_file.write_text(json.dumps(plan))
    result = cli("export", plan_file, tmp_path / "t.csv")
    assert result.code == 1
    assert "the plan is not upheld" in result.err
    assert not (tmp_path / "t.csv").exists()
    result = cli("export", plan_file, tmp_path / "t.csv", "--anyway", "--json")
    assert (result.code, result.json["upheld"]) == (0, False)
    assert "warning: the plan is not upheld" in result.err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["t.doc"], "no ending that tells the format"),
        (["t.csv", "--format", "word"], "there are csv, ros-path"),
        (["missing/t.csv"], "there is no directory missing"),
        (["."], "is a directory"),
        (["t.csv", "--fps", "20"], "--fps: means nothing to csv"),
        (["t.csv", "--scenario", "x.xml"], "--scenario: means nothing to csv"),
        (["t.csv", "--dt", "0"], "dt: 0.0 s must be a positive time"),
        (["t.path.json", "--dt", "nan"], "dt: nan s must be a positive time"),
    ],
)
def test_what_cannot_be_written_is_one_sentence(arguments, words, cli, plan_file):
    arguments = [*arguments, "--format", "csv"] if arguments == ["."] else arguments
    result = cli("export", plan_file, *arguments)
    assert (result.code, result.out) == (2, "")
    assert words in result.err
    assert len(result.err.splitlines()) == 1
    assert list(Path.cwd().iterdir()) == []


def test_a_file_that_is_no_plan(cli, tmp_path):
    (tmp_path / "no.json").write_text("{}")
    result = cli("export", tmp_path / "no.json", tmp_path / "t.csv")
    assert result.code == 2
    assert "format: is missing" in result.err
