"""Minimum penetration: where and how deep, when there is no way round."""

from dataclasses import fields, replace

import numpy as np
import pytest

from tightspot.errors import InputError, SceneError
from tightspot.geometry import ConvexPolygon, clearance, transform
from tightspot.planner import minimum_penetration
from tightspot.planner.shallowest import soft_solvers
from tightspot.scenarios import Obstacle, Scenario
from tightspot.solvers import SolveStatus, Stagewise
from tightspot.vehicles import SingleTrack, vehicle

CAR = vehicle("paper")
WIDTH = float(np.ptp(CAR.parts[0].polygon.vertices[:, 1]))


def box(name, x_min, x_max, y_min, y_max):
    return Obstacle(name, ConvexPolygon.rectangle(x_min, x_max, y_min, y_max).vertices)


def corridor(*obstacles, **changes):
    arguments = {"start": [0, 0, 0, 0, 0], "goal": [14, 0, 0, 0, 0]} | changes
    workspace = ConvexPolygon.rectangle(-3, 20, -3, 3)
    return Scenario(name="corridor", workspace=workspace, obstacles=obstacles, vehicle="paper", **arguments)


def depth_at(result, scenario, contact):
    """The contact's depth at its time, from the states at the knots around it."""
    states = np.array([np.interp(contact.time, result.trajectory.t, column) for column in result.trajectory.states.T])
    polygon = dict(scenario.obstacle_parts)[contact.obstacle]
    return -float(clearance(transform(CAR.parts[0].polygon.vertices, states[:3]), polygon.vertices))


def test_a_wall_that_must_be_crossed_is_named_with_time_and_depth():
    scenario = corridor(box("wall", 6.5, 6.9, -3, 3), box("post", 9.0, 9.4, -3.0, -0.9))
    result = minimum_penetration(scenario, steps=40)
    assert result.contacts
    assert {contact.part for contact in result.contacts} == {"body"}
    assert {contact.obstacle.split("/")[0] for contact in result.contacts} == {"wall"}, "the post can be passed"
    deepest = result.contacts[0]
    assert 0 < deepest.start <= deepest.time <= deepest.end < result.trajectory.duration
    assert result.depth == deepest.depth > 0.4
    assert depth_at(result, scenario, deepest) == pytest.approx(deepest.depth, abs=0.05)
    np.testing.assert_allclose(result.trajectory.states[0], scenario.start, atol=1e-6)
    np.testing.assert_allclose(result.trajectory.states[-1], scenario.goal, atol=1e-4)
    assert "body penetrates wall" in str(result)


def test_a_gap_too_narrow_costs_what_is_missing():
    """Both sides together must give way by the car's width less the gap's."""
    gap = WIDTH - 0.2
    scenario = corridor(box("left", 6, 8, gap / 2, 3), box("right", 6, 8, -3, -gap / 2))
    result = minimum_penetration(scenario, steps=40)
    sides = {contact.obstacle.split("/")[0]: contact.depth for contact in result.contacts}
    assert sum(sides.values()) == pytest.approx(0.2, abs=0.02)


@pytest.mark.parametrize("boxes", [[("wall", 6.5, 6.9, -3, 3)], [("left", 6, 8, 0.9, 3), ("right", 6, 8, -3, -0.9)]])
def test_the_stagewise_solver_finds_what_ipopt_finds_or_better(boxes):
    """The same sum: 100 times the time integral of what the pairs lack, and J."""
    scenario = corridor(*(box(*each) for each in boxes))
    ours = minimum_penetration(scenario, guess_="linear", steps=30)
    theirs = minimum_penetration(scenario, guess_="linear", steps=30, solver="ipopt")
    assert ours.solve.solver == "stagewise"
    assert theirs.solve.solver == "ipopt"
    assert ours.solve.objective <= 1.05 * theirs.solve.objective
    assert ours.depth <= theirs.depth + 0.02
    assert {contact.obstacle for contact in ours.contacts} == {contact.obstacle for contact in theirs.contacts}


def test_other_models_and_failures_go_to_ipopt(monkeypatch):
    assert [solver.name for solver in soft_solvers(CAR)] == ["stagewise", "ipopt"]
    own = type("Own", (SingleTrack,), {})(**{field.name: getattr(CAR, field.name) for field in fields(CAR)})
    assert [solver.name for solver in soft_solvers(own)] == ["ipopt"]
    solve = Stagewise.solve_stages

    def failing(self, problem, **options):
        return replace(solve(self, problem, **options), status=SolveStatus.NUMERICAL, violation=1.0)

    monkeypatch.setattr(Stagewise, "solve_stages", failing)
    result = minimum_penetration(corridor(box("wall", 6.5, 6.9, -3, 3)), guess_="linear", steps=20)
    assert result.solve.solver == "ipopt"
    assert result.depth > 0.4


def test_an_open_way_needs_no_collision():
    scenario = corridor(box("post", 6.5, 6.9, -3.0, -0.5))
    result = minimum_penetration(scenario, steps=40)
    assert result.contacts == ()
    assert result.depth == 0
    assert "No collision found" in str(result)


def test_start_in_collision_and_a_weight_of_nothing_are_refused():
    scenario = corridor(box("wall", 1.0, 2.0, -3, 3))
    with pytest.raises(SceneError, match="wall"):
        minimum_penetration(scenario)
    with pytest.raises(InputError, match="weight: 0"):
        minimum_penetration(corridor(), weight=0)
