"""export_plan: the format by name or ending, every format written whole or not at all."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tightspot.errors import InputError
from tightspot.exports import FORMATS, export_plan, format_of
from tightspot.scenarios.readers.commonroad import read_commonroad_solution
from tightspot.verification import Plan, load_plan


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("a.csv", "csv"),
        ("a.path.json", "ros-path"),
        ("a.trajectory.json", "ros-trajectory"),
        ("path.json", "plan"),
        ("A.JSON", "plan"),
        ("a.xml", "commonroad-solution"),
        ("a.SVG", "svg"),
        ("a.gif", "gif"),
        ("a.mp4", "mp4"),
    ],
)
def test_the_ending_tells_the_format(name: str, expected: str) -> None:
    assert format_of(name).name == expected
    assert format_of("whatever.bin", expected).name == expected


def test_unknown_names_and_endings_list_what_there_is() -> None:
    with pytest.raises(
        InputError, match=r"a\.doc has no ending that tells the format; endings are \.csv, \.path\.json"
    ):
        format_of("a.doc")
    with pytest.raises(InputError, match="did you mean 'ros-path'"):
        format_of("a.json", "ros-paths")
    with pytest.raises(InputError, match="there are csv, ros-path"):
        format_of("a.json", "word")


def test_every_format_that_is_no_picture_is_written(plan: Plan, tmp_path: Path) -> None:
    for name in ("csv", "ros-path", "ros-trajectory", "plan", "commonroad-solution"):
        assert export_plan(plan, tmp_path / f"{name}{FORMATS[name].ending}") == []
    assert (tmp_path / "csv.csv").read_text().startswith("t,x,y,theta,v,delta,a,omega\n0.0,")
    assert "poses" in json.loads((tmp_path / "ros-path.path.json").read_text())
    assert "points" in json.loads((tmp_path / "ros-trajectory.trajectory.json").read_text())
    assert load_plan(tmp_path / "plan.json").certificate.digest == plan.certificate.digest
    assert read_commonroad_solution(tmp_path / "commonroad-solution.xml").problem == 2


def test_a_vector_picture_is_written(plan: Plan, tmp_path: Path) -> None:
    export_plan(plan, tmp_path / "p.svg")
    assert "<svg" in (tmp_path / "p.svg").read_text()[:1000]


def test_options_go_where_they_belong_and_no_further(plan: Plan, tmp_path: Path) -> None:
    export_plan(plan, tmp_path / "p.csv", dt=1.0, speedup=None)
    assert len((tmp_path / "p.csv").read_text().splitlines()) == 1 + 8
    with pytest.raises(InputError, match="fps: is no option of the format 'csv'; it has dt"):
        export_plan(plan, tmp_path / "q.csv", fps=20)
    assert not (tmp_path / "q.csv").exists()


def test_an_old_file_survives_a_failure(plan: Plan, tmp_path: Path) -> None:
    for name in ("p.csv", "p.xml", "p.path.json"):
        (tmp_path / name).write_text("old")
        with pytest.raises(InputError):
            export_plan(plan, tmp_path / name, dt=-1.0)
        assert (tmp_path / name).read_text() == "old"
