"""``tightspot plan``: what shall be minimised, and free steering angles."""

from __future__ import annotations

import pytest

from tightspot.verification import load_plan


def test_small_energy_weights_and_free_wheels_give_a_faster_plan(cli):
    usual = cli("plan", "oblique", "--json", "--quiet", "--no-picture", "-o", "usual")
    fast = cli(
        "plan", "oblique", "--json", "--quiet", "--no-picture", "-o", "fast",
        "--energy-weights", "0.01,0.01", "--free-steering",
    )  # fmt: skip
    assert usual.code == fast.code == 0
    assert fast.json["duration"] < usual.json["duration"]
    plan = load_plan("fast/plan.json")
    assert plan.report["objective"]["input_weights"] == [0.01, 0.01]
    assert plan.report["objective"]["time_weight"] == 1
    assert plan.scenario.to_dict()["start"]["delta"] is None


@pytest.mark.parametrize(
    ("weights", "words"),
    [("1,x", "must be one number for each input"), ("nan,1", "finite"), ("-1,1", "not negative"), ("1,2,3", "needs 2")],
)
def test_weights_that_are_none_are_refused(cli, weights, words):
    result = cli("plan", "oblique", f"--energy-weights={weights}", "--quiet")
    assert result.code == 2
    assert words in result.err
    assert "Traceback" not in result.err
