"""A plan's files take their places together or not at all."""

from __future__ import annotations

import errno
import os
import signal
from pathlib import Path

import pytest

from tightspot.cli import output_files
from tightspot.cli.output_files import check_directory, default_directory, write_plan
from tightspot.errors import InputError
from tightspot.verification import load_plan

FILES = {"plan.json", "trajectory.csv", "plan.png"}


@pytest.fixture(scope="module")
def plan(planned):
    return load_plan(planned[0] / "plan.json")


def everything(directory: Path) -> set[str]:
    return {str(path.relative_to(directory)) for path in directory.rglob("*")}


def test_new_directory_with_parents(plan, tmp_path):
    files = write_plan(plan, tmp_path / "a" / "b", picture=True)
    assert everything(tmp_path / "a" / "b") == FILES
    assert set(files) == {"plan", "trajectory", "picture"}
    assert all(Path(path).exists() for path in files.values())


def test_permissions_are_those_of_an_ordinary_directory(plan, tmp_path):
    (tmp_path / "ordinary").mkdir()
    write_plan(plan, tmp_path / "out", picture=False)
    assert (tmp_path / "out").stat().st_mode == (tmp_path / "ordinary").stat().st_mode


def test_existing_directory_keeps_what_is_not_ours(plan, tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "plan.json").write_text("old")
    (tmp_path / "plan.png").write_text("old")
    write_plan(plan, tmp_path, picture=False)
    assert everything(tmp_path) == {"notes.txt", "plan.json", "trajectory.csv"}, "an old picture shows another motion"
    assert load_plan(tmp_path / "plan.json").certificate.digest == plan.certificate.digest


def test_through_a_symbolic_link(plan, tmp_path):
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "real")
    write_plan(plan, tmp_path / "link", picture=False)
    assert (tmp_path / "link").is_symlink()
    assert everything(tmp_path / "real") == {"plan.json", "trajectory.csv"}


@pytest.mark.parametrize("exists", [False, True])
@pytest.mark.parametrize("failure", [OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt()])
@pytest.mark.parametrize("writer", ["save_plan", "write_trajectory_csv"])
def test_failure_leaves_everything_as_it_was(plan, tmp_path, monkeypatch, writer, failure, exists):
    directory = tmp_path / "deep" / "out"
    if exists:
        directory.mkdir(parents=True)
        (directory / "plan.json").write_text("old")
    before = everything(tmp_path)

    def fail(*arguments):
        raise failure

    monkeypatch.setattr(f"tightspot.verification.{writer}", fail)
    with pytest.raises(InputError if isinstance(failure, OSError) else KeyboardInterrupt):
        write_plan(plan, directory, picture=False)
    assert everything(tmp_path) == before
    assert not exists or (directory / "plan.json").read_text() == "old"


def test_failing_picture_leaves_nothing(plan, tmp_path, monkeypatch):
    def fail(*arguments):
        raise RuntimeError("no picture")

    monkeypatch.setattr("tightspot.plotting.show_plan", fail)
    with pytest.raises(RuntimeError):
        write_plan(plan, tmp_path / "out", picture=True)
    assert everything(tmp_path) == set()


def test_interrupt_while_files_take_their_places_is_put_off(plan, tmp_path, monkeypatch):
    publish = output_files._publish

    def interrupted(stage, target):
        os.kill(os.getpid(), signal.SIGINT)
        publish(stage, target)

    monkeypatch.setattr(output_files, "_publish", interrupted)
    write_plan(plan, tmp_path, picture=False)
    assert everything(tmp_path) == {"plan.json", "trajectory.csv"}
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_full_disk_is_one_sentence(cli, quick_planner, monkeypatch):
    def full(descriptor):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    result = cli("plan", "oblique", "-q")
    assert (result.code, result.out) == (2, "")
    assert len(result.err.splitlines()) == 1
    assert "no space left on device" in result.err
    assert os.listdir() == []


def test_unusable_directories_are_refused_before_planning(cli, tmp_path, monkeypatch):
    def planned_anyway(*arguments, **options):
        raise AssertionError("planning began")

    monkeypatch.setattr("tightspot.planner.plan", planned_anyway)
    (tmp_path / "file").write_text("")
    (tmp_path / "odd" / "plan.json").mkdir(parents=True)
    for directory in (tmp_path / "file", tmp_path / "file" / "below", tmp_path / "odd"):
        result = cli("plan", "oblique", "-o", directory)
        assert result.code == 2
        assert result.err.startswith("error: --output: ")
        assert len(result.err.splitlines()) == 1
    Path("oblique-plan").write_text("in the way of the default")
    assert cli("plan", "oblique").code == 2


def test_directory_that_may_not_be_written(tmp_path, monkeypatch):
    monkeypatch.setattr(os, "access", lambda path, mode: False)  # the tests may run as root, who may do anything
    with pytest.raises(InputError, match="may not be written"):
        check_directory(tmp_path / "out")


def test_directory_that_cannot_be_made(cli, quick_planner):
    result = cli("plan", "oblique", "-q", "-o", "/proc/tightspot/out")
    assert result.code == 2
    assert len(result.err.splitlines()) == 1
    assert result.err.startswith("error: --output: /proc/tightspot/out cannot be written: ")


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("vertical", "vertical-plan"),
        ("../../etc/passwd", "etc-passwd-plan"),
        ("my garage (2)", "my-garage-2-plan"),
        ("...", "scene-plan"),
        ("倉庫", "倉庫-plan"),
        ("x" * 500, "x" * 80 + "-plan"),
    ],
)
def test_default_directory_is_a_plain_name(name, expected):
    assert default_directory(name) == Path(expected)
