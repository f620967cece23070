"""The competition's tables: which cases, what the replay says, and what knots alone hide."""

from __future__ import annotations

import subprocess
import sys

import pytest
from benchmarks.scenes import TPCAP
from benchmarks.tpcap import KNOTS, at_knots, cases, planned, report

needs_data = pytest.mark.skipif(not TPCAP.is_dir(), reason=f"needs the competition's scenes in {TPCAP}")


def test_cases_are_found_by_number(tmp_path):
    for name in ("Case10.csv", "Case2.csv", "Case1.csv", "Case3.txt", "README.md", "Case.csv"):
        (tmp_path / name).write_text("")
    assert [path.name for path in cases(tmp_path)] == ["Case1.csv", "Case2.csv", "Case10.csv"]


@pytest.mark.parametrize("argument", ["nowhere", "."])
def test_a_directory_without_cases_is_said_so(tmp_path, argument):
    command = [sys.executable, "-m", "benchmarks.tpcap", str(tmp_path / argument), "--no-write"]
    run = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert run.returncode == 2
    assert "no directory" in run.stderr or "holds no Case" in run.stderr


def test_what_was_not_planned_is_a_dash_and_a_problem():
    text = report([{"scene": "Case7", "problems": ["error: no plan"]}], [], [])
    assert "| Case7 | - | - |" in text
    assert "- Case7: error: no plan" in text


@needs_data
def test_a_case_is_planned_and_replayed():
    row = planned(TPCAP / "Case18.csv")
    assert row["problems"] == []
    assert row["replayed"] >= row["certified"] >= 0.02
    assert row["duration"] > 5


@needs_data
def test_knots_alone_cut_corners():
    row = at_knots(TPCAP / "Case1.csv", min(KNOTS))
    assert row["depth"] > 0.1
    assert row["duration"] < 11.4
