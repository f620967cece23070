"""The campaign: what it counts, that it finds a false plan and a false alarm, and that a lost worker costs one row."""

from __future__ import annotations

import dataclasses
import json
import math
import os
import sys
import time
from types import SimpleNamespace

import pytest
from benchmarks.certify_campaign import __main__ as program
from benchmarks.certify_campaign.judged import Judged, judged_again, recorded, refused_for_room, replayed
from benchmarks.certify_campaign.report import as_markdown
from benchmarks.certify_campaign.rows import append_row, read_rows
from benchmarks.certify_campaign.scene_run import run_scene
from benchmarks.certify_campaign.summary import summarise
from benchmarks.random_scenes import random_scene

import tightspot
from tightspot.verification import verify

EASY = 10
"""Index of a scene of seed 1 that is planned in a moment: a jog of a corridor."""


@pytest.fixture(scope="module")
def directory(tmp_path_factory):
    path = tmp_path_factory.mktemp("campaign")
    for name in ("scenes", "plans"):
        (path / name).mkdir()
    return path


@pytest.fixture(scope="module")
def row(directory):
    return run_scene(1, EASY, 60.0, str(directory))


def test_a_scene_is_planned_and_replayed(row, directory):
    assert row["outcome"] == "plan"
    assert row["problems"] == []
    assert row["upheld"]
    assert row["certified_clearance"] <= row["replay"]["clearance"] <= row["certified_clearance"] + 2e-3
    assert row["judged"][-1]["certified"]
    assert all(judged["again"]["certified"] for judged in row["judged"] if judged["again"])
    assert (directory / "plans" / f"{row['name']}.json").exists()
    assert (directory / "scenes" / f"{row['name']}.yaml").exists()
    assert json.loads(json.dumps(row, allow_nan=False)) == row


def test_every_question_to_the_judge_is_recorded(row):
    with recorded() as asked:
        plan = tightspot.plan(random_scene(1, EASY).scenario)
    digests = {judged.certificate.digest for judged in asked}
    assert plan.certificate.digest in digests
    assert len(digests) == len(row["judged"])


@pytest.fixture
def judged():
    """A certified trajectory."""
    with recorded() as asked:
        tightspot.plan(random_scene(1, EASY).scenario)
    return asked[-1]


def test_a_judge_that_cries_wolf_is_noticed(judged):
    fine = replayed(judged)
    assert refused_for_room(judged, fine) == []
    checks = tuple(dataclasses.replace(check, passed=False) for check in judged.certificate.checks)
    wolf = dataclasses.replace(judged, certificate=dataclasses.replace(judged.certificate, checks=checks))
    lenient = dataclasses.replace(wolf, margin=fine.clearance - 0.002)
    assert refused_for_room(lenient, fine)[0]["false_alarm"]
    strict = dataclasses.replace(wolf, margin=fine.clearance - 0.0005)
    assert not refused_for_room(strict, fine)[0]["false_alarm"]


def test_a_refusal_that_is_right_is_none(judged):
    fine = replayed(judged)
    margin = fine.clearance + 0.01
    refused = verify(judged.scenario, judged.vehicle, judged.trajectory, margin=margin)
    asked = Judged(judged.scenario, judged.vehicle, judged.trajectory, margin, refused)
    assert refused_for_room(asked, fine) == [
        {"about": "obstacles", "beyond": pytest.approx(-0.01), "false_alarm": False}
    ]
    assert judged_again(asked, fine)["certified"]
    touching = dataclasses.replace(fine, clearance=0.0)
    assert judged_again(asked, touching) is None
    assert judged_again(asked, dataclasses.replace(fine, clearance=math.inf)) is None


ROW = {"index": 0, "name": "a", "kind": "into a slot", "family": "f", "ratio": 1.05, "vehicle": "paper", "margin": 0.0}


def plan_row(**changes):
    planned = {"outcome": "plan", "problems": [], "upheld": True, "processor_seconds": 1.0, "rounds": 2}
    fine = {"replay": {"clearance": 0.06}, "certified_clearance": 0.059}
    question = {"certified": True, "refusals": [], "again": {"margin": 0.05, "certified": True}}
    return {**ROW, **planned, **fine, "judged": [question], **changes}


