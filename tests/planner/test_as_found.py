"""A searched path that is certified as it is."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import tightspot
from tightspot.guesses import GuessResult, HybridAStar, LinearInterpolation
from tightspot.planner import portfolio
from tightspot.planner.as_found import driven_as_found
from tightspot.planner.request import Request, resolve
from tightspot.scenarios import builtin
from tightspot.search import HybridAStarOptions

MARGIN = 0.05


@pytest.fixture(scope="module")
def request_() -> Request:
    return resolve(builtin("parallel"), None, None, None, None, None, None, MARGIN, 8, 60.0)


def found(request: Request, margin: float) -> GuessResult:
    guess = HybridAStar(HybridAStarOptions(margins=(margin,)))
    return guess.make(request.scenario, request.vehicle, margin=request.margin)


def test_a_path_with_the_margin_is_certified_as_it_is(request_: Request) -> None:
    guess = found(request_, MARGIN + 0.01)
    outcome = driven_as_found(request_, guess)
    assert outcome is not None
    assert outcome.certificate is not None
    assert outcome.certificate.certified
    assert outcome.certificate.clearance >= MARGIN
    path = guess.details.path
    driven = outcome.trajectory.poses
    assert np.min(np.hypot(*(driven[:, None, :2] - path.poses[None, :, :2]).T), axis=0).max() < 0.11
    assert not outcome.report.status.success
    assert outcome.to_dict()["solve"]["status"] == "NOT_SOLVED"


def test_a_path_without_the_margin_is_not(request_: Request) -> None:
    assert driven_as_found(replace(request_, margin=0.5), found(request_, 0.0)) is None


def test_only_searched_paths_are_driven(request_: Request) -> None:
    line = LinearInterpolation().make(request_.scenario, request_.vehicle, margin=MARGIN)
    assert driven_as_found(request_, line) is None


def test_where_no_solver_gets_further_the_path_is_the_plan(monkeypatch: pytest.MonkeyPatch, tmp_path) -> None:
    monkeypatch.setattr(portfolio, "run_rounds", lambda *arguments: [])
    plan = tightspot.plan("vertical")
    assert plan.certificate.certified
    assert plan.report["guess"]["name"].endswith("as found")
    assert plan.report["rounds"][-1]["solve"]["status"] == "NOT_SOLVED"
    tightspot.save_plan(plan, tmp_path / "plan.json")
    json.loads((tmp_path / "plan.json").read_text(encoding="utf-8"))
    assert tightspot.verify_plan(tightspot.load_plan(tmp_path / "plan.json")).upheld
