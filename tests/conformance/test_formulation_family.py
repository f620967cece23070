"""The family of formulations on two small scenes: exact members agree, and what is only necessary is caught."""

from functools import cache

import numpy as np
import pytest

import tightspot
from tightspot.errors import PlanningError
from tightspot.formulations import (
    FORMULATIONS,
    FarkasDual,
    NormalisedFarkasDual,
    SignedDistanceDual,
    TriangleArea,
    VertexExclusion,
)
from tightspot.geometry import ConvexPolygon, clearance, transform
from tightspot.guesses import GivenPath, LinearInterpolation
from tightspot.scenarios import Obstacle, Scenario
from tightspot.solvers import Ipopt
from tightspot.transcription import Settings, TimeGrid, transcribe
from tightspot.vehicles import vehicle
from tightspot.verification import verify

CAR = vehicle("paper")
MARGIN = 0.05


def label(member):
    return member.name + (f" x{member.copies}" if getattr(member, "copies", 1) > 1 else "")


SINGLE = [member() for member in FORMULATIONS.values() if member.holds == "knots"]
KNOTS = [*SINGLE, *(member(copies=4) for member in (FarkasDual, NormalisedFarkasDual, SignedDistanceDual))]
MEASURING = [member for member in KNOTS if member.expresses_margin]


def box(name, x_min, x_max, y_min, y_max):
    return Obstacle(name, ConvexPolygon.rectangle(x_min, x_max, y_min, y_max).vertices)


POSTS = Scenario(
    name="between posts",
    workspace=ConvexPolygon.rectangle(-4, 16, -4, 6),
    obstacles=(box("post", 6.0, 6.8, -4, -0.7), Obstacle("wedge", np.array([(7.0, 6), (8.0, 2.2), (9.0, 6)]))),
    start=[0, 0, 0, 0, 0],
    goal=[11, 0.2, 0, 0, 0],
    vehicle="paper",
)
WALL = Scenario(
    name="a thin wall right across",
    workspace=ConvexPolygon.rectangle(-3, 20, -3, 3),
    obstacles=(box("wall", 6.5, 6.8, -3, 3),),
    start=[0, 0, 0, 0, 0],
    goal=[14, 0, 0, 0, 0],
    vehicle="paper",
)


@cache
def solve(scenario, member, guess):
    settings = Settings(formulation=member, margin=MARGIN, final_time=(1.0, 20.0))
    start = guess.make(scenario, CAR, margin=MARGIN).trajectory
    problem = transcribe(scenario, CAR, start, settings, grid=TimeGrid.uniform(16))
    report = Ipopt(time_limit=20.0, max_iterations=400).solve(problem.nlp)
    return report, problem.trajectory(report.x)


def at_knots(scenario, trajectory):
    V = transform(CAR.parts[0].polygon.vertices, trajectory.poses[1:])
    return min(clearance(V, polygon.vertices).min() for _, polygon in scenario.obstacle_parts)


@pytest.mark.parametrize("member", MEASURING, ids=label)
def test_members_that_measure_distance_agree_on_the_optimum(member):
    path = GivenPath([(4, 0.3, 0.1), (7, 0.5, 0)])
    report, trajectory = solve(POSTS, member, path)
    reference, _ = solve(POSTS, MEASURING[0], path)
    assert report.status.success, (report.status, report.worst)
    assert report.objective == pytest.approx(reference.objective, rel=1e-6)
    assert at_knots(POSTS, trajectory) == pytest.approx(MARGIN, abs=1e-6), "the margin is active and a distance"


@pytest.mark.parametrize("member", KNOTS, ids=label)
def test_only_members_that_are_not_exact_drive_through_a_thin_wall(member):
    """The car is longer than it can drive in an interval, so it has to stand in the wall at some knot."""
    report, trajectory = solve(WALL, member, LinearInterpolation(duration=15.0))
    if isinstance(member, VertexExclusion | TriangleArea):
        assert report.status.success
        assert at_knots(WALL, trajectory) < -0.5, "a plus sign"
        certificate = verify(WALL, CAR, trajectory, margin=MARGIN)
        assert not certificate.certified
        assert certificate.witness is not None
        assert "wall" in str(certificate.witness)
    else:
        assert not report.status.success
        assert report.violation > 1e-5


@pytest.mark.parametrize("name", ["vertex-exclusion", "triangle-area"])
def test_what_is_only_necessary_is_never_returned_as_a_plan(name):
    with pytest.raises(PlanningError) as caught:
        tightspot.plan(WALL, formulation=name, guess="linear", steps=16, refinements=1, time_limit=20.0)
    assert not any(outcome["certified"] for outcome in caught.value.report["rounds"])
