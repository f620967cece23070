"""``tightspot bench speed``: files, JSON, bad input."""

import json

import pytest

from tightspot.campaigns import speed
from tightspot.campaigns.speed import SpeedPlan
from tightspot.campaigns.speed.cases import SCENES
from tightspot.campaigns.speed.headline import ASKED, ASKED_OF_SCENES

TINY = SpeedPlan(
    starts=1, straight=1, plans=1, infeasible=1, batch=2, runs=1,
    steps=(10, 20), obstacles=(2, 10), vertices=(4, 8), ipopt_steps=10, ipopt_obstacles=2,
)  # fmt: skip


@pytest.mark.slow
def test_everything_is_measured_and_told(cli, tmp_path, monkeypatch):
    monkeypatch.setattr(speed, "QUICK", TINY)
    result = cli("bench", "speed", "--quick", "--json", "--output", tmp_path / "out")
    assert (result.code, result.err) == (0, "")
    answer = result.json
    assert {"solve_ratio", "plan_ratio", "success", "solves_per_second", *ASKED, *ASKED_OF_SCENES} <= set(answer)
    assert answer["plan_ratio_with_building"] > answer["plan_ratio"]
    assert answer["solve_ratio"] > 1
    assert answer["solves_per_second"] > 10
    assert 0 <= answer["success"] <= 1
    assert set(answer["solves"]["energy and time"]) == {*SCENES, "all"}
    assert [row["steps"] for row in answer["scaling"]["steps"]["rows"]] == [10, 20]
    assert answer["machine"]["versions"]["casadi"]
    names = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert {"speed.json", "speed.md"} <= set(names)
    assert sum(name.endswith(".svg") for name in names) == 3
    kept = json.loads((tmp_path / "out" / "speed.json").read_text())
    assert kept == {key: value for key, value in answer.items() if key != "files"}
    text = (tmp_path / "out" / "speed.md").read_text()
    assert all(name in text for name in names if name.endswith(".svg"))
    for heading in (
        "Whole plans",
        "Scaling",
        "Batch",
        "straight-line",
        "Infeasible programs",
        "time-optimal",
        *(what for what, _ in ASKED.values()),
        *(what.format("vertical") for what, _ in ASKED_OF_SCENES.values()),
    ):
        assert heading in text


def test_a_file_where_the_directory_should_be_is_one_sentence(cli, tmp_path):
    (tmp_path / "file").write_text("mine")
    result = cli("bench", "speed", "--quick", "--output", tmp_path / "file")
    assert result.code == 2
    assert "is a file; give a directory" in result.err
    assert (tmp_path / "file").read_text() == "mine"


@pytest.mark.parametrize("options", [("--starts", 0), ("--seed", -1), ("--starts", "many")])
def test_numbers_that_make_no_sense_are_bad_input(cli, options):
    result = cli("bench", "speed", "--quick", *options)
    assert result.code == 2
    assert "Traceback" not in result.err
