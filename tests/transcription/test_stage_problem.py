"""The stage problem and the Nlp are the same program: values and derivatives at random points."""

import casadi as ca
import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.formulations import (
    FarkasDual,
    SeparatingLine,
    SoftSweptUnitNormalLine,
    SoftUnitNormalLine,
    SweptLine,
    SweptUnitNormalLine,
    UnitNormalLine,
)
from tightspot.geometry import ConvexPolygon
from tightspot.guesses import LinearInterpolation
from tightspot.scenarios import Obstacle, Scenario
from tightspot.solvers.stage_core import core_solver
from tightspot.solvers.stage_order import CorePoint, order_of
from tightspot.transcription import EnergyForm, Objective, Settings, TimeGrid, transcribe
from tightspot.transcription.stage_problem import stage_problem
from tightspot.vehicles import vehicle

SOFT = (SoftUnitNormalLine, SoftSweptUnitNormalLine)
FORMULATIONS = (UnitNormalLine, SeparatingLine, SweptUnitNormalLine, SweptLine, *SOFT)


def scene(**changes):
    arguments = {
        "name": "small",
        "workspace": ConvexPolygon.rectangle(-6, 12, -6, 6),
        "obstacles": (
            Obstacle("triangle", np.array([(3, 3), (6, 3), (5, 5)])),
            Obstacle("square", np.array([(7, -5), (9, -5), (9, -3), (7, -3)])),
        ),
        "start": [0, 0, 0, 0, 0],
        "goal": [6, 0.5, 0.2, 0, 0],
    }
    return Scenario(**arguments | changes)


def both(formulation, *, car="paper", steps=3, seed=0, **changes):
    """The Nlp and the stage problem of a small scene with random masks, an uneven grid, and what else is asked for."""
    rng = np.random.default_rng(seed)
    body, scenario = vehicle(car), scene()
    guess = LinearInterpolation().make(scenario, body, margin=0.0).trajectory
    fractions = np.concatenate([[0], np.cumsum(rng.uniform(0.5, 1.5, steps))])
    grid = TimeGrid(fractions / fractions[-1])
    arguments = {"margin": 0.3, "end_margin": 0.1, "workspace_margin": 0.05, "substeps": 3}
    if formulation.holds == "interval":
        arguments["poses"] = tuple(int(count) for count in rng.integers(0, 4, steps))
    ends = {name: changes.pop(name) for name in ("start", "goal") if name in changes}
    settings = Settings(formulation=formulation, **arguments | changes)
    masks = {
        "active": rng.random((steps, len(body.parts), 2)) < 0.7,
        "walls": rng.random((steps, len(body.parts), 4)) < 0.6,
    }
    args = (scenario, body, guess, settings)
    return transcribe(*args, grid=grid, **masks, **ends).nlp, stage_problem(*args, grid=grid, **masks, **ends)


def composed(nlp, problem):
    """The core's variables as symbols y, and the Nlp's x as a function of them, with multipliers of its rows."""
    order, n_pairs = order_of(problem), len(problem.pairs)
    n_x, n_u, steps = problem.start.size, problem.input_weights.size, problem.steps
    y = ca.SX.sym("y", (steps + 1) * n_x + steps * n_u + 1 + 2 * n_pairs + int(problem.soft.sum()))
    x = ca.SX(nlp.n_variables, 1)
    states, inputs = order.states.ravel(), order.inputs.ravel()
    for place, index in enumerate([*states, *inputs, order.time]):
        x[int(index)] = y[place]
    first = states.size + inputs.size + 1
    moving = {int(obstacle): m for m, obstacle in enumerate(problem.motion_obstacles)}
    for i in range(n_pairs):
        phi, k, obstacle = y[first + 2 * i], int(problem.pairs[i, 0]), int(problem.pairs[i, 2])
        n = ca.vertcat(ca.cos(phi), ca.sin(phi))
        mu = y[first + 2 * i + 1] + ca.dot(n, problem.pair_origins[i])
        at, pose = int(order.lines[i]), y[(k + 1) * n_x : (k + 1) * n_x + 3]
        values = [phi, mu]
        if problem.form.vector:
            values = [n[0], n[1], mu]
        elif problem.form.in_body:
            if obstacle in moving:
                m, sample = moving[obstacle], int(np.cumsum(problem.pieces + 1)[k] - 1)
                ahead = y[first - 1] - problem.motion_times[m]
                frame = ca.DM(problem.motion_poses[m, sample]) + ahead * ca.DM(problem.motion_slopes[m, sample])
                turned = ca.vertcat(
                    ca.horzcat(ca.cos(frame[2]), ca.sin(frame[2])), ca.horzcat(-ca.sin(frame[2]), ca.cos(frame[2]))
                )
                pose = ca.vertcat(turned @ (pose[:2] - frame[:2]), pose[2] - frame[2])
            values = [phi - pose[2], mu - ca.dot(n, pose[:2])]
        if problem.soft[i]:
            values.append(y[first + 2 * n_pairs + int(problem.soft[:i].sum())])
        for offset, value in enumerate(values):
            x[at + offset] = value
    return y, x, order


