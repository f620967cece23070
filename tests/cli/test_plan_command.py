"""``tightspot plan``: a certified plan becomes files; anything else leaves none."""

from __future__ import annotations

import csv
import json
import os
from pathlib import Path

import pytest

from tightspot.verification import load_plan

FILES = {"plan.json", "trajectory.csv", "plan.png"}


def test_files_and_their_contents_are_the_plan(planned):
    directory, result = planned
    assert {path.name for path in directory.iterdir()} == FILES
    plan = load_plan(directory / "plan.json")
    assert plan.certificate.certified
    with (directory / "trajectory.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["t", "x", "y", "theta", "v", "delta", "a", "omega"]
    assert float(rows[-1]["t"]) == pytest.approx(plan.trajectory.duration)
    for name in ("x", "y", "theta"):
        assert float(rows[-1][name]) == pytest.approx(plan.trajectory.column(name)[-1], abs=1e-6)
    assert (directory / "plan.png").read_bytes().startswith(b"\x89PNG")
    assert result.json["files"] == {
        "plan": str(directory / "plan.json"),
        "trajectory": str(directory / "trajectory.csv"),
        "picture": str(directory / "plan.png"),
    }


def test_json_answers_agree_with_the_plan_file(planned):
    directory, result = planned
    plan, answer = load_plan(directory / "plan.json"), result.json
    assert answer["status"] == "certified"
    assert answer["certificate"]["clearance"] == plan.certificate.clearance >= answer["certificate"]["margin"]
    assert answer["duration"] == pytest.approx(plan.trajectory.duration)
    assert answer["steps"] == plan.trajectory.steps
    assert answer["objective"] == pytest.approx(plan.report["objective"]["value"])


def test_progress_goes_to_standard_error(planned):
    _, result = planned
    phases = [line.split("] ", 1)[1].split(":")[0] for line in result.err.splitlines()]
    assert phases[:3] == ["guess", "solve", "verify"]


@pytest.mark.usefixtures("quick_planner")
def test_summary_certificate_and_paths_are_printed_for_people(cli):
    result = cli("plan", "oblique")
    assert result.code == 0
    assert "certified for all times: clearance >= " in result.out
    for word in ("duration", "path length", "gear changes", "steps", "objective", "rounds", "proof:"):
        assert word in result.out
    assert str(Path("oblique-plan", "plan.png")) in result.out
    assert {path.name for path in Path("oblique-plan").iterdir()} == FILES


@pytest.mark.usefixtures("quick_planner")
def test_quiet_says_nothing(cli):
    result = cli("plan", "oblique", "-q")
    assert (result.code, result.out, result.err) == (0, "", "")


@pytest.mark.usefixtures("quick_planner")
def test_without_picture(cli):
    result = cli("plan", "oblique", "--no-picture", "--json", "-o", "out")
    assert set(os.listdir("out")) == {"plan.json", "trajectory.csv"}
    assert set(result.json["files"]) == {"plan", "trajectory"}


@pytest.mark.usefixtures("quick_planner")
def test_without_matplotlib_the_plan_is_written_and_the_picture_is_not(cli, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    result = cli("plan", "oblique", "-o", "out")
    assert result.code == 0
    assert "matplotlib is not installed" in result.err
    assert set(os.listdir("out")) == {"plan.json", "trajectory.csv"}


def test_options_reach_the_planner(cli, planned, monkeypatch):
    from tightspot import planner

    seen = {}

    def plan(scenario, **options):
        seen.update(options, scene=scenario.name)
        return load_plan(planned[0] / "plan.json")

    monkeypatch.setattr(planner, "plan", plan)
    options = {
        "--vehicle": "obca",
        "--formulation": "separating-line",
        "--guess": "linear",
        "--solver": "ipopt",
        "--steps": "33",
        "--margin": "0.07",
        "--time-weight": "2.5",
        "--time-limit": "7",
    }
    assert cli("plan", "vertical", *(word for pair in options.items() for word in pair)).code == 0
    assert seen.pop("objective").time_weight == 2.5
    assert callable(seen.pop("progress"))
    assert seen == {
        "scene": "vertical",
        "vehicle": "obca",
        "formulation": "separating-line",
        "guess": "linear",
        "solver": "ipopt",
        "steps": 33,
        "margin": 0.07,
        "time_limit": 7.0,
    }


def test_a_plan_file_is_a_scene(cli, plan_file):
    from tightspot.scenarios import load

    assert load(plan_file).name == "oblique"


def test_planner_defect_is_one_line(cli, monkeypatch):
    from tightspot import planner

    def broken(scenario, **options):
        raise KeyError("unexpected")

    monkeypatch.setattr(planner, "plan", broken)
    monkeypatch.delenv("TIGHTSPOT_DEBUG", raising=False)
    result = cli("plan", "oblique", "--json", "-q")
    assert result.code == 3
    assert len(result.err.splitlines()) == 1
    assert "internal error: KeyError" in result.err
    assert json.loads(result.out)["status"] == "internal-error"
    monkeypatch.setenv("TIGHTSPOT_DEBUG", "1")
    assert "Traceback" in cli("plan", "oblique", "-q").err
