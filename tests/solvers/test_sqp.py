"""The SQP backend on small programs with known answers, on programs that have none, and against IPOPT."""

import os
import signal
import threading
import time
from collections import deque

import casadi as ca
import numpy as np
import pytest
from tests.solvers.test_ipopt import INF, program, rosenbrock

from tightspot.errors import InputError
from tightspot.solvers import SOLVERS, Ipopt, RowBlock, SolveStatus, Sqp, WarmStart, remote


def test_the_registry_knows_the_backend():
    assert SOLVERS["sqp"] is Sqp


def test_rosenbrock_is_solved_to_its_known_minimum():
    report = Sqp().solve(rosenbrock())
    assert report.status is SolveStatus.SOLVED
    np.testing.assert_allclose(report.x, [1.0, 1.0], atol=1e-7)
    assert report.stationarity < 1e-6
    assert report.iterations > 2
    assert set(report.timings) == {"build", "solve", "functions"}


def test_multipliers_and_active_bounds_of_a_problem_solved_by_hand():
    # min x^2 + y^2 s.t. x + y = 2, x <= 1/2: (1/2, 3/2), lam_g = -3, lam_x = 2
    x = ca.SX.sym("x", 2)
    report = Sqp().solve(program(ca.sumsqr(x), x, [x[0] + x[1]], [2.0], [2.0], ubx=[0.5, INF]))
    np.testing.assert_allclose(report.x, [0.5, 1.5], atol=1e-7)
    np.testing.assert_allclose(report.lam_g, [-3.0], atol=1e-6)
    np.testing.assert_allclose(report.lam_x, [2.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(report.g, [2.0], atol=1e-8)


def test_fixed_variables_stay_where_they_are_and_have_multipliers(capfd):
    # min x^2 + y^2 s.t. x + y = 2, x = 1/2 by its bounds: the same solution, lam_x = 2
    x = ca.SX.sym("x", 2)
    fixed = program(ca.sumsqr(x), x, [x[0] + x[1]], [2.0], [2.0], lbx=[0.5, -INF], ubx=[0.5, INF], x0=[0.5, 0.0])
    report = Sqp().solve(fixed)
    np.testing.assert_allclose(report.x, [0.5, 1.5], atol=1e-8)
    np.testing.assert_allclose(report.lam_x, [2.0, 0.0], atol=1e-6)
    assert report.stationarity < 1e-8
    assert capfd.readouterr() == ("", ""), "a solver says nothing"


def test_parameters_take_their_values_from_the_program():
    x, p = ca.SX.sym("x"), ca.SX.sym("p", 2)
    report = Sqp().solve(program((x - p[0]) ** 2 + p[1], x, p=p, p0=[3.0, 7.0]))
    np.testing.assert_allclose(report.x, [3.0], atol=1e-8)
    assert report.objective == pytest.approx(7.0)


def test_no_feasible_point_is_a_status_with_the_worst_row_named():
    x = ca.SX.sym("x", 2)
    blocks = (RowBlock(slice(0, 1), "workspace", 1), RowBlock(slice(1, 2), "separation", 7, "body / wall/0"))
    infeasible = program(ca.sum1(x), x, [x[0], ca.sumsqr(x) + 1], [-1.0, -INF], [1.0, 0.0], blocks=blocks)
    report = Sqp().solve(infeasible)
    assert report.status is SolveStatus.INFEASIBLE
    assert report.worst == "separation of body / wall/0 at knot 7"
    assert report.violation >= 1.0


def test_an_unbounded_problem_is_a_status():
    x = ca.SX.sym("x", 1)
    report = Sqp().solve(program(-(x**4), x, x0=1.0))
    assert report.status in (SolveStatus.DIVERGED, SolveStatus.NUMERICAL, SolveStatus.ITERATION_LIMIT)


def test_what_cannot_be_evaluated_is_a_status():
    x = ca.SX.sym("x", 1)
    report = Sqp().solve(program(ca.sqrt(x - 5) + x**2, x, x0=0.0))
    assert not report.status.success


def hopeless():
    """From this start Uno (CasADi 3.8.2) does not come back: it goes on without an iteration."""
    x = ca.SX.sym("x", 6)
    f = 1e8 * ca.sqrt(x[3]) + x[4] ** 4 + 1e-8 * x[0] * x[2] - x[0] + ca.sumsqr(x - 1)
    lbx, ubx = [0, 0, 0, -1, -1e-9, -1e-9], [0, 1e-12, 1e-12, 2, -1e-9, -1e-9]
    rows = [3 * x[2] ** 2, ca.fabs(x[4])]
    return program(f, x, rows, [-1e-9, 0.0], [3.0, 1.0], lbx=lbx, ubx=ubx, x0=[1, -1, 1e-8, 1e6, 0, -1])


def test_what_hangs_is_stopped_when_the_time_is_up():
    began = time.perf_counter()
    report = Sqp(time_limit=0.5, max_iterations=5).solve(hopeless())
    assert report.iterations <= 5
    assert report.status.success or report.status.sentence
    assert time.perf_counter() - began < 30.0
    again = Sqp().solve(rosenbrock())
    assert again.status is SolveStatus.SOLVED, "what was stopped does no harm to the next"


def test_a_process_that_crashes_is_a_status(monkeypatch):
    monkeypatch.setattr(remote, "SCRIPT", remote.SCRIPT.with_name("__init__.py"))  # ends without an answer
    report = Sqp().solve(rosenbrock())
    assert report.status is SolveStatus.NUMERICAL
    assert "its process was" in report.backend_status


def test_nothing_to_move_is_a_status():
    x = ca.SX.sym("x", 2)
    report = Sqp().solve(program(ca.sumsqr(x), x, [x[0]], [0.0], [1.0], lbx=[2, 3], ubx=[2, 3], x0=[0, 0]))
    assert not report.status.success
    np.testing.assert_array_equal(report.x, [2, 3])
    assert report.violation == 1.0


@pytest.mark.parametrize(
    ("solver", "status"),
    [
        (Sqp(max_iterations=3), SolveStatus.ITERATION_LIMIT),
        (Sqp(time_limit=1e-9), SolveStatus.TIME_LIMIT),
        (Sqp(options={"max_iterations": 2}), SolveStatus.ITERATION_LIMIT),
    ],
)
def test_limits_are_statuses(solver, status):
    report = solver.solve(rosenbrock())
    assert report.status is status
    assert np.isfinite(report.x).all()


def test_with_time_limit_takes_the_shorter_one():
    assert Sqp(time_limit=5.0).with_time_limit(2.0).time_limit == 2.0
    assert Sqp(time_limit=5.0).with_time_limit(20.0).time_limit == 5.0


def test_the_callback_sees_every_iteration_and_can_stop():
    seen = []
    report = Sqp().solve(rosenbrock(), callback=lambda news: seen.append(news) or len(seen) < 4)
    assert report.status is SolveStatus.STOPPED
    assert len(seen) == 4
    assert seen[0].number == 0
    assert all(np.isfinite(news.objective) for news in seen)


def test_what_the_callback_raises_comes_out():
    def fail(news):
        raise ValueError("enough")

    with pytest.raises(ValueError, match="enough"):
        Sqp().solve(rosenbrock(), callback=fail)


def test_an_interrupt_comes_out_as_such():
    timer = threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    slow = Sqp(tolerance=1e-300, max_iterations=10**7, time_limit=20.0, options={"loose_primal_tolerance": 1e-300})
    problem = rosenbrock(60)
    with pytest.raises(KeyboardInterrupt):
        deque(slow.solve(problem) for _ in range(1000))
    timer.join()


def test_a_preset_it_does_not_know_is_named():
    with pytest.raises(InputError, match=r"Uno refuses the options: .*nosuch"):
        Sqp(preset="nosuch").solve(rosenbrock())


def test_a_warm_start_at_the_solution_needs_hardly_an_iteration():
    first = Sqp().solve(rosenbrock(6))
    again = Sqp().solve(rosenbrock(6), warm=WarmStart(first.x, first.lam_x, first.lam_g))
    assert again.status is SolveStatus.SOLVED
    assert again.iterations <= 1
    assert first.iterations > 5


def test_ipopt_and_sqp_agree_on_multipliers():
    x = ca.SX.sym("x", 3)
    rows = [x[0] * x[1] * x[2], x[0] ** 2 + x[1]]
    problem = program(ca.sumsqr(x - 1), x, rows, [2.0, -INF], [2.0, 3.0], lbx=0.1, ubx=3.0, x0=1.0)
    one, other = Sqp().solve(problem), Ipopt().solve(problem)
    np.testing.assert_allclose(one.x, other.x, atol=1e-6)
    np.testing.assert_allclose(one.lam_g, other.lam_g, atol=1e-5)
    np.testing.assert_allclose(one.lam_x, other.lam_x, atol=1e-5)
