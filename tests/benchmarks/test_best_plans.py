"""What the benchmark of the best of many guesses counts."""

from __future__ import annotations

import json

import pytest
from benchmarks.best_plans import figures, table

import tightspot
from tightspot.errors import PlanningError


def test_it_tells_the_gain_of_the_worst_seed() -> None:
    results = figures(["oblique"], seeds=2)
    assert json.loads(json.dumps(results)) == results
    row = results["scenes"]["oblique"]
    assert row["best"] <= row["worst"] <= row["balanced"]
    assert row["gain"] == pytest.approx(1 - row["worst"] / row["balanced"])
    assert results["worse"] == 0
    assert table(results).count("\n") == 3


def test_scenes_without_a_plan_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    plan = tightspot.plan

    def only_best(*arguments: object, **options: object) -> tightspot.Plan:
        if options["effort"] != "best":
            raise PlanningError("No plan.")
        return plan(*arguments, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(tightspot, "plan", only_best)
    results = figures(["oblique"], seeds=1)
    assert results["planned_only_by_best"] == 1
    assert results["scenes"]["oblique"]["gain"] is None
    assert "none" in table(results)
