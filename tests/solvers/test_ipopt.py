"""The IPOPT backend on small programs with known answers, and on programs that have none."""

import os
import signal
import threading
import time

import casadi as ca
import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.solvers import SOLVERS, Ipopt, Nlp, RowBlock, SolveStatus, WarmStart

INF = np.inf


def program(f, x, g=(), lbg=(), ubg=(), *, lbx=-INF, ubx=INF, x0=0.0, p=None, p0=(), blocks=()):
    n = x.numel()
    return Nlp(
        x,
        ca.SX(0, 1) if p is None else p,
        f,
        ca.vertcat(*g) if g else ca.SX(0, 1),
        *(np.broadcast_to(np.array(bound, float), (n,)).copy() for bound in (lbx, ubx)),
        np.array(lbg, float),
        np.array(ubg, float),
        np.broadcast_to(np.array(x0, float), (n,)).copy(),
        np.array(p0, float),
        (),
        blocks,
    )


def rosenbrock(n=2, **arguments):
    x = ca.SX.sym("x", n)
    f = ca.sum1((1 - x[:-1]) ** 2 + 100 * (x[1:] - x[:-1] ** 2) ** 2)
    return program(f, x, x0=-1.2, **arguments)


def endless():
    """A program whose solution takes many seconds: a valley of thousands of variables, one bend an iteration."""
    return Ipopt(time_limit=60.0, options={"max_iter": 100_000}), rosenbrock(5000)


def test_the_registry_knows_the_backend():
    assert SOLVERS["ipopt"] is Ipopt


def test_rosenbrock_is_solved_to_its_known_minimum():
    report = Ipopt().solve(rosenbrock())
    assert report.status is SolveStatus.SOLVED
    assert report.status.success
    np.testing.assert_allclose(report.x, [1.0, 1.0], atol=1e-8)
    assert report.objective == pytest.approx(0.0, abs=1e-15)
    assert report.stationarity < 1e-8
    assert report.violation == 0.0
    assert report.iterations > 5
    assert set(report.timings) == {"build", "solve", "functions", "callback"}


