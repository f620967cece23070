"""Every formulation, every solver and every guess, on scenes small enough to solve each in a moment.

"around a block" is the scene that binds: every formulation meets every guess there, by every solver that can use it.
The formulations made for use meet every guess on the other scenes, too.

From a guess that keeps clear of the obstacles every case must be solved, and by IPOPT with a formulation made for use
from every guess. Other cases from a guess through the obstacle end at a solution or say that they do not: which of the
two may hang on the last digit of a number, so of these most must be solved, not each.
"""

from functools import cache
from itertools import product

import numpy as np
import pytest

from tightspot.formulations import FORMULATIONS
from tightspot.geometry import ConvexPolygon, clearance, transform
from tightspot.guesses import GUESSES, GivenPath
from tightspot.scenarios import Obstacle, Scenario
from tightspot.solvers import SOLVERS, Stagewise, WarmStart
from tightspot.transcription import Objective, Settings, TimeGrid, stage_problem, transcribe
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
    "around a block": Scenario(
        name="around a block",
        workspace=ConvexPolygon.rectangle(-3, 14, -3, 6),
        obstacles=(box("block", 4.5, 6.0, -3, -0.4),),
        start=[0, 0, 0, 0, 0],
        goal=[10, 0, 0, 0, 0],
        vehicle="obca",
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
    "around a block": [(3, 0.5, 0.2), (6, 0.9, 0.0)],
    "between two tines": [(-1, 0.15, -0.1), (1, 0, 0)],
}
GUESS_NAMES = [*GUESSES, GivenPath.name]
FOR_USE = ("separating-line", "unit-normal-line", "swept-line")
WIDE = "around a block"
SQP_CANNOT = ("vertex-exclusion", "shared-vertex-exclusion", "farkas-dual")  # often ends at its iteration limit
SQP_MAY_FAIL = ("separating-gap",)  # of guesses that agree to twelve digits, one leads it to an infeasible point
FATROP_CAN = ("unit-normal-line",)  # others have null directions or end at its iteration limit
NECESSARY_ONLY = "triangle-area"  # not exact: from a guess through the block it ends in the block
ROUGH = ("reeds-shepp", "simplified", "linear")  # they do not look at obstacles
ARGUMENTS = {"disc-cover": {"cell": 1.0}}  # few discs are covered soon


def promised(scene, formulation, solver, start):
    """Must this case be solved, on whatever machine?"""
    if solver == "sqp" and formulation in SQP_MAY_FAIL:
        return False
    return start not in ROUGH or (formulation in FOR_USE and solver == "ipopt")


def tried(scene, formulation, solver, start):
    """Everything that is usable on the wide scene; elsewhere what is made for use."""
    if scene != WIDE:
        searched = start == "hybrid-astar"
        usable = solver == "ipopt" or (solver == "fatrop" and formulation in FATROP_CAN and searched)
        return formulation in FOR_USE and usable
    if formulation == NECESSARY_ONLY and start in ROUGH:
        return False
    if solver == "fatrop":
        return formulation in FATROP_CAN
    return solver != "sqp" or (formulation not in SQP_CANNOT and start != "linear")


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
    if not promised(scene, formulation, solver, start) and not report.status.success:
        assert report.status.sentence
        assert report.x.shape == problem.nlp.x0.shape
        return
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


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("start", ROUGH)
def test_most_are_solved_from_a_guess_through_the_obstacle(solver, start):
    cases = [case for case in CASES if case[0] == WIDE and case[2:] == (solver, start)]
    solved = [case for case in cases if solve(*case)[1].status.success]
    assert len(solved) >= 0.6 * len(cases), [case[1] for case in cases if case not in solved]


EXACT_AT_KNOTS = [
    name
    for name, member in FORMULATIONS.items()
    if member.is_exact and member.expresses_margin and member.holds == "knots"
]


def solutions(formulation):
    """(poses, J) on the wide scene, one a solver and guess."""
    solved = [solve(*case) for case in CASES if case[:2] == (WIDE, formulation)]
    return [(trajectory.poses, report.objective) for _, report, trajectory in solved if report.status.success]


@pytest.mark.parametrize("formulation", EXACT_AT_KNOTS)
def test_exact_formulations_at_the_knots_agree_where_they_find_the_same_manoeuvre(formulation):
    compared = 0
    for (poses, value), (other, wanted) in product(solutions(formulation), solutions("separating-line")):
        if np.abs(poses - other).max() < 0.01:
            assert value == pytest.approx(wanted, rel=1e-6)
            compared += 1
    assert compared >= 2


STAGEWISE = ("separating-line", "unit-normal-line", "swept-line", "swept-unit-normal-line")


@pytest.mark.parametrize("formulation", STAGEWISE)
@pytest.mark.parametrize("scene", SCENES)
def test_the_stagewise_optimum_is_one_for_ipopt(scene, formulation):
    """Started there with its multipliers, IPOPT stays: the two programs and their optima are the same."""
    scenario, car = SCENES[scene], vehicle(SCENES[scene].vehicle)
    settings = Settings(OBJECTIVE, FORMULATIONS[formulation](), margin=MARGIN)
    arguments, grid = (scenario, car, guess(scene, "hybrid-astar"), settings), TimeGrid.uniform(STEPS)
    ours = Stagewise().solve_stages(stage_problem(*arguments, grid=grid))
    assert ours.status.success, (ours.status.sentence, ours.worst)
    nlp = transcribe(*arguments, grid=grid).nlp
    theirs = SOLVERS["ipopt"](time_limit=20.0).solve(nlp, warm=WarmStart(ours.x, ours.lam_x, ours.lam_g))
    assert theirs.status.success, theirs.status.sentence
    assert theirs.objective == pytest.approx(ours.objective, rel=1e-6)
    states = slice(0, car.n_states * (STEPS + 1))
    np.testing.assert_allclose(theirs.x[states], ours.x[states], atol=0.05)  # optima are flat


def test_the_wide_scene_binds():
    free = Scenario(
        name="free", workspace=SCENES[WIDE].workspace, obstacles=(), start=SCENES[WIDE].start, goal=SCENES[WIDE].goal
    )
    problem = transcribe(
        free, vehicle("obca"), guess(WIDE, "hybrid-astar"), Settings(OBJECTIVE), grid=TimeGrid.uniform(STEPS)
    )
    unhindered = SOLVERS["ipopt"](time_limit=20.0).solve(problem.nlp).objective
    assert all(value > 1.05 * unhindered for _, value in solutions("separating-line"))


@pytest.mark.parametrize("start", GUESS_NAMES)
@pytest.mark.parametrize("scene", SCENES)
def test_holding_on_the_interval_costs_something_but_little(scene, start):
    at_knots, between = (solve(scene, name, "ipopt", start)[1].objective for name in ("separating-line", "swept-line"))
    assert 0.95 * at_knots <= between <= 1.5 * at_knots, "two local solvers may end in neighbouring optima"


def test_a_solver_that_gives_up_gives_a_report():
    _, report, _ = solve(WIDE, NECESSARY_ONLY, "sqp", "linear")
    assert not report.status.success
    assert report.violation > 0
    assert report.status.sentence
