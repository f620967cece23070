"""plan(): certified or an exception that explains; nothing in between."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from benchmarks.replay import replay

import tightspot
from tightspot.errors import InputError, PlanningError, SceneError
from tightspot.formulations import FORMULATIONS
from tightspot.guesses import GivenPath
from tightspot.planner import Progress
from tightspot.scenarios import Obstacle, Scenario, builtin
from tightspot.solvers import Fatrop, Ipopt, Stagewise
from tightspot.vehicles import SingleTrack
from tightspot.verification import verify_plan


def held_by_an_independent_replay(plan: tightspot.Plan, margin: float) -> list[str]:
    return replay(plan.to_dict()).problems(margin)


@pytest.mark.parametrize("formulation", sorted(FORMULATIONS))
def test_every_formulation_is_refined_until_certified(formulation: str) -> None:
    plan = tightspot.plan("oblique", formulation=formulation)
    assert plan.certificate.certified
    assert plan.certificate.clearance >= 0.05
    assert verify_plan(plan).upheld
    assert held_by_an_independent_replay(plan, 0.05) == []
    assert plan.report["formulation"] == formulation
    assert plan.report["rounds"][-1]["certified"]


def test_margin_and_steps_are_kept() -> None:
    plan = tightspot.plan("oblique", margin=0.12, steps=36)
    assert plan.certificate.margin == 0.12
    assert plan.certificate.clearance >= 0.12
    assert plan.report["rounds"][0]["steps"] == 36
    assert held_by_an_independent_replay(plan, 0.12) == []


def test_a_given_path_is_followed() -> None:
    ahead = [[s, 0.0, 0.0] for s in np.linspace(0, 9, 10)]
    back = [[9 - s, -5 * s / 5, s * np.pi / 4 / 5] for s in np.linspace(0, 5, 8)]
    plan = tightspot.plan("oblique", guess=GivenPath([*ahead, *back]))
    assert plan.certificate.certified
    assert plan.report["guess"]["name"] == "path"


def test_news_come_in_order() -> None:
    news: list[Progress] = []
    tightspot.plan("oblique", progress=news.append)
    phases = [piece.phase for piece in news]
    assert phases[0] == "guess"
    assert phases.index("guess") < phases.index("solve") < phases.index("verify")
    numbers = [piece.iteration.number for piece in news if piece.iteration and piece.round == 0]
    assert numbers == list(range(len(numbers)))
    assert len(numbers) > 5


def test_an_interrupt_while_solving_reaches_the_caller() -> None:
    def impatient(news: Progress) -> None:
        if news.iteration and news.iteration.number == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        tightspot.plan("oblique", progress=impatient)


def walled_in() -> Scenario:
    scene = builtin("oblique")
    wall = Obstacle("wall", np.array([[-4.0, -1.2], [20.0, -1.2], [20.0, -1.15], [-4.0, -1.15]]))
    return dataclasses.replace(scene, obstacles=(*scene.obstacles, wall))


def test_a_scene_without_obstacles_is_planned_too(tmp_path: Path) -> None:
    plan = tightspot.plan(dataclasses.replace(builtin("oblique"), obstacles=()))
    assert plan.certificate.certified
    tightspot.save_plan(plan, tmp_path / "plan.json")
    assert verify_plan(tightspot.load_plan(tmp_path / "plan.json")).upheld


def test_no_path_is_an_answer_with_what_was_tried() -> None:
    with pytest.raises(PlanningError) as failure:
        tightspot.plan(walled_in())
    assert "no path" in failure.value.reason.lower()
    assert failure.value.report["guess"]["attempts"]
    assert failure.value.report["rounds"] == []
    assert failure.value.trajectory is None


def test_a_failed_solve_is_never_a_plan() -> None:
    with pytest.raises(PlanningError) as failure:
        tightspot.plan("oblique", solver=Ipopt(max_iterations=2), effort="fast")
    assert "iteration limit" in failure.value.reason
    assert "separation" in failure.value.reason or "dynamics" in failure.value.reason
    assert failure.value.trajectory is not None
    assert all(not outcome["certified"] for outcome in failure.value.report["rounds"])


def test_a_refuted_solution_is_never_a_plan() -> None:
    with pytest.raises(PlanningError) as failure:
        tightspot.plan("parallel", formulation="separating-line", steps=12, refinements=0, effort="fast")
    witness = failure.value.witness
    assert witness is not None
    assert witness.clearance < 0.05
    assert witness.obstacle.split("/")[0] in {obstacle.name for obstacle in builtin("parallel").obstacles}
    assert str(witness) in failure.value.reason


def test_time_is_limited() -> None:
    with pytest.raises(PlanningError) as failure:
        tightspot.plan("parallel", solver="ipopt", steps=200, time_limit=0.05)
    assert failure.value.report["rounds"][-1]["solve"]["status"] == "TIME_LIMIT"


def test_the_default_solver_is_the_stagewise_one_and_falls_back_to_fatrop_then_ipopt(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    report = tightspot.plan("oblique").report
    rounds = report["rounds"]
    assert report["fell_back_from"] == []
    assert {entry["solve"]["solver"] for entry in rounds} == {"stagewise"}
    assert all(entry["fell_back_from"] == [] for entry in rounds)
    monkeypatch.setattr("tightspot.planner.request.Stagewise", lambda: Stagewise(max_iterations=2))
    report = tightspot.plan("oblique", effort="fast").report
    entry = report["rounds"][0]
    assert entry["solve"]["solver"] == "fatrop"
    (failed,) = entry["fell_back_from"]
    assert (failed["solver"], failed["status"]) == ("stagewise", "ITERATION_LIMIT")
    assert {fallen["solver"] for fallen in report["fell_back_from"]} >= {"stagewise"}
    monkeypatch.setattr("tightspot.planner.request.Fatrop", lambda time_limit: Fatrop(max_iterations=2))
    report = tightspot.plan("oblique", effort="fast").report
    entry = report["rounds"][0]
    assert entry["solve"]["solver"] == "ipopt"
    assert [fallen["solver"] for fallen in entry["fell_back_from"]] == ["stagewise", "fatrop"]
    assert [fallen["solver"] for fallen in report["fell_back_from"]] == ["stagewise", "fatrop"]


def test_a_model_of_one_s_own_is_solved_by_fatrop_and_the_report_says_why() -> None:
    class Mine(SingleTrack):
        """Not compiled in."""

    base = tightspot.vehicle("paper")
    report = tightspot.plan("oblique", vehicle=Mine(base.name, base.wheelbase, base.body, base.limits)).report
    assert report["solver"] == "fatrop"
    (first, *_) = report["fell_back_from"]
    assert (first["solver"], first["status"]) == ("stagewise", "NOT_USABLE")
    assert "Mine" in first["sentence"]
    assert report["rounds"][-1]["solve"]["solver"] in ("fatrop", "ipopt")


def test_a_formulation_without_lines_is_solved_by_ipopt() -> None:
    report = tightspot.plan("oblique", formulation="normalised-farkas-dual").report
    assert {entry["solve"]["solver"] for entry in report["rounds"]} == {"ipopt"}
    with pytest.raises(InputError, match=r"stagewise cannot solve SingleTrack with farkas-dual; choose ipopt"):
        tightspot.plan("oblique", formulation="farkas-dual", solver="stagewise")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"margin": -0.1}, "margin"),
        ({"margin": "0.1"}, "margin"),
        ({"margin": True}, "margin"),
        ({"margin": float("nan")}, "margin"),
        ({"margin": 1000.0}, "margin"),
        ({"steps": 0}, "steps"),
        ({"steps": 10**9}, "steps"),
        ({"refinements": -1}, "refinements"),
        ({"time_limit": 0.0}, "time_limit"),
        ({"time_limit": "9"}, "time_limit"),
        ({"refinements": True}, "refinements"),
        ({"formulation": "magic"}, "separating-line"),
        ({"guess": "oracle"}, "hybrid-astar"),
        ({"solver": "abacus"}, "ipopt"),
        ({"vehicle": "submarine"}, "tpcap"),
    ],
)
def test_bad_arguments_are_named(arguments: dict[str, object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        tightspot.plan("oblique", **arguments)  # type: ignore[arg-type]


def test_a_start_nearer_than_the_margin_is_refused_before_anything_is_computed() -> None:
    with pytest.raises(SceneError, match="margin"):
        tightspot.plan("vertical", margin=0.3)