def test_multipliers_and_active_bounds_of_a_problem_solved_by_hand():
    # min x^2 + y^2 s.t. x + y = 2, x <= 1/2: (1/2, 3/2), lam_g = -3, lam_x = 2
    x = ca.SX.sym("x", 2)
    report = Ipopt().solve(program(ca.sumsqr(x), x, [x[0] + x[1]], [2.0], [2.0], ubx=[0.5, INF]))
    np.testing.assert_allclose(report.x, [0.5, 1.5], atol=1e-7)
    np.testing.assert_allclose(report.lam_g, [-3.0], atol=1e-6)
    np.testing.assert_allclose(report.lam_x, [2.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(report.g, [2.0], atol=1e-8)
    assert report.stationarity < 1e-6


def test_parameters_take_their_values_from_the_program():
    x, p = ca.SX.sym("x"), ca.SX.sym("p", 2)
    report = Ipopt().solve(program((x - p[0]) ** 2 + p[1], x, p=p, p0=[3.0, 7.0]))
    np.testing.assert_allclose(report.x, [3.0], atol=1e-8)
    assert report.objective == pytest.approx(7.0)


def test_bounds_are_kept_exactly():
    x = ca.SX.sym("x", 2)
    report = Ipopt().solve(program(ca.sum1(x), x, lbx=[0.25, -1.0], ubx=[INF, INF], x0=[1.0, 1.0]))
    assert (report.x >= [0.25, -1.0]).all()
    assert report.violation == 0.0


def test_no_feasible_point_is_a_status_with_the_worst_row_named():
    x = ca.SX.sym("x", 2)
    blocks = (RowBlock(slice(0, 1), "workspace", 1), RowBlock(slice(1, 2), "separation", 7, "body / wall/0"))
    infeasible = program(ca.sum1(x), x, [x[0], ca.sumsqr(x) + 1], [-1.0, -INF], [1.0, 0.0], blocks=blocks)
    report = Ipopt().solve(infeasible)
    assert report.status is SolveStatus.INFEASIBLE
    assert not report.status.success
    assert report.worst == "separation of body / wall/0 at knot 7"
    assert report.violation == pytest.approx(float(report.x @ report.x) + 1, rel=1e-9)
    assert report.violation >= 1.0


def test_violation_is_recomputed_and_counts_bounds_too():
    x = ca.SX.sym("x", 2)
    report = Ipopt(max_iterations=0).solve(program(ca.sumsqr(x), x, [x[0]], [5.0], [5.0], x0=1.0))
    assert report.status is SolveStatus.ITERATION_LIMIT
    assert report.violation == pytest.approx(abs(report.x[0] - 5.0))


@pytest.mark.parametrize(
    ("solver", "status"),
    [
        (Ipopt(max_iterations=3), SolveStatus.ITERATION_LIMIT),
        (Ipopt(time_limit=1e-9), SolveStatus.TIME_LIMIT),
        (Ipopt(options={"max_iter": 2}), SolveStatus.ITERATION_LIMIT),
    ],
)
def test_limits_are_statuses(solver, status):
    report = solver.solve(rosenbrock())
    assert report.status is status
    assert not report.status.success
    assert np.isfinite(report.x).all()


def test_what_deriving_the_functions_takes_is_taken_from_the_time_limit(monkeypatch):
    derive = Ipopt._build

    def slowly(self, *arguments):
        time.sleep(0.3)
        return derive(self, *arguments)

    monkeypatch.setattr(Ipopt, "_build", slowly)
    late = Ipopt(time_limit=0.2).solve(rosenbrock())
    assert late.status is SolveStatus.TIME_LIMIT
    assert late.timings["build"] >= 0.3
    assert Ipopt(time_limit=20.0).solve(rosenbrock()).status.success


def test_a_shorter_time_limit_is_taken_and_a_longer_one_is_not():
    assert Ipopt(time_limit=5.0).with_time_limit(2.0).time_limit == 2.0
    assert Ipopt(time_limit=5.0).with_time_limit(9.0).time_limit == 5.0
    assert Ipopt(time_limit=5.0).with_time_limit(-1.0).time_limit > 0


@pytest.mark.parametrize(
    ("f", "x0"),
    [
        (lambda x: x[0] + x[1], [0.0, 0.0]),  # unbounded, linear
        (lambda x: -(x[0] ** 4) - x[1], [1.0, 1.0]),  # unbounded, ever faster
        (lambda x: ca.sqrt(x[0] - 5) + x[1] ** 2, [0.0, 0.0]),  # not a number at the start
        (lambda x: ca.log(x[0]) + x[1] ** 2, [1.0, 1.0]),  # not a number on the way
    ],
)
def test_programs_without_a_solution_are_never_called_solved(f, x0):
    x = ca.SX.sym("x", 2)
    report = Ipopt().solve(program(f(x), x, x0=x0))
    assert report.status in (SolveStatus.DIVERGED, SolveStatus.NUMERICAL)
    assert report.backend_status


def test_contradictory_equations_are_not_called_solved():
    x = ca.SX.sym("x", 2)
    report = Ipopt().solve(program(ca.sumsqr(x), x, [x[0], x[0]], [0.0, 1.0], [0.0, 1.0]))
    assert not report.status.success
    assert report.violation >= 0.5 - 1e-6


def test_the_callback_sees_every_iteration():
    seen = []
    report = Ipopt().solve(rosenbrock(), callback=seen.append)
    assert [iteration.number for iteration in seen] == list(range(report.iterations + 1))
    assert seen[-1].objective == pytest.approx(report.objective, abs=1e-12)
    assert all(iteration.violation == 0.0 for iteration in seen)


def test_the_callback_sees_violations_fall():
    seen = []
    x = ca.SX.sym("x", 2)
    Ipopt().solve(program(ca.sumsqr(x), x, [x[0] * x[1]], [4.0], [4.0], x0=[1.0, 1.0]), callback=seen.append)
    assert seen[0].violation == pytest.approx(3.0)
    assert seen[-1].violation < 1e-6


def test_the_callback_stops_the_solve():
    report = Ipopt().solve(rosenbrock(), callback=lambda iteration: iteration.number < 3)
    assert report.status is SolveStatus.STOPPED
    assert report.iterations == 3
    assert report.x.shape == (2,)


@pytest.mark.parametrize("error", [KeyboardInterrupt, SystemExit, ValueError, ZeroDivisionError])
def test_exceptions_of_the_callback_come_out_as_they_are(error, capfd):
    def fail(iteration):
        raise error("mine")

    with pytest.raises(error, match="mine"):
        Ipopt().solve(rosenbrock(), callback=fail)
    assert capfd.readouterr() == ("", "")


def test_ctrl_c_during_a_callback_interrupts(capfd):
    def interrupted(iteration):
        if iteration.number == 2:
            signal.raise_signal(signal.SIGINT)

    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt):
        Ipopt().solve(rosenbrock(), callback=interrupted)
    assert signal.getsignal(signal.SIGINT) is before
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("callback", [None, lambda iteration: None])
def test_ctrl_c_during_the_solve_interrupts_it_soon(callback, capfd):
    solver, nlp = endless()
    timer = threading.Timer(1.5, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            solver.solve(nlp, callback=callback)
    finally:
        timer.cancel()
    assert capfd.readouterr() == ("", "")


def test_a_handler_of_the_caller_s_own_is_called_and_the_solve_stops():
    seen = []
    before = signal.signal(signal.SIGINT, lambda number, frame: seen.append(number))
    try:
        solver, nlp = endless()
        report = solver.solve(
            nlp,
            callback=lambda iteration: signal.raise_signal(signal.SIGINT) if iteration.number == 4 else None,
        )
    finally:
        signal.signal(signal.SIGINT, before)
    assert report.status is SolveStatus.STOPPED
    assert seen == [signal.SIGINT]


def test_solving_in_another_thread_works():
    reports = []
    thread = threading.Thread(target=lambda: reports.append(Ipopt().solve(rosenbrock())))
    thread.start()
    thread.join(30)
    assert reports[0].status is SolveStatus.SOLVED


def test_nothing_is_printed(capfd):
    x = ca.SX.sym("x", 2)
    Ipopt().solve(rosenbrock())
    Ipopt().solve(program(ca.sum1(x), x, [ca.sumsqr(x) + 1], [-INF], [0.0]))
    Ipopt().solve(program(ca.log(x[0]) + x[1] ** 2, x, x0=[1.0, 1.0]))
    Ipopt(max_iterations=1).solve(rosenbrock(), callback=lambda iteration: None)
    assert capfd.readouterr() == ("", "")


def test_a_warm_start_at_the_solution_takes_hardly_any_iteration():
    nlp = rosenbrock(10, lbx=-2.0, ubx=0.9)
    cold = Ipopt().solve(nlp)
    warm = Ipopt().solve(nlp, warm=WarmStart(cold.x, cold.lam_x, cold.lam_g))
    assert warm.status is SolveStatus.SOLVED
    assert warm.iterations < cold.iterations / 2
    np.testing.assert_allclose(warm.x, cold.x, atol=1e-6)
    only_x = Ipopt().solve(nlp, warm=WarmStart(cold.x))
    np.testing.assert_allclose(only_x.x, cold.x, atol=1e-6)


def test_unknown_options_are_refused_in_a_sentence():
    with pytest.raises(InputError, match=r"solver.options: IPOPT refuses the options: .*no_such_option"):
        Ipopt(options={"no_such_option": 1}).solve(rosenbrock())


def test_the_report_is_plain_data():
    data = Ipopt().solve(rosenbrock()).to_dict()
    assert data["status"] == "SOLVED"
    assert data["sentence"] == SolveStatus.SOLVED.sentence
    assert all(isinstance(value, str | int | float | dict) for value in data.values())


def test_every_status_has_a_sentence():
    for status in SolveStatus:
        assert status.sentence.endswith(".")
    assert [status for status in SolveStatus if status.success] == [
        SolveStatus.SOLVED,
        SolveStatus.ACCEPTABLE,
    ]


def test_a_start_that_is_not_a_number_is_not_solved_by_saying_so():
    x = ca.SX.sym("x", 2)
    report = Ipopt(tolerance=1e-4).solve(program(ca.SX(0), x, lbx=[1.0, -1.0], ubx=[2.0, 1.0], x0=[INF, 0.3]))
    assert report.status.success == bool(np.isfinite(report.x).all())
    assert np.isfinite(report.violation) == bool(np.isfinite(report.x).all())


def test_a_program_that_ipopt_does_not_begin_has_no_iterations():
    Ipopt().solve(rosenbrock())
    x = ca.SX.sym("x", 1)
    overdetermined = program(x**2, x, [x[0], x[0] - 1], [0.0, 0.0], [0.0, 0.0])
    for _ in range(2):
        report = Ipopt(max_iterations=3).solve(overdetermined)
        assert not report.status.success
        assert report.iterations <= 3
