"""What --explain finds is true: what passes is certified and replayed with shapely, what does not pass cannot."""

from __future__ import annotations

import time

import numpy as np
import pytest
from benchmarks.replay import replay

import tightspot
from tightspot.errors import BlockedError, PlanningError
from tightspot.guesses import HybridAStar
from tightspot.planner import Deeper, Explanation, FailureKind, Passing, Progress
from tightspot.planner import explain as diagnosis
from tightspot.scenarios import Scenario
from tightspot.search import COARSE, HybridAStarOptions
from tightspot.solvers import Ipopt
from tightspot.vehicles import body_width, narrowed

from .scenes import MARGIN, PAPER, WIDTH, alley, box, gap

QUICK = HybridAStar(HybridAStarOptions(resolutions=(COARSE,), margins=(MARGIN,)))


def explained(scenario: Scenario | str, **options: object) -> tuple[Explanation, Deeper]:
    with pytest.raises((PlanningError, BlockedError)) as failure:
        tightspot.plan(scenario, explain=True, **options)  # type: ignore[arg-type]
    explanation = failure.value.explanation
    assert isinstance(explanation.deeper, Deeper)
    assert str(explanation).endswith(explanation.findings[-1])
    return explanation, explanation.deeper


def replayed(scenario: Scenario, passing: Passing) -> list[str]:
    """Problems that a replay with shapely finds in a plan with the value that passes."""
    assert passing.passes is not None
    if passing.quantity == "margin":
        plan, margin = tightspot.plan(scenario, margin=passing.passes), passing.passes
    else:
        car = narrowed(PAPER, passing.passes / passing.now)
        plan, margin = tightspot.plan(scenario, vehicle=car), scenario.margin
        assert body_width(plan.vehicle) == pytest.approx(passing.passes)
    return replay(plan.to_dict()).problems(margin)


def test_of_a_gap_too_narrow_the_width_that_passes_is_found_to_a_centimetre() -> None:
    scenario = gap(2.0)
    news: list[Progress] = []
    explanation, deeper = explained(scenario, guess=QUICK, progress=news.append)
    assert explanation.kind is FailureKind.NO_PATH
    room = 2.0 - 2 * MARGIN
    assert deeper.width is not None
    assert deeper.width.passes is not None
    assert deeper.width.passes <= room < deeper.width.fails <= room + 0.003
    assert deeper.width.accuracy is not None
    assert deeper.width.accuracy <= 0.0115
    assert deeper.width.is_proof
    assert replayed(scenario, deeper.width) == []
    assert deeper.margin is not None
    assert deeper.margin.passes is None, "even without margin the car is wider than the gap"
    assert deeper.margin.is_proof
    assert "explain" not in explanation.remedy
    assert any(piece.phase == "explain" and "wide passes" in piece.message for piece in news)
    assert explanation.penetration is not None
    assert sum({c.obstacle: c.depth for c in explanation.penetration.contacts}.values()) == pytest.approx(
        WIDTH - 2.0, abs=0.01
    )


def test_of_a_gap_too_narrow_for_the_margin_the_margin_that_passes_is_found() -> None:
    scenario = gap(2.15)
    _, deeper = explained(scenario, guess=QUICK)
    assert deeper.margin is not None
    assert deeper.margin.passes is not None
    assert deeper.margin.passes <= (2.15 - WIDTH) / 2 < deeper.margin.fails
    assert deeper.margin.accuracy is not None
    assert deeper.margin.accuracy <= 0.0065
    assert replayed(scenario, deeper.margin) == []


def test_a_plan_from_another_start_is_told_with_what_was_changed() -> None:
    explanation, deeper = explained(
        "oblique", guess="linear", solver=Ipopt(max_iterations=2), refinements=0, effort="fast"
    )
    assert explanation.kind is FailureKind.SOLVER_STOPPED
    assert deeper.other_start is not None
    assert deeper.margin is None
    assert deeper.width is None
    assert deeper.trajectory is not None
    certificate = tightspot.verify(explanation.scenario, explanation.vehicle, deeper.trajectory, margin=MARGIN)
    assert certificate.certified
    assert "usual limits" in explanation.findings[0]


def test_a_moved_goal_is_tried() -> None:
    pocket = gap(5.0, box("upper", 10, 18, 1.02, 2), box("lower", 10, 18, -2, -1.02))
    explanation, deeper = explained(pocket)
    assert explanation.kind is FailureKind.GOAL_BLOCKED
    assert deeper.cured
    end = explanation.blocked[0]
    assert end.move is not None
    moved = pocket.with_(goal=pocket.goal + np.array([*end.move, 0, 0, 0]))
    assert replay(tightspot.plan(moved).to_dict()).problems(MARGIN) == []


def test_the_analysis_ends_in_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tightspot.planner.pipeline.SECONDS", 0.5)
    began = time.perf_counter()
    explanation, deeper = explained(alley(3.0), guess=QUICK)
    assert time.perf_counter() - began < 20
    assert deeper.margin is not None
    assert not deeper.margin.in_time
    assert "Time ran out" in explanation.findings[0]
    assert diagnosis.SECONDS == 60.0


def test_success_is_not_changed_by_asking() -> None:
    news: list[Progress] = []
    plan = tightspot.plan("oblique", explain=True, progress=news.append)
    assert plan.certificate.certified
    assert not [piece for piece in news if piece.phase == "explain"]
