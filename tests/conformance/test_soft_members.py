"""Soft pairs: one program in two forms, and the same optimum by the stagewise solver and by IPOPT.

Scenes whose way is blocked or narrow; the weight is chosen so that penetration and effort compete.
"""

from functools import cache

import casadi as ca
import numpy as np
import pytest

from tightspot.formulations import SoftSweptUnitNormalLine, SoftUnitNormalLine
from tightspot.geometry import ConvexPolygon, clearance, transform
from tightspot.guesses import LinearInterpolation
from tightspot.scenarios import Obstacle, Scenario
from tightspot.solvers import Ipopt, Stagewise, WarmStart
from tightspot.transcription import EnergyForm, Objective, Settings, TimeGrid, stage_problem, transcribe
from tightspot.vehicles import vehicle

MARGIN = 0.05
GRID = TimeGrid.uniform(14)
CAR = vehicle("paper")
MEMBERS = (SoftUnitNormalLine, SoftSweptUnitNormalLine)


def polygon(name, sides, x, y, radius):
    angles = 2 * np.pi * np.arange(sides) / sides + 0.3
    return Obstacle(name, np.column_stack([x + radius * np.cos(angles), y + radius * np.sin(angles)]))


def box(name, x_min, x_max, y_min, y_max):
    return Obstacle(name, ConvexPolygon.rectangle(x_min, x_max, y_min, y_max).vertices)


OBSTACLES = {
    "a gap too narrow": (box("left", 6, 8, 0.95, 3), box("right", 6, 8, -3, -0.95)),
    "a curtain": (box("curtain", 6.5, 6.9, -3, 3),),
    "posts": (polygon("triangle", 3, 5.0, 2.1, 1.2), polygon("round", 32, 7.5, -2.0, 1.3), polygon("nine", 9, 9, 2, 1)),
}
OBJECTIVES = (Objective(1.0), Objective(0.05, (1.0, 1.0), EnergyForm.NORMALISED))
everything = pytest.mark.parametrize("objective", OBJECTIVES, ids=("time-scaled", "normalised"))
members = pytest.mark.parametrize("member", MEMBERS, ids=lambda member: member.name)
scenes = pytest.mark.parametrize("scene", OBSTACLES)


@cache
def given(scene, member, objective):
    ends = {"start": [0, 0, 0, 0, 0], "goal": [14, 0.3, 0, 0, np.nan]}
    workspace = ConvexPolygon.rectangle(-3, 20, -3, 3)
    scenario = Scenario(name=scene, workspace=workspace, obstacles=OBSTACLES[scene], vehicle="paper", **ends)
    guess = LinearInterpolation().make(scenario, CAR, margin=MARGIN).trajectory
    return scenario, CAR, guess, Settings(objective, member(), margin=MARGIN, substeps=2, penalty_weight=20.0)


@cache
def solved(scene, member, objective):
    report = Stagewise().solve_stages(stage_problem(*given(scene, member, objective), grid=GRID))
    assert report.status.success, report.status.sentence
    return report, transcribe(*given(scene, member, objective), grid=GRID).nlp


@scenes
@members
@everything
def test_it_satisfies_the_symbolic_programs_conditions(scene, member, objective):
    report, nlp = solved(scene, member, objective)
    gradient, jacobian = ca.gradient(nlp.f, nlp.x), ca.jacobian(nlp.g, nlp.x)
    of = ca.Function("conditions", [nlp.x, nlp.p], [nlp.f, nlp.g, gradient, jacobian])
    f, g, gradient, jacobian = (value.full() for value in of(report.x, nlp.p0))
    assert report.objective == pytest.approx(f.item(), rel=1e-9)
    largest = max(1.0, np.abs(report.lam_g).max() / 100)
    assert np.abs(gradient.ravel() + jacobian.T @ report.lam_g + report.lam_x).max() < 1e-6 * largest
    for value, low, high, lam in (
        (g.ravel(), nlp.lbg, nlp.ubg, report.lam_g),
        (report.x, nlp.lbx, nlp.ubx, report.lam_x),
    ):
        assert (low - value).max() < 1e-6
        assert (value - high).max() < 1e-6
        used = (low < high) & (lam != 0)
        room = np.where(lam > 0, high - value, value - low)
        assert np.abs(lam[used] * room[used]).max(initial=0.0) < 1e-6


@scenes
@members
@everything
def test_the_stagewise_optimum_is_one_for_ipopt(scene, member, objective):
    """Started there with its multipliers, IPOPT stays."""
    ours, nlp = solved(scene, member, objective)
    theirs = Ipopt(time_limit=20.0).solve(nlp, warm=WarmStart(ours.x, ours.lam_x, ours.lam_g))
    assert theirs.status.success, theirs.status.sentence
    assert theirs.objective == pytest.approx(ours.objective, rel=1e-6)
    states = slice(0, CAR.n_states * (GRID.steps + 1))
    np.testing.assert_allclose(theirs.x[states], ours.x[states], atol=0.05)  # optima are flat


@everything
def test_both_find_the_same_value_from_a_straight_line(objective):
    """Through a curtain there is one way; elsewhere there are several, and who finds which is not promised."""
    ours, nlp = solved("a curtain", SoftSweptUnitNormalLine, objective)
    theirs = Ipopt(time_limit=20.0).solve(nlp)
    assert theirs.status.success, theirs.status.sentence
    assert theirs.objective == pytest.approx(ours.objective, rel=1e-6)


@scenes
@everything
def test_penetrations_are_what_geometry_lacks(scene, objective):
    report, _ = solved(scene, SoftUnitNormalLine, objective)
    scenario = given(scene, SoftUnitNormalLine, objective)[0]
    knots = report.pairs[:, 0] + 1
    body = transform(CAR.parts[0].polygon.vertices, report.states[knots, :3])
    parts = [part.vertices for _, part in scenario.obstacle_parts]
    distance = np.array([float(clearance(V, parts[j])) for V, j in zip(body, report.pairs[:, 2], strict=True)])
    inner = knots < GRID.steps
    lacking = np.maximum(0.0, MARGIN - distance)
    np.testing.assert_allclose(report.penetrations[inner], lacking[inner], atol=1e-4)


def test_who_must_not_jump_penetrates():
    for scene in ("a gap too narrow", "a curtain"):
        assert solved(scene, SoftSweptUnitNormalLine, OBJECTIVES[0])[0].penetrations.max() > 0.05
