"""The fatrop backend: the program it is given, its answers, and that it never takes longer or says more than it may."""

import os
import signal
import threading
import time
from collections import deque
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.formulations import SeparatingLine, SoftSignedDistance, SweptUnitNormalLine, UnitNormalLine
from tightspot.geometry import ConvexPolygon
from tightspot.guesses import LinearInterpolation
from tightspot.scenarios import Obstacle, Scenario
from tightspot.solvers import BACKENDS, SOLVERS, Fatrop, Ipopt, Nlp, SolveStatus, Stage, WarmStart, processes
from tightspot.solvers.functions import lagrangian_gradient, values
from tightspot.solvers.stage_form import stage_form
from tightspot.transcription import Objective, Settings, TimeGrid, transcribe
from tightspot.vehicles import vehicle

INF = np.inf
SCENE = Scenario(
    name="small",
    workspace=ConvexPolygon.rectangle(-6, 14, -6, 6),
    obstacles=(Obstacle("block", np.array([(3, -3), (5, -3), (5, -1.3), (3, -1.3)])),),
    start=[0, 0, 0, 0, 0],
    goal=[8, 0.5, 0.2, 0, 0],
)


def program(formulation=None, steps=6, objective=None):
    car = vehicle("paper")
    guess = LinearInterpolation().make(SCENE, car, margin=0.0).trajectory
    settings = Settings(objective or Objective(), formulation or UnitNormalLine(), margin=0.05)
    return transcribe(SCENE, car, guess, settings, grid=TimeGrid.uniform(steps)).nlp


def unstaged(f, x, g=(), lbg=(), ubg=(), *, x0=0.0, lbx=-INF, ubx=INF):
    n = x.numel()
    bounds = (np.broadcast_to(np.array(bound, float), (n,)).copy() for bound in (lbx, ubx))
    rows = ca.vertcat(*g) if g else ca.SX(0, 1)
    start = np.broadcast_to(np.array(x0, float), (n,)).copy()
    return Nlp(x, ca.SX(0, 1), f, rows, *bounds, np.array(lbg, float), np.array(ubg, float), start, np.zeros(0), (), ())


def test_the_registries_know_the_backend():
    assert SOLVERS["fatrop"] is Fatrop
    assert BACKENDS["fatrop"] is Fatrop


FORMULATIONS = [UnitNormalLine(), SweptUnitNormalLine(), SeparatingLine(), SoftSignedDistance()]


@pytest.mark.parametrize("formulation", FORMULATIONS, ids=lambda member: member.name)
def test_the_rewritten_program_says_the_same(formulation):
    nlp = program(formulation, steps=4)
    form = stage_form(nlp)
    rng = np.random.default_rng(3)
    x = nlp.x0 + 0.1 * rng.normal(size=nlp.n_variables)
    x[nlp.shared] = 7.0
    f, g = values(nlp, x)
    other = ca.Function("other", [form.x, nlp.p], [form.f, form.g])
    objective, rows = other(x[form.variables], nlp.p0)
    assert float(objective) == pytest.approx(f, rel=1e-12)
    rows, own = np.array(rows).ravel(), form.rows >= 0
    assert np.abs(rows[~own]).max(initial=0.0) == 0.0, "copies of t_f agree"
    dynamics = form.signs < 0
    np.testing.assert_allclose(rows[own & dynamics], -g[form.rows[own & dynamics]], atol=1e-12)
    if formulation.holds == "knots":
        np.testing.assert_allclose(rows[~dynamics], g[form.rows[~dynamics]], atol=1e-12)


