"""Efforts: one guess, the first that is certified, or the best of all."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tightspot
from tightspot.errors import InputError, PlanningError
from tightspot.guesses import GuessResult, HybridAStar, LinearInterpolation
from tightspot.planner import portfolio
from tightspot.planner.portfolio import members_of
from tightspot.planner.request import Request, resolve
from tightspot.scenarios import Scenario, builtin
from tightspot.search import HybridAStarOptions
from tightspot.vehicles import VehicleModel


def asked(**changes: object) -> Request:
    arguments = {"vehicle": None, "objective": None, "formulation_": None, "guess_": None, "solver": None}
    rest = {"steps": None, "margin": 0.05, "refinements": 8, "time_limit": 60.0}
    return resolve(builtin("oblique"), **(arguments | rest | changes))  # type: ignore[arg-type]


def test_members_have_names_of_their_own_and_begin_with_the_default() -> None:
    members = members_of(asked())
    names = [member.name for member in members]
    assert len(set(names)) == len(names) >= 8
    assert members[0].guess == HybridAStar()
    assert len({repr(member.guess) for member in members}) == len(members) - 1, "one differs by its mesh only"


def test_a_guess_that_was_asked_for_is_kept_to() -> None:
    members = members_of(asked(guess_="linear"))
    assert {type(member.guess) for member in members} == {LinearInterpolation}


def test_balanced_stops_at_the_first_that_is_certified_and_fast_tries_no_other() -> None:
    for effort in ("fast", "balanced"):
        tried = tightspot.plan("oblique", effort=effort).report["tried"]
        assert [entry["guess"] for entry in tried] == ["hybrid-astar"]
        assert tried[0]["certified"]


class Blind(HybridAStar):
    """Finds nothing, as the default member would where the search's resolution is too coarse."""

    def make(self, scenario: Scenario, vehicle: VehicleModel, *, margin: float) -> GuessResult:
        if self.options is None:
            return GuessResult(None, "Nothing found.")
        return super().make(scenario, vehicle, margin=margin)


def test_balanced_goes_on_where_the_first_guess_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tightspot.planner.portfolio.HybridAStar", Blind)
    monkeypatch.setattr("tightspot.planner.request.HybridAStar", Blind)
    with pytest.raises(PlanningError, match="Nothing found"):
        tightspot.plan("oblique", effort="fast")
    report = tightspot.plan("oblique").report
    assert not report["tried"][0]["certified"]
    assert report["tried"][0]["status"] == "NO_GUESS"
    assert report["tried"][-1]["certified"]
    assert report["guess"]["name"] == report["tried"][-1]["guess"] != "hybrid-astar"


def test_a_guess_that_was_asked_for_and_finds_nothing_is_the_reason() -> None:
    blind = HybridAStar(HybridAStarOptions(margins=(0.05,), max_expansions=1, time_limit=5.0))
    with pytest.raises(PlanningError) as failure:
        tightspot.plan("parallel", guess=blind)
    assert [entry["status"] for entry in failure.value.report["tried"]] == ["NO_GUESS"]


class Hasty(HybridAStar):
    """Gives up after one pose, unless it may look at many."""

    def make(self, scenario: Scenario, vehicle: VehicleModel, *, margin: float) -> GuessResult:
        options = self.options or HybridAStarOptions(margins=(margin,))
        if options.max_expansions < portfolio.MANY:
            options = replace(options, max_expansions=1)
        return HybridAStar(options).make(scenario, vehicle, margin=margin)


def test_a_search_that_ran_out_goes_on_while_there_is_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tightspot.planner.portfolio.HybridAStar", Hasty)
    monkeypatch.setattr("tightspot.planner.request.HybridAStar", Hasty)
    monkeypatch.setattr(portfolio, "LinearInterpolation", Hasty)
    report = tightspot.plan("parallel").report
    assert report["guess"]["name"] == "hybrid-astar, patient"
    assert report["tried"][0]["status"] == "NO_GUESS"


def test_a_scene_without_a_way_is_refused_with_what_was_tried() -> None:
    scene = builtin("vertical")
    wall = {"name": "wall", "vertices": [[4.0, -8.0], [4.2, -8.0], [4.2, 8.0], [4.0, 8.0]]}
    data = scene.to_dict()
    data["obstacles"] = [*data["obstacles"], wall]
    with pytest.raises(PlanningError) as failure:
        tightspot.plan(Scenario.from_dict(data))
    tried = failure.value.report["tried"]
    assert tried
    assert not any(entry["certified"] for entry in tried)
    assert np.isfinite([entry["seconds"] for entry in tried]).all()


def test_an_unknown_effort_is_named() -> None:
    with pytest.raises(InputError, match=r"effort: 'heroic' is not known; choose one of fast, balanced, best"):
        tightspot.plan("oblique", effort="heroic")
