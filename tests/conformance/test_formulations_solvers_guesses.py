"""Every formulation, every solver and every guess, on scenes small enough to solve each in a moment.

The formulations made for use meet every guess on every scene; each other member, and each other solver, has to do its
work once.
"""

from functools import cache
from itertools import product

import numpy as np
import pytest

from tightspot.formulations import FORMULATIONS
from tightspot.geometry import ConvexPolygon, clearance, transform
from tightspot.guesses import GUESSES, GivenPath
from tightspot.scenarios import Obstacle, Scenario
from tightspot.solvers import SOLVERS
from tightspot.transcription import Objective, Settings, TimeGrid, transcribe
from tightspot.vehicles import vehicle
from tightspot.verification import minimum_clearance

MARGIN = 0.05
STEPS = 14
OBJECTIVE = Objective(time_weight=0.1)


def box(name, x_min, x_max, y_min, y_max):
    return Obstacle(name, ConvexPolygon.rectangle(x_min, x_max, y_min, y_max).vertices)


SCENES = {
    "around a corner": Scenario(
        name="around a corner",
        workspace=ConvexPolygon.rectangle(-4, 14, -4, 10),
        obstacles=(box("corner", -4, 3.5, 2.0, 10),),
        start=[0, 0, 0, 0, 0],
        goal=[7, 5, np.pi / 2, 0, 0],
        vehicle="obca",
    ),
    "back between two": Scenario(
        name="back between two",
        workspace=ConvexPolygon.rectangle(-6, 12, -8, 6),
        obstacles=(box("left", -6, -1.6, -8, -3), box("right", 2.0, 12, -8, -3)),
        start=[3.5, 0, 0.6, 0, 0],
        goal=[0, -5.5, np.pi / 2, 0, 0],
        vehicle="tpcap",
    ),
    "between two tines": Scenario(
        name="between two tines",
        workspace=ConvexPolygon.rectangle(-5, 8, -3, 3),
        obstacles=(box("pallet block", 4.3, 5.1, -0.12, 0.12),),
        start=[-2.5, 0.3, 0, 0, 0],
        goal=[2.2, 0, 0, 0, 0],
        vehicle="forklift",
    ),
}
PATHS = {
    "around a corner": [(3, 0, 0), (6, 1.5, 1.0)],
    "back between two": [(2, -1, 0.9), (0.2, -3.5, 1.5)],
    "between two tines": [(-1, 0.15, -0.1), (1, 0, 0)],
}
GUESS_NAMES = [*GUESSES, GivenPath.name]
FOR_USE = ("separating-line", "unit-normal-line", "swept-line")
ONCE = ("around a corner", "hybrid-astar")
ARGUMENTS = {"disc-cover": {"cell": 1.0}}  # few discs are covered soon


def tried(scene, formulation, solver, start):
    """All of it would take an hour."""
    return (scene, start) == ONCE or (formulation in FOR_USE and solver == "ipopt")


CASES = [case for case in product(SCENES, FORMULATIONS, SOLVERS, GUESS_NAMES) if tried(*case)]


@cache
def guess(scene, name):
    member = GivenPath(PATHS[scene]) if name == GivenPath.name else GUESSES[name]()
    result = member.make(SCENES[scene], vehicle(SCENES[scene].vehicle), margin=MARGIN)
    assert result.trajectory is not None, result.reason
    return result.trajectory


@cache
def solve(scene, formulation, solver, start):
    settings = Settings(OBJECTIVE, FORMULATIONS[formulation](**ARGUMENTS.get(formulation, {})), margin=MARGIN)
    scenario = SCENES[scene]
    problem = transcribe(
        scenario, vehicle(scenario.vehicle), guess(scene, start), settings, grid=TimeGrid.uniform(STEPS)
    )
    report = SOLVERS[solver](time_limit=20.0).solve(problem.nlp)
    return problem, report, problem.trajectory(report.x)


everything = pytest.mark.parametrize(("scene", "formulation", "solver", "start"), CASES, ids=str)


@everything
def test_it_is_solved_and_what_it_promises_holds(scene, formulation, solver, start):
    problem, report, trajectory = solve(scene, formulation, solver, start)
    assert report.status.success, (report.status.sentence, report.worst)
    assert report.violation < 1e-6
    assert report.stationarity < 1e-5
    scenario, car = SCENES[scene], problem.vehicle
    np.testing.assert_allclose(trajectory.states[0], scenario.start, atol=1e-7)
    np.testing.assert_allclose(trajectory.states[-1], scenario.goal, atol=1e-7)
    assert report.objective == pytest.approx(OBJECTIVE.value(trajectory.t, trajectory.inputs), rel=1e-9)
    for part in car.parts:
        V = transform(part.polygon.vertices, trajectory.poses[1:])
        assert (scenario.workspace.b + 1e-6 >= V @ scenario.workspace.A.T).all()
        for _, polygon in scenario.obstacle_parts if FORMULATIONS[formulation].is_exact else ():
            assert clearance(V, polygon.vertices).min() >= MARGIN - 1e-6, "at the knots"
    if FORMULATIONS[formulation].holds == "interval":
        series = minimum_clearance(scenario, car, trajectory, dt=0.01)
        assert series.minimum >= MARGIN - 1e-3, "between them, but for the integrator's error"


@pytest.mark.parametrize("start", GUESS_NAMES)
@pytest.mark.parametrize("scene", SCENES)
def test_exact_formulations_at_the_knots_agree_on_the_optimum(scene, start):
    exact = [name for name, member in FORMULATIONS.items() if member.is_exact and member.expresses_margin]
    knots = [name for name in exact if FORMULATIONS[name].holds == "knots"]
    cases = [(name, solver) for name, solver in product(knots, SOLVERS) if tried(scene, name, solver, start)]
    values = {case: solve(scene, *case, start)[1].objective for case in cases}
    assert len(values) >= 2
    for value in values.values():
        assert value == pytest.approx(values["separating-line", "ipopt"], rel=1e-6), values


@pytest.mark.parametrize("start", GUESS_NAMES)
@pytest.mark.parametrize("scene", SCENES)
def test_holding_on_the_interval_costs_something_but_little(scene, start):
    at_knots, between = (solve(scene, name, "ipopt", start)[1].objective for name in ("separating-line", "swept-line"))
    assert at_knots * (1 - 1e-6) <= between <= 1.5 * at_knots
