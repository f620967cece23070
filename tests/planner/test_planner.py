"""Plans from the last plan: certified like any other, the same optima, and made anew when that does not do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tightspot
from tightspot.errors import BlockedError, InputError
from tightspot.planner.request import resolve
from tightspot.planner.rounds import Step, run_round
from tightspot.solvers import Ipopt, StageProblem

MARGIN = 0.02
SHIFT = np.array([0.08, -0.06, np.radians(2.0), 0.0, 0.0])


@pytest.mark.parametrize("scene", ["oblique", "vertical"])
def test_moved_start_is_planned_from_the_last_plan(scene):
    planner = tightspot.Planner(scene, margin=MARGIN)
    first = planner.plan()
    assert first.report["warm"] == {"used": False, "reason": "it is the first plan"}
    second = planner.plan(start=first.scenario.start + SHIFT)
    warm = second.report["warm"]
    assert warm["used"]
    assert warm["moved"]["start"] == pytest.approx(0.1)
    assert warm["moved"]["start_heading"] == pytest.approx(np.radians(2.0))
    assert second.certificate.certified
    assert second.certificate.margin == MARGIN
    assert tightspot.verify_plan(second).upheld
    np.testing.assert_allclose(second.trajectory.states[0], second.scenario.start)
    assert second.report["rounds"][0]["warm"]


def test_the_warm_optimum_is_one_that_ipopt_finds_from_there_too():
    planner = tightspot.Planner("oblique", margin=MARGIN)
    start = planner.plan().scenario.start + SHIFT
    plan = planner.plan(start=start)
    request = resolve(plan.scenario, None, None, None, None, None, None, MARGIN, 8, 60.0)
    mesh = planner.last_round.mesh
    alone = replace(request, solver=Ipopt(), fallbacks=())
    again = run_round(alone, Step(mesh, plan.trajectory, "guess", "from the warm plan"), 0, lambda news: None, 60.0)
    assert again.report.status.success
    assert plan.report["objective"]["value"] == pytest.approx(again.report.objective, rel=1e-4)


def test_the_goal_and_the_obstacles_may_move():
    planner = tightspot.Planner("oblique", margin=MARGIN)
    first = planner.plan()
    plan = planner.plan(goal=first.scenario.goal + np.array([0.05, 0.05, 0.0, 0.0, 0.0]))
    assert plan.report["warm"]["used"]
    assert plan.report["warm"]["moved"]["goal"] == pytest.approx(np.hypot(0.05, 0.05))
    shifted = [obstacle.shifted([0.03, 0.0]) for obstacle in first.scenario.obstacles]
    plan = planner.plan(obstacles=shifted)
    assert plan.report["warm"]["used"]
    assert plan.report["warm"]["moved"] == {
        "start": 0.0,
        "start_heading": 0.0,
        "goal": 0.0,
        "goal_heading": 0.0,
        "obstacles": pytest.approx(0.03),
    }
    np.testing.assert_allclose(plan.scenario.goal[:2], first.scenario.goal[:2] + 0.05)  # what is not given stays
    assert tightspot.verify_plan(plan).upheld


def test_a_whole_turn_of_the_start_is_no_move():
    planner = tightspot.Planner("oblique", margin=MARGIN)
    first = planner.plan()
    plan = planner.plan(start=first.scenario.start + np.array([0.0, 0.0, 2 * np.pi, 0.0, 0.0]))
    assert plan.report["warm"]["used"]
    assert plan.report["warm"]["moved"]["start_heading"] == pytest.approx(0.0, abs=1e-12)
    assert plan.report["objective"]["value"] == pytest.approx(first.report["objective"]["value"], rel=1e-6)


def test_a_start_in_a_wall_is_refused_and_the_last_plan_stays():
    planner = tightspot.Planner("vertical", margin=MARGIN)
    first = planner.plan()
    wall = first.scenario.obstacles[0].exterior.mean(axis=0)
    with pytest.raises(BlockedError) as refusal:
        planner.plan(start=[*wall, 0.0, 0.0, 0.0])
    assert refusal.value.explanation is not None
    assert "start" in str(refusal.value)
    np.testing.assert_array_equal(planner.scenario.start, first.scenario.start)
    assert planner.plan(start=first.scenario.start + SHIFT).report["warm"]["used"]


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"start": [3.0, 0.0, 0.0, 0.0, 0.0]}, "start moved by 3.00 m"),
        ({"start": [0.0, 0.0, 0.5, 0.0, 0.0]}, "start turned by 29 deg"),
        ({"start": [0.0, 0.0, 0.0, 0.0, np.nan]}, "other entries of the start are free"),
    ],
)
def test_what_moved_far_is_planned_anew(change, reason):
    planner = tightspot.Planner("oblique", margin=MARGIN)
    first = planner.plan()
    plan = planner.plan(start=first.scenario.start + change["start"])
    assert plan.report["warm"] == {"used": False, "reason": reason}
    assert plan.certificate.certified


def test_obstacles_that_come_and_go_are_planned_anew():
    planner = tightspot.Planner("oblique", margin=MARGIN)
    first = planner.plan()
    plan = planner.plan(obstacles=first.scenario.obstacles[:1])
    assert plan.report["warm"] == {"used": False, "reason": "obstacles came, went or changed their shape"}
    assert len(plan.scenario.obstacles) == 1


def test_an_uncertified_warm_plan_is_made_anew(monkeypatch):
    planner = tightspot.Planner("oblique", margin=MARGIN)
    first = planner.plan()

    def fails(request, last, *_, **__):
        return [replace(last, verdict=None)]

    monkeypatch.setattr("tightspot.planner.planner.warm_rounds", fails)
    plan = planner.plan(start=first.scenario.start + SHIFT)
    assert not plan.report["warm"]["used"]
    assert "solver failed" in plan.report["warm"]["reason"]
    assert plan.certificate.certified


def test_the_kept_solver_makes_the_same_plans_as_a_new_one(monkeypatch):
    def moves(planner):
        start, plans = planner.plan().scenario.start, []
        for number in range(1, 5):
            changes = {"start": start + (-1) ** number * SHIFT / number}
            if number == 3:
                changes["obstacles"] = [one.shifted([0.01, 0.0]) for one in planner.scenario.obstacles]
            plans.append(planner.plan(**changes))
        return plans

    kept = moves(tightspot.Planner("vertical", margin=MARGIN))
    monkeypatch.setattr(StageProblem, "differs_in_ends_only", lambda self, other: False)
    for one, other in zip(kept, moves(tightspot.Planner("vertical", margin=MARGIN)), strict=True):
        assert one.report["warm"]["used"]
        np.testing.assert_array_equal(one.trajectory.states, other.trajectory.states)


def test_news_of_a_warm_plan_is_told():
    news = []
    planner = tightspot.Planner("oblique", margin=MARGIN, progress=news.append)
    start = planner.plan().scenario.start
    news.clear()
    planner.plan(start=start + SHIFT)
    assert [one.iteration.number for one in news if one.iteration][:2] == [0, 1]
    assert news[-1].phase == "verify"


def test_bad_arguments_are_told_as_by_plan():
    with pytest.raises(InputError, match="effort"):
        tightspot.Planner("oblique", effort="heroic")
    with pytest.raises(InputError, match="margin"):
        tightspot.Planner("oblique", margin=-1.0)
    planner = tightspot.Planner("oblique", margin=MARGIN)
    with pytest.raises(InputError, match="start"):
        planner.plan(start=[1.0, 2.0])
    with pytest.raises(InputError, match="goal"):
        planner.plan(goal=[np.nan] * 5)
    with pytest.raises(InputError, match=r"obstacles\[0\]"):
        planner.plan(obstacles=[[(0, 0), (1, 0), (1, 1)]])
    with pytest.raises(InputError, match="obstacles"):
        planner.plan(obstacles=3)


def test_a_planner_may_begin_with_a_blocked_start():
    scene = tightspot.load("oblique")
    wall = scene.obstacles[0].exterior.mean(axis=0)
    planner = tightspot.Planner(scene.with_(start=[*wall, 0.0, 0.0, 0.0]), margin=MARGIN)
    with pytest.raises(BlockedError):
        planner.plan()
    assert planner.plan(start=scene.start).certificate.certified


def test_many_small_moves_stay_certified():
    planner = tightspot.Planner("vertical", margin=MARGIN)
    plan = planner.plan()
    for _ in range(6):
        plan = planner.plan(start=plan.scenario.start + np.array([0.1, 0.02, 0.01, 0.0, 0.0]))
        assert plan.certificate.certified
        assert plan.report["warm"]["used"]
