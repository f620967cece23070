"""Plan files, CSV and atomic writing: round trips, every kind of broken file, no half-written file."""

import json
import os
import stat

import numpy as np
import pytest

from tightspot.errors import InputError, PlanFileError
from tightspot.files import atomic_write
from tightspot.geometry import ConvexPolygon
from tightspot.scenarios import Obstacle, Scenario
from tightspot.verification import (
    JudgeSettings,
    Plan,
    load_plan,
    replay,
    save_plan,
    verify,
    verify_plan,
    write_trajectory_csv,
)


def test_plan_file_round_trip(plan, tmp_path):
    path = tmp_path / "plan.json"
    save_plan(plan, path)
    loaded = load_plan(path)
    assert loaded.to_dict() == plan.to_dict()
    assert np.array_equal(loaded.trajectory.states, plan.trajectory.states)
    assert loaded.report == {"solver": "none"}
    verdict = verify_plan(loaded)
    assert verdict.upheld
    assert verify_plan(loaded, settings=JudgeSettings()).certificate.to_dict() == plan.certificate.to_dict()
    assert verdict.summary()[0] == "the plan is upheld"


def test_plan_file_has_the_documented_form(plan, tmp_path):
    save_plan(plan, tmp_path / "plan.json")
    data = json.loads((tmp_path / "plan.json").read_text())
    assert list(data) == ["format", "scenario", "vehicle", "trajectory", "certificate", "report"]
    assert data["format"] == "tightspot-plan/1"
    trajectory, N = data["trajectory"], plan.trajectory.steps
    assert set(trajectory) == {"t", "states", "inputs"}
    assert {key: len(value) for key, value in trajectory["states"].items()} == dict.fromkeys(
        ["x", "y", "theta", "v", "delta"], N + 1
    )
    assert {key: len(value) for key, value in trajectory["inputs"].items()} == {"a": N, "omega": N}


@pytest.mark.parametrize("offset", [(500_000, 5_400_000), (4.5e9, -3.2e9)])
def test_far_coordinates_survive_the_file(kit, tmp_path, offset):
    """Written in original coordinates, judged in recentred ones, bit for bit the same after reading."""
    car = kit.box_car()
    base = kit.drive(car, [0, 1, 2, 3], [[1, 0.4], [0.1, -0.2], [-1.1, -0.2]])
    scenario = kit.scene(base, [[(4, 2.0), (6, 2.0), (6, 3), (4.1, 3)]], offset=offset)
    plan = Plan(scenario, car, base, verify(scenario, car, base, margin=0.05))
    assert plan.certificate.certified, plan.certificate.summary()
    save_plan(plan, tmp_path / "plan.json")
    loaded = load_plan(tmp_path / "plan.json")
    assert loaded.to_dict() == plan.to_dict()
    assert verify_plan(loaded).upheld
    written = json.loads((tmp_path / "plan.json").read_text())
    assert written["trajectory"]["states"]["x"][0] == offset[0]
    assert abs(written["certificate"]["pairs"][0]["c"][0]) < 100
    write_trajectory_csv(loaded, tmp_path / "trajectory.csv")
    assert np.loadtxt(tmp_path / "trajectory.csv", delimiter=",", skiprows=1)[0, 2] == offset[1]


def test_an_uncertified_plan_can_be_stored_with_its_witness(plan, tmp_path):
    blocked = plan.scenario.with_(obstacles=(Obstacle("in the way", [(1, -1), (3, -1), (3, 1)]),))
    certificate = verify(blocked, plan.vehicle, plan.trajectory)
    save_plan(Plan(blocked, plan.vehicle, plan.trajectory, certificate), tmp_path / "plan.json")
    loaded = load_plan(tmp_path / "plan.json")
    assert loaded.certificate.witnesses == certificate.witnesses
    assert not verify_plan(loaded).upheld
    assert "overlaps in the way/0 by" in str(loaded.certificate.witness)


def test_csv_is_the_replay_with_the_knots(plan, tmp_path):
    path = tmp_path / "trajectory.csv"
    write_trajectory_csv(plan, path, dt=0.3)
    lines = path.read_text().splitlines()
    assert lines[0] == "t,x,y,theta,v,delta,a,omega"
    rows = np.array([[float(value) for value in line.split(",")] for line in lines[1:]])
    t = rows[:, 0]
    assert set(plan.trajectory.t) <= set(t)
    assert np.diff(t).max() <= 0.3
    assert np.allclose(rows[:, 1:6], replay(plan.vehicle, plan.trajectory).at(t), rtol=0, atol=1e-12)
    assert np.array_equal(rows[t == 1.0][0, 6:], plan.trajectory.inputs[1])
    assert np.array_equal(rows[-1, 6:], plan.trajectory.inputs[-1])
    with pytest.raises(InputError, match="dt"):
        write_trajectory_csv(plan, path, dt=0.0)


BROKEN = {
    "empty": "",
    "truncated": '{"format": "tightspot-plan/1", "scen',
    "not an object": "[1, 2]",
    "no format": "{}",
    "another format": '{"format": "tightspot-plan/9"}',
    "sections missing": '{"format": "tightspot-plan/1"}',
    "not utf-8": b"\xff\xfe{}",
    "deep": "[" * 100_000,
    "long number": '{"format": ' + "9" * 10_000 + "}",
    "NaN": '{"format": "tightspot-plan/1", "report": NaN}',
    "key twice": '{"format": "tightspot-plan/1", "format": "tightspot-plan/1"}',
}


