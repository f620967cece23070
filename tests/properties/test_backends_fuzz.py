"""Whatever small program IPOPT and Uno are given, they end in a status within their limits, and "solved" is no lie."""

import time

import casadi as ca
import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from tightspot.errors import InputError
from tightspot.solvers import Ipopt, Nlp, RowBlock, Sqp

TERMS = (
    lambda a, b: a,
    lambda a, b: a * b,
    lambda a, b: a**2,
    lambda a, b: ca.sin(a),
    lambda a, b: ca.exp(a),
    lambda a, b: ca.log(a),
    lambda a, b: ca.sqrt(b),
    lambda a, b: 1 / a,
    lambda a, b: ca.fabs(a),
)
term = st.tuples(
    st.sampled_from(TERMS), st.integers(0, 3), st.integers(0, 3), st.sampled_from([1.0, -1.0, 0.5, 1e6, 0.0])
)
expression = st.lists(term, max_size=3)
bound = st.tuples(st.sampled_from([-np.inf, -1.0, 0.0, 1.0, -100.0]), st.sampled_from([0.0, 1e-12, 1.0, np.inf]))
number = st.sampled_from([0.0, 1.0, -1.0, 0.3, 1e6, 1e300, np.nan, np.inf])


@st.composite
def programs(draw):
    n, rows = draw(st.integers(1, 4)), draw(st.lists(expression, max_size=4))
    x = ca.SX.sym("x", n)

    def summed(terms):
        return sum((weight * make(x[i % n], x[j % n]) for make, i, j, weight in terms), start=ca.SX(0))

    def bounds(count):
        pairs = [draw(bound) for _ in range(count)]
        low = np.array([low for low, _ in pairs])
        return low, np.array([1.0 if np.isinf(low) else low + width for low, width in pairs])

    f = summed(draw(expression)) + (ca.sumsqr(x - 1) if draw(st.booleans()) else 0)
    g = ca.vertcat(*map(summed, rows)) if rows else ca.SX(0, 1)
    lbx, ubx = bounds(n)
    lbg, ubg = bounds(len(rows))
    start = np.array([draw(number) for _ in range(n)])
    blocks = (RowBlock(slice(0, len(rows)), "row", 0),)
    try:
        return Nlp(x, ca.SX(0, 1), f, g, lbx, ubx, lbg, ubg, start, np.zeros(0), (), blocks)
    except InputError:
        assume(False)


def check(nlp, report, limit):
    """Against CasADi's own derivatives."""
    assert 0 <= report.iterations <= limit
    assert report.status.sentence
    if not report.status.success:
        return
    functions = ca.Function("f", [nlp.x], [nlp.f, nlp.g, ca.gradient(nlp.f, nlp.x), ca.jacobian(nlp.g, nlp.x)])
    f, g, slope, jacobian = (np.array(value, float) for value in functions(report.x))
    assert np.isfinite(report.x).all()
    assert np.isfinite(f).all()
    for values, low, high in ((report.x, nlp.lbx, nlp.ubx), (g.ravel(), nlp.lbg, nlp.ubg)):
        assert (values >= low - 1e-6 * np.maximum(1, np.abs(values))).all()
        assert (values <= high + 1e-6 * np.maximum(1, np.abs(values))).all()
    gradient = slope.ravel() + (jacobian.T @ report.lam_g if nlp.n_rows else 0) + report.lam_x
    scale = max(1.0, np.abs(slope).max(), np.abs(report.lam_g).max(initial=0.0), np.abs(report.lam_x).max())
    assert np.abs(gradient).max() <= 1e-4 * scale


@pytest.mark.parametrize(("backend", "examples"), [(Ipopt, 60), (Sqp, 25)], ids=["ipopt", "sqp"])
def test_every_program_ends_in_a_status(backend, examples):
    @settings(max_examples=examples, deadline=None, suppress_health_check=[HealthCheck.too_slow])
    @given(programs(), st.sampled_from([0, 3, 100]))
    def attack(nlp, limit):
        began = time.perf_counter()
        report = backend(max_iterations=limit, time_limit=1.0).solve(nlp)
        assert time.perf_counter() - began < 30.0, "it came back"
        check(nlp, report, limit)

    attack()