def test_summary_counts_and_passes_what_is_sound():
    failed = {**ROW, "name": "b", "outcome": "no path", "reason": "walled in", "judged": [], "processor_seconds": 0.1}
    summary = summarise([plan_row(), failed, plan_row(kind="into a parallel slot", ratio=1.4)])
    assert summary["passed"]
    assert (summary["scenes"], summary["plans"], summary["failures"]) == (3, 2, {"no path": 1})
    assert summary["by_tightness"]["width up to 1.06"]["scenes"] == 2
    assert summary["by_tightness"]["parallel, length up to 1.6"]["scenes"] == 1
    page = as_markdown(summary, {"processor": "none"})
    assert "walled in" in page
    assert "3 scenes, 2 plans" in page


@pytest.mark.parametrize("bad", [{"problems": ["3 frames overlap an obstacle"]}, {"upheld": False}])
def test_one_refuted_plan_is_enough(bad):
    summary = summarise([plan_row() for _ in range(1000)] + [plan_row(**bad)])
    assert not summary["passed"]
    assert len(summary["refuted"]) == 1
    assert "refuted by the replay or by `tightspot verify`: 1" in as_markdown(summary, {})


@pytest.mark.parametrize(("wrong", "passed"), [(0, True), (1, True), (2, False)])
def test_false_alarms_are_rare_below_one_in_a_hundred(wrong, passed):
    refusal = {"about": "obstacles", "beyond": 0.002, "false_alarm": True}
    fair = {**refusal, "beyond": -0.01, "false_alarm": False}
    rows = [plan_row(judged=[{"refusals": [refusal if i < wrong else fair], "again": None}]) for i in range(150)]
    summary = summarise(rows)
    assert summary["false_alarms"]["refusals"] == {"asked": 150, "false": wrong, "scenes": ["a"] if wrong else []}
    assert summary["passed"] is passed


def test_rows_survive_a_write_that_was_cut_off(tmp_path):
    path = tmp_path / "rows.jsonl"
    append_row(path, {"index": 0, "outcome": "plan"})
    with path.open("a") as file:
        file.write('{"index": 1, "outc')
    assert set(read_rows(path)) == {0}
    append_row(path, {"index": 2, "outcome": "plan"})
    assert set(read_rows(path)) == {0, 2}
    assert read_rows(tmp_path / "none.jsonl") == {}


def odd_worker(seed, index, limit, directory):
    """Hangs, crashes, raises, or answers."""
    if index == 1:
        time.sleep(600)
    if index == 2:
        os._exit(9)
    if index == 3:
        raise ValueError("no such thing")
    return {**random_scene(seed, index).facts(), "outcome": "plan", "judged": [], "worker": os.getpid()}


def test_a_worker_that_hangs_or_dies_costs_one_row(tmp_path, monkeypatch):
    monkeypatch.setattr(program, "run_scene", odd_worker)
    monkeypatch.setattr(program, "SECONDS_BEYOND", 0.5)
    monkeypatch.setattr(program, "multiprocessing", SimpleNamespace(get_context=_forked))
    options = SimpleNamespace(first=0, scenes=5, seed=1, jobs=1, limit=1.0, output=tmp_path)
    rows = program.campaign(options, tmp_path / "rows.jsonl")
    assert [rows[index]["outcome"] for index in range(5)] == ["plan", "hung", "crashed", "crashed", "plan"]
    assert "no such thing" in rows[3]["reason"]
    assert set(read_rows(tmp_path / "rows.jsonl")) == set(range(5))
    again = program.campaign(options, tmp_path / "rows.jsonl")
    assert again == rows


def _forked(_):
    import multiprocessing

    return multiprocessing.get_context("fork")


def test_the_program_does_not_overwrite_rows(tmp_path, monkeypatch, capsys):
    (tmp_path / "rows.jsonl").write_text("")
    monkeypatch.setattr(sys, "argv", ["certify_campaign", "--output", str(tmp_path)])
    assert program.main() == 2
    assert "--resume" in capsys.readouterr().err