@pytest.mark.parametrize("content", BROKEN.values(), ids=BROKEN)
def test_broken_files_are_plan_file_errors(tmp_path, content):
    path = tmp_path / "plan.json"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(PlanFileError) as info:
        load_plan(path)
    assert all(problem.message for problem in info.value.problems)


def test_missing_directory_and_too_large_files(tmp_path, monkeypatch):
    with pytest.raises(PlanFileError, match="cannot be read"):
        load_plan(tmp_path / "none.json")
    with pytest.raises(PlanFileError, match="cannot be read"):
        load_plan(tmp_path)
    with pytest.raises(PlanFileError, match="cannot be read"):
        load_plan("a\0b")
    monkeypatch.setattr("tightspot.verification.plan_file.MAX_BYTES", 1000)
    (tmp_path / "large.json").write_text(" " * 1001)
    with pytest.raises(PlanFileError, match="larger than"):
        load_plan(tmp_path / "large.json")


def test_all_problems_are_told_at_once_with_their_paths(plan):
    data = json.loads(json.dumps(plan.to_dict()))
    data["scenario"]["goal"]["theta"] = 90
    data["vehicle"]["wheelbase"] = -1
    data["trajectory"]["states"]["x"][2] = "1.0"
    data["trajectory"]["inputs"]["a"][0] = 10**400
    data["certificate"]["pairs"][1]["c"][0] = None
    data["report"] = []
    with pytest.raises(PlanFileError) as info:
        Plan.from_dict(data)
    paths = [problem.path for problem in info.value.problems]
    assert {
        "scenario.goal.theta",
        "vehicle.wheelbase",
        "trajectory.states.x[2]",
        "trajectory.inputs.a[0]",
        "certificate.pairs[1].c[0]",
        "report",
    } <= set(paths)


def test_columns_of_another_model_are_refused(plan):
    data = json.loads(json.dumps(plan.to_dict()))
    data["trajectory"]["states"]["w"] = data["trajectory"]["states"].pop("v")
    with pytest.raises(PlanFileError, match=r"trajectory\.states"):
        Plan.from_dict(data)


def test_columns_may_be_in_any_order(plan):
    data = json.loads(json.dumps(plan.to_dict(), sort_keys=True))
    assert list(data["trajectory"]["states"]) == ["delta", "theta", "v", "x", "y"]
    assert verify_plan(Plan.from_dict(data)).upheld


def test_a_report_that_is_no_json_leaves_no_file(plan, tmp_path):
    odd = Plan(plan.scenario, plan.vehicle, plan.trajectory, plan.certificate, {"x": float("nan")})
    with pytest.raises(PlanFileError, match="report"):
        save_plan(odd, tmp_path / "plan.json")
    assert list(tmp_path.iterdir()) == []


def test_atomic_write_replaces_whole_files_and_keeps_their_mode(tmp_path):
    path = tmp_path / "file"
    atomic_write(path, "one\n")
    mask = os.umask(0)
    os.umask(mask)
    assert stat.S_IMODE(path.stat().st_mode) == 0o666 & ~mask
    path.chmod(0o600)
    atomic_write(path, b"two")
    assert path.read_bytes() == b"two"
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    link = tmp_path / "link"
    link.symlink_to(path)
    atomic_write(link, "three")
    assert link.is_symlink()
    assert path.read_text() == "three"
    with pytest.raises(OSError, match="none"):
        atomic_write(tmp_path / "none" / "file", "x")


@pytest.mark.parametrize("step", ["os.fsync", "os.replace", "os.chmod"])
@pytest.mark.parametrize("error", [KeyboardInterrupt, OSError])
def test_interrupted_writing_leaves_everything_as_it_was(plan, tmp_path, monkeypatch, step, error):
    path = tmp_path / "plan.json"
    path.write_text("old")

    def interrupt(*_):
        raise error

    monkeypatch.setattr(step, interrupt)
    with pytest.raises(error):
        save_plan(plan, path)
    assert [entry.name for entry in tmp_path.iterdir()] == ["plan.json"]
    assert path.read_text() == "old"


def test_workspace_and_names_survive(kit, tmp_path):
    """Characters beyond ASCII, a workspace that is no box, no obstacles."""
    car = kit.box_car()
    trajectory = kit.drive(car, [0, 1, 2], [[1, 0], [-1, 0]])
    W = ConvexPolygon.from_vertices([(-5, -5), (9, -5), (12, 0), (9, 7), (-5, 6)])
    scenario = kit.scene(trajectory, name="Größe ☂", workspace=W)
    plan = Plan(scenario, car, trajectory, verify(scenario, car, trajectory))
    save_plan(plan, tmp_path / "plan.json")
    loaded = load_plan(tmp_path / "plan.json")
    assert isinstance(loaded.scenario, Scenario)
    assert loaded.scenario.name == "Größe ☂"
    assert loaded.certificate.clearance == np.inf
    assert verify_plan(loaded).upheld