CASES = [
    *((member, {}) for member in FORMULATIONS),
    (SweptUnitNormalLine, {"car": "forklift", "steps": 2}),
    (UnitNormalLine, {"car": "forklift", "objective": Objective(0.01, (1.0, 2.0), EnergyForm.NORMALISED)}),
    (SweptLine, {"final_time": 7.0, "goal": [6, np.nan, np.nan, np.nan, 0.0], "seed": 3}),
    (SweptUnitNormalLine, {"start": [0, 0, np.nan, np.nan, 0], "seed": 4, "end_margin": None}),
    (SoftSweptUnitNormalLine, {"car": "forklift", "penalty_weight": 7.0, "final_time": 7.0, "seed": 5}),
    (SoftUnitNormalLine, {"start": [0, 0, np.nan, np.nan, 0], "seed": 6, "steps": 6}),
]


@pytest.mark.parametrize(("member", "changes"), CASES)
def test_same_objective_rows_and_derivatives(member, changes):
    compare(*both(member(), **changes))


def compare(nlp, problem):
    """Both programs at a random point: values, gradient and Hessian of the Lagrangian."""
    y, x, order = composed(nlp, problem)
    assert order.time + 1 == nlp.n_variables
    assert order.n_rows == nlp.n_rows
    rng = np.random.default_rng(1)
    v = problem.starting_point() + 0.2 * rng.normal(size=y.numel())
    v[(problem.steps + 1) * 5 + problem.steps * 2] = 6.5
    lam = rng.normal(size=problem.steps * 5)
    z = rng.uniform(0.1, 2.0, order.rows.size)
    core = core_solver(problem).derivatives(v, lam, z)
    point = order.point(CorePoint(v, z, lam, np.zeros(y.numel()), core["rows"], np.zeros(z.size), core["defects"]))
    lam_g = point.lam_g.copy()
    lam_g[order.units] = 0.0
    lagrangian = nlp.f + ca.dot(ca.DM(lam_g), nlp.g)
    f, g, whole = (ca.substitute(expression, nlp.x, x) for expression in (nlp.f, nlp.g, lagrangian))
    hessian, gradient = ca.hessian(whole, y)
    evaluate = ca.Function("evaluate", [y, nlp.p], [f, g, gradient, hessian, x])
    values = [np.array(value) for value in evaluate(v, nlp.p0)]
    assert core["objective"] == pytest.approx(values[0].item(), rel=1e-12)
    assert point.g == pytest.approx(values[1].ravel(), abs=1e-9)
    assert core["gradient"] == pytest.approx(values[2].ravel(), abs=1e-8)
    assert core["hessian"] == pytest.approx(values[3], abs=1e-7)
    assert point.x == pytest.approx(values[4].ravel(), abs=1e-12)


@pytest.mark.parametrize("member", FORMULATIONS)
def test_starts_at_the_same_point(member):
    same_start(*both(member()))


def same_start(nlp, problem):
    """States, inputs, t_f and lines that both begin with."""
    order = order_of(problem)
    core = CorePoint(problem.starting_point(), *(np.zeros(1),) * 6)
    rows, dynamics = np.zeros(order.rows.size), np.zeros(order.dynamics.size)
    point = order.point(core._replace(z=rows, lam=dynamics, bounds=np.zeros(order.time + 1), rows=rows, demands=rows,
                                      defects=dynamics))  # fmt: skip
    angles = np.setdiff1d(np.arange(point.x.size), order.lines) if not problem.form.vector else slice(None)
    assert point.x[angles] == pytest.approx(nlp.x0[angles], abs=1e-9)
    assert np.cos(point.x[order.lines] - nlp.x0[order.lines]) == pytest.approx(1.0)


def test_refuses_what_the_core_does_not_know():
    with pytest.raises(InputError, match="farkas-dual"):
        both(FarkasDual())