@pytest.mark.parametrize("formulation", FORMULATIONS[:2], ids=lambda member: member.name)
def test_only_dynamics_connect_the_stages_and_each_in_its_block(formulation):
    nlp = program(formulation, steps=4)
    form = stage_form(nlp)
    columns = np.repeat(np.arange(len(form.nx)), np.add(form.nx, form.nu))
    blocks = [[k, -1 if kind == "dynamics" else k] for k in range(len(form.nx)) for kind in ("dynamics", "path")]
    counts = [(*form.nx[1:], 0)[k] if way < 0 else form.ng[k] for k, way in blocks]
    row_stage, is_path = (np.repeat(np.array(blocks)[:, 0], counts), np.repeat(np.array(blocks)[:, 1] >= 0, counts))
    row, column = (np.array(v) for v in ca.jacobian_sparsity(form.g, form.x).get_triplet())
    ahead = columns[column] - row_stage[row]
    assert set(ahead[is_path[row]]) == {0}
    assert set(ahead[~is_path[row]]) == {0, 1}
    hessian = ca.hessian(form.f + ca.sum1(form.g), form.x)[0].sparsity().get_triplet()
    assert (columns[np.array(hessian[0])] == columns[np.array(hessian[1])]).all()


def test_dimensions_of_the_stages():
    form = stage_form(program(UnitNormalLine(), steps=3))
    assert form.nx == (6, 6, 6, 6)
    assert form.nu == (2, 4, 4, 2), "u and the line of knot k; no line at the start, no input at the end"
    moved = stage_form(program(SweptUnitNormalLine(), steps=3))
    assert moved.nu == (4, 4, 4, 0), "an interval's line stands where the interval begins"


def test_rows_that_couple_distant_stages_are_refused():
    nlp = program(steps=4)
    coupled = nlp.f + nlp.x[nlp.stages[0].control][0] * nlp.x[nlp.stages[3].control][0]
    fields = {name: getattr(nlp, name) for name in nlp.__dataclass_fields__}
    with pytest.raises(InputError, match=r"nlp\.f: .*couples stages \[0, 3\]; use ipopt"):
        Fatrop().solve(Nlp(**fields | {"f": coupled}))
    rows = nlp.g + 0
    rows[nlp.stages[1].path.start] += nlp.x[nlp.stages[4].state][0]
    with pytest.raises(InputError, match="not neighbours"):
        Fatrop().solve(Nlp(**fields | {"g": rows}))


@pytest.mark.parametrize("formulation", FORMULATIONS[:2], ids=lambda member: member.name)
def test_it_finds_ipopt_s_optimum_and_multipliers(formulation):
    nlp = program(formulation)
    mine = Fatrop().solve(nlp)
    theirs = Ipopt().solve(nlp, warm=WarmStart(mine.x, mine.lam_x, mine.lam_g))
    assert mine.status is SolveStatus.SOLVED
    assert mine.objective == pytest.approx(theirs.objective, rel=1e-6)
    np.testing.assert_allclose(mine.x, theirs.x, atol=1e-4)
    gradient = lagrangian_gradient(nlp, mine.x, mine.lam_g) + mine.lam_x
    assert np.abs(gradient).max() < 1e-5
    slack = np.minimum(mine.g - nlp.lbg, nlp.ubg - mine.g)
    assert np.abs(mine.lam_g * slack)[~nlp.equality].max() < 1e-5, "complementarity"


def test_a_program_without_stages_is_one_stage():
    x = ca.SX.sym("x", 2)
    report = Fatrop().solve(unstaged(ca.sumsqr(x), x, [x[0] + x[1]], [2.0], [2.0], ubx=[0.5, INF], x0=[0.2, 0.1]))
    assert report.status is SolveStatus.SOLVED
    np.testing.assert_allclose(report.x, [0.5, 1.5], atol=1e-6)
    np.testing.assert_allclose(report.lam_g, [-3.0], atol=1e-5)


def test_stages_that_share_nothing():
    x = ca.SX.sym("x", 2)
    stage = Stage(0, slice(0, 2), slice(2, 2), slice(2, 2), slice(0, 0), slice(0, 1))
    plain = unstaged(ca.sumsqr(x), x, [x[0] + x[1]], [2.0], [2.0], x0=[0.2, 0.1])
    report = Fatrop().solve(replace(plain, stages=(stage,)))
    np.testing.assert_allclose(report.x, [1.0, 1.0], atol=1e-6)


