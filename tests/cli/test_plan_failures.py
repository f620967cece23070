"""``tightspot plan`` without a plan: exit codes, sentences, JSON, and failure.png as the only file."""

from __future__ import annotations

import errno
import json
import os
from pathlib import Path
from typing import Any

import pytest

CLOSED = """
workspace: {x: [-2, 15], y: [-4, 4]}
obstacles:
  - {name: wall, vertices: [[6, -5], [7, -5], [7, 5], [6, 5]]}
start: {x: 0, y: 0, theta: 0}
goal: {x: 10, y: 0, theta: 0}
"""

POCKET = """
name: pocket
workspace: {x: [1000000, 1000020], y: [2000000, 2000010]}
obstacles:
  - {name: south, vertices: [[1000010, 2000000], [1000018, 2000000], [1000018, 2000003.98], [1000010, 2000003.98]]}
  - {name: north, vertices: [[1000010, 2000006.02], [1000018, 2000006.02], [1000018, 2000010], [1000010, 2000010]]}
start: {x: 1000002, y: 2000005, theta: 0}
goal: {x: 1000012, y: 2000005, theta: 0}
"""

GAP = """
name: gap
workspace: {x: [-3, 20], y: [-4, 4]}
obstacles:
  - {name: left, vertices: [[6, 1.075], [9, 1.075], [9, 4], [6, 4]]}
  - {name: right, vertices: [[6, -4], [9, -4], [9, -1.075], [6, -1.075]]}
start: {x: 0, y: 0, theta: 0}
goal: {x: 13, y: 0, theta: 0}
"""


@pytest.fixture
def scene(tmp_path: Path) -> Any:
    """``scene(text)``: a file with that text."""

    def write(text: str) -> Path:
        path = tmp_path / "scene.yaml"
        path.write_text(text)
        return path

    return write


def test_no_plan_is_exit_code_1_with_what_to_change_and_a_picture(cli: Any, scene: Any) -> None:
    result = cli("plan", scene(CLOSED), "-o", "out")
    assert result.code == 1
    assert result.out == ""
    said = [line for line in result.err.splitlines() if not line.startswith("[")]
    assert said[0].startswith("no plan: There is no path: the way is closed by 'wall'")
    assert said[1] == "change: Open a way through obstacle 'wall': no margin and no narrower body helps."
    assert said[2] == f"picture: {Path('out', 'failure.png')}"
    assert len(said) == 3
    assert os.listdir("out") == ["failure.png"], "never a plan file"
    assert Path("out", "failure.png").read_bytes().startswith(b"\x89PNG")


def test_no_plan_as_json(cli: Any, scene: Any) -> None:
    result = cli("plan", scene(CLOSED), "--json", "--quiet")
    assert result.code == 1
    answer = result.json
    assert answer["status"] == "no-plan"
    assert answer["error"] == f"no plan: {answer['explanation']['sentence']}"
    assert answer["reason"] == f"{answer['explanation']['sentence']} {answer['explanation']['remedy']}"
    assert answer["explanation"]["kind"] == "no-path"
    assert answer["explanation"]["bottleneck"]["between"][0] == "wall"
    assert answer["explanation"]["search"]["is_proof"]
    assert answer["report"]["rounds"] == []
    assert answer["files"] == {"picture": str(Path("scene-plan", "failure.png"))}
    assert Path("scene-plan", "failure.png").exists()
    assert "picture" not in result.err, "quiet"


def test_a_blocked_goal_is_exit_code_2_in_the_coordinates_of_the_file(cli: Any, scene: Any) -> None:
    result = cli("plan", scene(POCKET), "--json", "-o", "out")
    assert result.code == 2
    assert result.json["status"] == "bad-input"
    assert {problem["path"] for problem in result.json["problems"]} == {"goal"}
    explanation = result.json["explanation"]
    assert explanation["kind"] == "goal-blocked"
    (end,) = explanation["blocked"]
    assert end["move"] == [-5.75, 0.0]
    assert end["width"] == pytest.approx(1.94)
    assert {item["name"] for item in end["obstacles"]} == {"north", "south"}
    assert os.listdir("out") == ["failure.png"]
    assert sum(line.startswith("error: goal: ") for line in result.err.splitlines()) == 2


