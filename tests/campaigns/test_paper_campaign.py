"""A small campaign from end to end: resumed after an interruption, and its report."""

import csv
import json
import os
import re

import numpy as np
import pytest

from tightspot.campaigns import Machine, Plan, report_markdown, run
from tightspot.campaigns.starts import random_start
from tightspot.cli.app import run as command_line
from tightspot.errors import InputError
from tightspot.geometry import clearance, transform
from tightspot.trajectory import Trajectory

SMALL = Plan(scenes=("oblique",), methods=("17", "19-single"), guesses=("simplified", "hybrid-astar"), runs=2)
MACHINE = Machine("a processor", 3, "a system", {"tightspot": "1.2.3"})


@pytest.fixture(scope="module")
def interrupted(tmp_path_factory):
    """A campaign stopped in its third case, and what was on the disk then."""
    directory = tmp_path_factory.mktemp("bench")

    def stop(news):
        if news.done == 2 and news.row is None:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(SMALL, directory, progress=stop)
    return directory, (directory / "rows.jsonl").read_text()


@pytest.fixture(scope="module")
def finished(interrupted):
    """The same campaign resumed: its outcome, its news and its directory."""
    directory, before = interrupted
    news = []
    outcome = run(SMALL, directory, progress=news.append)
    return outcome, news, directory, before


def test_an_interrupted_campaign_goes_on_where_it_was(finished):
    outcome, news, directory, before = finished
    assert len(before.splitlines()) == 3, "the settings and two rows"
    assert (directory / "rows.jsonl").read_text().startswith(before), "nothing done is done again"
    assert [entry.case.key for entry in news if entry.row is None] == [case.key for case in SMALL.cases()[2:]]
    assert [row.key for row in outcome.rows] == [case.key for case in SMALL.cases()]
    assert [entry.done for entry in news] == [2, 3, 3, 4]
    assert all(entry.total == 4 for entry in news)
    assert news[0].seconds_left is None
    assert news[-1].seconds_left == 0.0
    again = []
    assert run(SMALL, directory, progress=again.append).rows == outcome.rows
    assert again == []


def test_rows_hold_what_was_solved(finished):
    outcome = finished[0]
    car, scenario = outcome.settings.car(), outcome.settings.scenario("oblique")
    for row in outcome.rows:
        motion = row.motion()
        assert row.status == "SOLVED"
        assert row.runs == 2
        assert (row.objective, row.final_time) == pytest.approx((0.8561, 70.19), rel=2e-3)
        assert row.effort == pytest.approx((motion.inputs**2).sum())
        expected = 0.0095 * motion.duration + 5.255 * (motion.inputs**2 @ [1, 2]).sum()
        assert row.objective == pytest.approx(expected, rel=1e-9)
        assert row.certified
        assert row.penetration == 0.0
        assert (row.paper_objective, row.paper_final_time) == (0.856, 70.18)
        V = transform(car.parts[0].polygon.vertices, motion.poses)
        for _, polygon in scenario.obstacle_parts:
            assert clearance(V, polygon.vertices).min() >= 2e-3 - 1e-6
    assert {row.method: (row.CN, row.VN) for row in outcome.rows}["17"] == (1166, 266)
    assert {row.method: row.VN for row in outcome.rows}["19-single"] == 466


def test_the_csv_is_complete(finished):
    outcome, _, directory, _ = finished
    with (directory / "rows.csv").open() as lines:
        rows = list(csv.DictReader(lines))
    assert [row["key"] for row in rows] == [row.key for row in outcome.rows]
    assert [float(row["objective"]) for row in rows] == [row.objective for row in outcome.rows]


def test_the_report_says_machine_settings_evidence_and_every_row(finished):
    outcome = finished[0]
    report = report_markdown(outcome, MACHINE, {"A caption.": "figure1.png"})
    for words in ("a processor, 3 cores", "tightspot 1.2.3", "paper-recovered", "RK4 with 4 step(s)", "0.002 m"):
        assert words in report
    for value, evidence in outcome.settings.evidence.items():
        assert f"| {value} | {evidence.replace('|', chr(92) + '|')} |" in report
    for row in outcome.rows:
        assert f"| {row.guess} | SOLVED | {row.objective:.4f} | 0.856 | {row.final_time:.2f} | 70.18 |" in report
        assert row.verdict in report
    assert "swaps (16) and (17)" in report
    assert "![A caption.](figure1.png)" in report
    assert "0 of 4 solutions collide between their samples" in report
    assert all(claim.here.replace("|", chr(92) + "|") in report for claim in outcome.claims)
    tables = [line for line in report.splitlines() if line.startswith("|")]
    assert all(line.endswith("|") for line in tables)


def test_a_campaign_of_other_settings_needs_another_directory(finished):
    _, _, directory, _ = finished
    with pytest.raises(InputError, match="other settings, runs, vehicle, objective"):
        run(Plan(settings="printed", scenes=("oblique",), methods=("17",), guesses=("simplified",), runs=1), directory)


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"scenes": ("garage",)}, "garage"),
        ({"methods": ("20",)}, "20"),
        ({"guesses": ("linear",)}, "linear"),
        ({"runs": 0}, "at least 1"),
        ({"starts": -1}, "at least 0"),
        ({"time_limit": float("nan")}, "nan"),
    ],
)
def test_plans_that_make_no_sense_are_refused(fields, words):
    with pytest.raises(InputError, match=words):
        Plan(**fields)


def test_random_starts_are_the_same_for_the_same_number():
    base = Trajectory([0.0, 10.0], np.array([[0, 0, 0, 0, 0], [5.0, 1, 0.5, 0, 0]]), np.zeros((1, 2)))
    one, again, other = (random_start(base, 20, number) for number in (3, 3, 4))
    np.testing.assert_array_equal(one.states, again.states)
    assert not np.array_equal(one.states, other.states)
    np.testing.assert_allclose(one.states[[0, -1]], base.states, atol=1e-12)
    assert 40 <= one.duration <= 140


def test_the_command_writes_everything_and_prints_one_object(tmp_path, capsys):
    directory = tmp_path / "out"
    arguments = ["bench", "paper", "-o", str(directory), "--quick", "--scene", "oblique", "--guess", "hybrid-astar"]
    arguments += ["--method", "17", "--method", "16", "--starts", "1", "--json"]
    assert command_line(arguments) == 0
    out, err = capsys.readouterr()
    facts = json.loads(out)
    assert [row["key"] for row in facts["rows"]] == [
        "oblique / 17 / hybrid-astar",
        "oblique / 16 / hybrid-astar",
        "oblique / 19-single / start 0",
    ]
    assert all(row["runs"] == 1 for row in facts["rows"])
    assert re.search(r"\[2/3, about \d+ s left\] oblique / 16 / hybrid-astar: J = 0\.8560", err)
    assert all(os.path.getsize(path) > 100 for path in facts["files"].values())
    assert {"report", "table", "rows", "figure1", "figure2"} == set(facts["files"])
    assert "## Random starts" in (directory / "report.md").read_text()
    assert "(figure2.png)" in (directory / "report.md").read_text()


def test_a_file_where_the_directory_should_be_is_bad_input(tmp_path, capsys):
    (tmp_path / "out").write_text("mine")
    assert command_line(["bench", "paper", "-o", str(tmp_path / "out")]) == 2
    assert "is a file" in capsys.readouterr().err