def test_too_many_equations_in_a_stage_are_a_status():
    x = ca.SX.sym("x", 1)
    report = Fatrop().solve(unstaged(x**2, x, [x, x - 1], [0.0, 0.0], [0.0, 0.0]))
    assert not report.status.success


def test_limits_and_stops_are_statuses():
    nlp = program()
    limited = Fatrop(max_iterations=2).solve(nlp)
    assert limited.status is SolveStatus.ITERATION_LIMIT
    assert limited.iterations == 2
    seen = []
    stopped = Fatrop().solve(nlp, callback=lambda iteration: seen.append(iteration) or iteration.number < 3)
    assert stopped.status is SolveStatus.STOPPED
    assert [iteration.number for iteration in seen] == [0, 1, 2, 3]
    assert stopped.iterations == 3
    assert seen[0].objective != seen[-1].objective


@pytest.mark.parametrize("bad", [np.nan, 1e300])
def test_from_a_hopeless_start_it_ends_within_the_time_limit(bad):
    nlp = program()
    Fatrop(max_iterations=0).solve(nlp)
    began = time.perf_counter()
    report = Fatrop(time_limit=2.0).solve(nlp, warm=WarmStart(np.full(nlp.n_variables, bad)))
    assert not report.status.success
    assert time.perf_counter() - began < 20.0
    again = Fatrop().solve(nlp)
    assert again.status is SolveStatus.SOLVED, "what was stopped does no harm to the next"


def test_a_process_that_dies_is_a_status():
    nlp = program()

    def shoot(iteration):
        if iteration.number == 1:
            for line in threads():
                line.kill()

    def threads():
        return [found.process for found in workers]

    workers = []
    original = processes.Worker.__init__

    def remember(self, script):
        original(self, script)
        workers.append(self)

    processes.dismiss_all()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(processes.Worker, "__init__", remember)
        report = Fatrop().solve(nlp, callback=shoot)
    assert report.status in (SolveStatus.NUMERICAL, SolveStatus.SOLVED), "it may have been faster than the shot"
    if report.status is SolveStatus.NUMERICAL:
        assert "killed" in report.backend_status or "ended" in report.backend_status


def test_no_process_is_a_status(monkeypatch):
    processes.dismiss_all()
    monkeypatch.setattr("sys.executable", "/nonexistent/python")
    report = Fatrop().solve(program())
    assert report.status is SolveStatus.FAILED
    assert "cannot be started" in report.backend_status


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError])
def test_exceptions_of_the_callback_come_out_as_they_are(error):
    def fail(iteration):
        raise error("mine")

    with pytest.raises(error, match="mine"):
        Fatrop().solve(program(), callback=fail)


def test_ctrl_c_interrupts():
    nlp = program()
    Fatrop(max_iterations=0).solve(nlp)
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    before = signal.getsignal(signal.SIGINT)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        deque(Fatrop().solve(nlp) for _ in range(1000))
    assert signal.getsignal(signal.SIGINT) is before


def test_an_option_it_does_not_know_is_named():
    with pytest.raises(InputError, match=r"solver\.options: fatrop refuses: .*no_such_option"):
        Fatrop(options={"no_such_option": 1}).solve(program())


def test_no_feasible_point_is_not_called_solved():
    x = ca.SX.sym("x", 2)
    report = Fatrop(time_limit=5.0).solve(unstaged(ca.sum1(x), x, [x[0], ca.sumsqr(x) + 1], [-1, -INF], [1, 0], x0=1.0))
    assert not report.status.success
    assert report.violation >= 0.9


def test_nothing_is_printed(capfd):
    Fatrop().solve(program())
    assert capfd.readouterr() == ("", "")
