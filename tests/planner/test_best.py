"""The best of many: never worse than less effort, the same for the same seed, told in full."""

from __future__ import annotations

import time

import numpy as np
import pytest

import tightspot
from tightspot.errors import InputError, PlanningError
from tightspot.formulations import SeparatingLine
from tightspot.guesses import GuessResult, HybridAStar, assorted
from tightspot.planner import best
from tightspot.planner.optima import find_optima
from tightspot.planner.progress import Progress
from tightspot.scenarios import Scenario, builtin
from tightspot.solvers import Stagewise
from tightspot.transcription import Objective, Settings, TimeGrid, stage_problem
from tightspot.vehicles import VehicleModel


@pytest.fixture(scope="module")
def dead_end() -> tightspot.Plan:
    return tightspot.plan("dead-end", effort="best", seed=1)


def test_it_is_no_worse_than_less_effort_nor_than_anything_that_was_tried(dead_end: tightspot.Plan) -> None:
    tried = dead_end.report["tried"]
    values = [entry["objective"] for entry in tried if entry["certified"]]
    assert len(values) >= 3
    assert dead_end.report["objective"]["value"] == pytest.approx(min(values))
    assert tried[-1]["guess"] == dead_end.report["guess"]["name"]
    assert tried[-1]["certified"]
    balanced = tightspot.plan("dead-end")
    assert dead_end.report["objective"]["value"] <= balanced.report["objective"]["value"]
    assert balanced.report["objective"]["value"] in values
    assert dead_end.certificate.certified


def test_what_was_tried_is_told_with_objective_and_status(dead_end: tightspot.Plan) -> None:
    tried = dead_end.report["tried"]
    assert len(tried) > best.GUESSES
    assert len({entry["guess"] for entry in tried}) == len(tried)
    for entry in tried:
        assert entry["status"]
        assert (entry["objective"] is not None) == entry["certified"]
        assert entry["status"] != "SOLVED" or entry["rounds"] or entry["objective_first"] > 0
    assert any("bent" in entry["guess"] for entry in tried)


def test_an_optimum_that_promises_less_than_what_is_certified_is_not_followed(dead_end: tightspot.Plan) -> None:
    tried = dead_end.report["tried"]
    followed = [
        entry["objective"] for entry in tried if entry["certified"] and "times the intervals" not in entry["guess"]
    ]
    left = [entry["objective_first"] for entry in tried if entry["status"] == "SOLVED" and not entry["rounds"]]
    assert min(followed) < max(left)


def test_the_same_seed_gives_the_same_plan_on_one_core_and_on_three(
    dead_end: tightspot.Plan, monkeypatch: pytest.MonkeyPatch
) -> None:
    for cores in (1, 3):
        monkeypatch.setattr(best, "cores_for", lambda request, cores=cores: cores)
        again = tightspot.plan("dead-end", effort="best", seed=1)
        np.testing.assert_array_equal(again.trajectory.states, dead_end.trajectory.states)
        names = [entry["guess"] for entry in again.report["tried"]]
        assert names == [entry["guess"] for entry in dead_end.report["tried"]]


def test_a_guess_that_was_asked_for_is_bent_only(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(best, "GUESSES", 10)
    report = tightspot.plan("oblique", effort="best", guess="linear").report
    names = [entry["guess"] for entry in report["tried"]]
    assert all(name.startswith("linear") for name in names)
    assert sum("bent" in name for name in names) == 10


def test_with_a_solver_for_nonlinear_programs_fewer_are_tried_one_after_the_other(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(best, "SLOW_GUESSES", 1)
    monkeypatch.setattr(best, "FINER", (1.2,))
    found = tightspot.plan("oblique", effort="best", solver="ipopt", formulation="separating-line", steps=12)
    names = [entry["guess"] for entry in found.report["tried"]]
    assert len(names) == 3
    assert found.certificate.certified


def test_when_the_time_is_over_what_was_certified_is_the_plan() -> None:
    def slow(news: Progress) -> None:
        if "other guesses" in news.message:
            time.sleep(5.1)

    tried = tightspot.plan("oblique", effort="best", time_limit=5.0, progress=slow).report["tried"]
    assert tried[-1]["guess"] == "hybrid-astar"
    assert tried[-1]["certified"]
    assert len(tried) <= 1 + best.AT_ONCE


class Blind(HybridAStar):
    """Finds nothing where no options are given, as the default would where the search is too coarse."""

    def make(self, scenario: Scenario, vehicle: VehicleModel, *, margin: float) -> GuessResult:
        return (
            GuessResult(None, "Nothing found.")
            if self.options is None
            else super().make(scenario, vehicle, margin=margin)
        )


def test_where_the_first_guess_fails_all_others_are_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("portfolio", "request", "best"):
        monkeypatch.setattr(f"tightspot.planner.{module}.HybridAStar", Blind)
    report = tightspot.plan("oblique", effort="best").report
    assert report["tried"][0]["status"] == "NO_GUESS"
    balanced = tightspot.plan("oblique").report
    assert report["objective"]["value"] <= balanced["objective"]["value"]


def test_an_interrupt_ends_it_at_once() -> None:
    def impatient(news: Progress) -> None:
        if "optima" in news.message:
            raise KeyboardInterrupt

    started = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        tightspot.plan("dead-end", effort="best", progress=impatient)
    assert time.perf_counter() - started < 20


def test_where_no_way_leads_it_says_so_soon() -> None:
    scene = builtin("vertical")
    wall = {"name": "wall", "vertices": [[4.0, -8.0], [4.2, -8.0], [4.2, 8.0], [4.0, 8.0]]}
    data = scene.to_dict()
    data["obstacles"] = [*data["obstacles"], wall]
    with pytest.raises(PlanningError, match=r"no way|no path|closed"):
        tightspot.plan(Scenario.from_dict(data), effort="best")


@pytest.mark.parametrize("seed", [-1, 1.5, "a", True])
def test_a_seed_must_be_a_whole_number(seed: object) -> None:
    with pytest.raises(InputError, match=r"^seed: .* must be a whole number"):
        tightspot.plan("oblique", effort="best", seed=seed)  # type: ignore[arg-type]


def test_optima_are_told_once_the_best_first_with_how_often_they_were_found() -> None:
    scene = builtin("parallel")
    car = scene.vehicle_model()
    settings = Settings(Objective(), SeparatingLine(), margin=0.02, end_margin=0.02)
    guesses, grid = assorted(scene, car, 12, 3, margin=0.02), TimeGrid.uniform(20)
    optima = find_optima(scene, car, settings, [*guesses, GuessResult(None, "None.")], grid=grid)
    values = [optimum.objective for optimum in optima]
    assert values == sorted(values)
    problems = [stage_problem(scene, car, guess.trajectory, settings, grid=grid) for guess in guesses]
    reports = Stagewise().solve_many(problems, threads=2)
    solved = [report.objective for report in reports if report.status.success]
    assert sum(len(optimum.indices) for optimum in optima) == len(solved)
    assert values[0] == pytest.approx(min(solved), rel=3e-3)
    for optimum in optima:
        assert optimum.guess is guesses[optimum.indices[0]]
        assert optimum.objective == pytest.approx(reports[optimum.indices[0]].objective)
