"""The stagewise solver against IPOPT: same optima, and its points satisfy the Nlp's optimality conditions."""

import os
import signal
import threading
import time
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.formulations import SeparatingLine, SweptLine, SweptUnitNormalLine, UnitNormalLine
from tightspot.guesses import HybridAStar
from tightspot.scenarios import check
from tightspot.scenarios.library import builtin
from tightspot.solvers import Ipopt
from tightspot.solvers.stage_core import core_solver
from tightspot.solvers.stagewise import Stagewise
from tightspot.transcription import Objective, Settings, TimeGrid, transcribe
from tightspot.transcription.stage_problem import stage_problem
from tightspot.vehicles import vehicle

FORMULATIONS = (UnitNormalLine, SeparatingLine, SweptUnitNormalLine, SweptLine)


def case(scene, formulation, *, steps=20, **changes):
    scenario, car = builtin(scene), vehicle("paper")
    guess = HybridAStar().make(scenario, car, margin=0.05).trajectory
    arguments = {"margin": 0.02, "substeps": 2, "workspace_margin": 0.002} | changes
    settings = Settings(formulation=formulation, **arguments)
    return (scenario, car, guess, settings), {"grid": TimeGrid.uniform(steps)}


def kkt_residuals(nlp, report):
    """Violation, stationarity, complementarity and wrong signs of a report, from the Nlp's own symbols."""
    gradient, jacobian = ca.gradient(nlp.f, nlp.x), ca.jacobian(nlp.g, nlp.x)
    functions = ca.Function("all", [nlp.x, nlp.p], [nlp.f, nlp.g, gradient, jacobian])
    f, g, gradient, jacobian = (np.array(value) for value in functions(report.x, nlp.p0))
    g, gradient = g.ravel(), gradient.ravel()
    x, lam_x, lam_g = report.x, report.lam_x, report.lam_g
    stationarity = np.abs(gradient + jacobian.T @ lam_g + lam_x).max()
    products = []
    for value, low, high, lam in ((x, nlp.lbx, nlp.ubx, lam_x), (g, nlp.lbg, nlp.ubg, lam_g)):
        free = low < high
        room = np.where(lam > 0, high - value, value - low)
        used = free & (lam != 0)
        products.append(lam[used] * room[used])
    violation = max(nlp.violation(g).max(), np.maximum(nlp.lbx - x, x - nlp.ubx).max())
    assert report.objective == pytest.approx(f.item(), rel=1e-9)
    assert report.g == pytest.approx(g, abs=1e-7)
    return violation, stationarity, np.abs(np.concatenate(products)).max()


@pytest.mark.parametrize("member", FORMULATIONS)
@pytest.mark.parametrize("scene", ["oblique", "vertical", "parallel"])
def test_satisfies_the_programs_optimality_conditions(scene, member):
    arguments, grid = case(scene, member())
    report = Stagewise().solve_stages(stage_problem(*arguments, **grid))
    assert report.status.success, report.status
    nlp = transcribe(*arguments, **grid).nlp
    assert report.x.shape == nlp.x0.shape
    for residual in kkt_residuals(nlp, report):
        assert residual < 1e-6


def shifted(scene, seed):
    """The scene with a random other start from which there is a way, and its hybrid A* guess."""
    rng, base, car = np.random.default_rng(seed), builtin(scene), vehicle("paper")
    while True:
        start = base.start + np.concatenate([rng.uniform(-1, 1, 3) * [1.0, 0.5, 0.2], np.zeros(2)])
        scenario = replace(base, start=start)
        try:
            check(scenario, car, 0.05)
        except InputError:
            continue
        guess = HybridAStar().make(scenario, car, margin=0.05).trajectory
        if guess is not None:
            return scenario, guess


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("weight", [1.0, 0.01])
@pytest.mark.parametrize("scene", ["oblique", "vertical", "parallel"])
def test_conditions_hold_from_random_starts(scene, weight, seed):
    """At the knots, and on the whole interval, which starts from the solution at the knots."""
    (scenario, guess), car, grid = shifted(scene, seed), vehicle("paper"), TimeGrid.uniform(20)
    arguments = {"objective": Objective(weight), "margin": 0.002, "substeps": 4 if seed else 1}
    for member in (SeparatingLine(), SweptLine()):
        given = (scenario, car, guess, Settings(formulation=member, **arguments))
        report = Stagewise().solve_stages(stage_problem(*given, grid=grid))
        assert report.status.success, report.status.sentence
        for residual in kkt_residuals(transcribe(*given, grid=grid).nlp, report):
            assert residual < 1e-6
        times = report.final_time * grid.fractions
        guess = replace(guess, t=times, states=report.states, inputs=report.inputs)


@pytest.mark.parametrize(("scene", "weight"), [("oblique", 1.0), ("vertical", 0.01), ("parallel", 1.0)])
def test_same_optimum_as_ipopt_from_the_solution(scene, weight):
    """IPOPT, started at our point, stays there."""
    arguments, grid = case(scene, SweptUnitNormalLine(), objective=Objective(weight))
    report = Stagewise().solve_stages(stage_problem(*arguments, **grid))
    nlp = transcribe(*arguments, **grid).nlp
    from tightspot.solvers import WarmStart

    again = Ipopt().solve(nlp, warm=WarmStart(report.x, report.lam_x, report.lam_g))
    assert again.status.success
    assert again.objective == pytest.approx(report.objective, rel=1e-6)


def test_positions_kept_for_a_structure_belong_to_every_problem_of_it():
    from tightspot.solvers.stage_order import order_of

    arguments, grid = case("vertical", SeparatingLine())
    problem = stage_problem(*arguments, **grid)
    moved = problem.replaced(obstacle_vertices=problem.obstacle_vertices + 1.0)
    fewer = problem.with_pairs(slice(1, None))
    first, second, third = order_of(problem), order_of(moved), order_of(fewer)
    assert second.problem is moved
    assert np.array_equal(first.rows, second.rows)
    assert np.array_equal(first.lines, second.lines)
    assert third.n_rows < first.n_rows
    assert third.lines.size == first.lines.size - 1
    assert np.array_equal(order_of(problem).rows, first.rows)


def test_an_interrupt_is_seen_while_the_core_works_even_without_a_callback():
    arguments, grid = case("parallel", SweptLine(), steps=8000)
    problem = stage_problem(*arguments, **grid)
    core = core_solver(problem)
    core.set(problem.starting_point())
    seen = []
    before = signal.signal(signal.SIGINT, lambda number, frame: seen.append(time.perf_counter()))
    timer = threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT))
    try:
        timer.start()
        core.solve(Stagewise(max_iterations=40).options(), None)
        ended = time.perf_counter()
        timer.join()
    finally:
        signal.signal(signal.SIGINT, before)
    assert len(seen) == 1
    assert seen[0] < ended - 0.02


def test_an_interrupt_ends_a_solve_that_has_no_callback():
    arguments, grid = case("parallel", SweptLine(), steps=8000)
    problem = stage_problem(*arguments, **grid)
    timer = threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        Stagewise(time_limit=20.0).solve_stages(problem)
    timer.join()