def test_bad_input_writes_nothing_unless_a_directory_is_given(cli: Any, scene: Any) -> None:
    result = cli("plan", scene(POCKET))
    assert result.code == 2
    assert all(line.startswith("error: goal: ") for line in result.err.splitlines())
    assert os.listdir() == []


def test_explain_finds_what_passes_and_says_so(cli: Any, scene: Any) -> None:
    result = cli("plan", scene(GAP), "--explain", "--json", "--no-picture")
    assert result.code == 1
    deeper = result.json["explanation"]["deeper"]
    assert 0 < deeper["largest_margin"]["passes"] <= 0.0265 < deeper["largest_margin"]["fails"]
    assert 1.9 < deeper["largest_width"]["passes"] <= 2.05 < deeper["largest_width"]["fails"] <= 2.053
    findings = [line for line in result.err.splitlines() if line.startswith("explain: It passes")]
    assert len(findings) == 2
    assert f"with a body {deeper['largest_width']['passes']:.3f} m wide (2.097 m now)" in findings[1]
    assert any("] explain: a body" in line for line in result.err.splitlines()), "progress"
    assert result.json["files"] == {}
    assert os.listdir() == []


def test_without_explain_nothing_is_bisected(cli: Any, scene: Any) -> None:
    result = cli("plan", scene(GAP), "--json", "--no-picture")
    assert "deeper" not in result.json["explanation"]
    assert "--explain" in result.json["explanation"]["remedy"]


def test_explain_changes_nothing_on_success(cli: Any, planned: Any) -> None:
    result = cli("plan", "oblique", "--explain", "--json", "-o", "out")
    assert result.code == 0
    assert result.json.keys() == planned[1].json.keys()
    assert "explain" not in result.err


def test_what_else_is_in_the_directory_stays(cli: Any, scene: Any) -> None:
    Path("out").mkdir()
    Path("out", "plan.json").write_text("older")
    Path("out", "notes.txt").write_text("mine")
    result = cli("plan", scene(CLOSED), "-o", "out")
    assert result.code == 1
    assert Path("out", "plan.json").read_text() == "older"
    assert Path("out", "notes.txt").read_text() == "mine"
    assert f"{Path('out', 'plan.json')} is an older plan, not of this attempt" in result.err


@pytest.mark.usefixtures("quick_planner")
def test_a_plan_removes_the_picture_of_an_older_failure(cli: Any) -> None:
    Path("out").mkdir()
    Path("out", "failure.png").write_text("older")
    assert cli("plan", "oblique", "-o", "out", "-q").code == 0
    assert set(os.listdir("out")) == {"plan.json", "trajectory.csv", "plan.png"}


def test_a_picture_that_cannot_be_written_changes_no_exit_code(
    cli: Any, scene: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    result = cli("plan", scene(CLOSED), "-o", "out", "--json")
    assert result.code == 1
    assert result.json["files"] == {}
    assert "no picture: --output: out cannot be written: no space left on device" in result.err
    assert os.listdir() == []


def test_without_matplotlib_the_failure_is_explained_all_the_same(
    cli: Any, scene: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    result = cli("plan", scene(CLOSED), "-o", "out")
    assert result.code == 1
    assert "closed by 'wall'" in result.err
    assert not Path("out").exists()


def test_numbers_that_are_not_finite_are_null(capsys: pytest.CaptureFixture[str]) -> None:
    from tightspot.cli.failures import Failure

    Failure(1, "no-plan", ["no plan"], {"a": [float("nan"), {"b": float("inf")}, 1.5, "x"]}).report(as_json=True)
    assert json.loads(capsys.readouterr().out)["a"] == [None, {"b": None}, 1.5, "x"]


@pytest.mark.parametrize("seconds", ["0", "-1", "nan"])
def test_a_time_limit_is_positive(cli: Any, seconds: str) -> None:
    result = cli("plan", "parallel", "--time-limit", seconds)
    assert result.code == 2
    assert result.err.startswith("error: time_limit: ")
