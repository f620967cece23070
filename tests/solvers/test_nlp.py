"""The Nlp object: bookkeeping of rows, violations, and what does not fit together."""

import casadi as ca
import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.solvers import BACKENDS, Nlp, RowBlock

BLOCKS = (RowBlock(slice(0, 2), "dynamics", 3), RowBlock(slice(2, 3), "separation", 4, "body / wall/0"))


def make(**changes):
    x = ca.SX.sym("x", 2)
    arguments = {
        "x": x,
        "p": ca.SX.sym("p"),
        "f": ca.sumsqr(x),
        "g": ca.vertcat(x[0], x[1], x[0] * x[1]),
        "lbx": np.full(2, -np.inf),
        "ubx": np.full(2, np.inf),
        "lbg": np.array([0.0, 0.0, -np.inf]),
        "ubg": np.array([0.0, 0.0, 1.0]),
        "x0": np.zeros(2),
        "p0": np.zeros(1),
        "stages": (),
        "blocks": BLOCKS,
    }
    return Nlp(**arguments | changes)


def test_counts_and_equations():
    nlp = make()
    assert (nlp.n_variables, nlp.n_rows) == (2, 3)
    np.testing.assert_array_equal(nlp.equality, [True, True, False])


def test_violation_is_the_distance_from_the_bounds():
    np.testing.assert_array_equal(make().violation(np.array([-0.5, 0.25, 4.0])), [0.5, 0.25, 3.0])
    np.testing.assert_array_equal(make().violation(np.array([0.0, 0.0, -9.0])), 0.0)


def test_the_worst_row_is_named_for_people():
    block, violation = make().worst_row(np.array([0.1, 0.0, 3.0]))
    assert violation == 2.0
    assert block.describe() == "separation of body / wall/0 at knot 4"
    block, violation = make().worst_row(np.array([0.1, -0.2, 0.0]))
    assert (violation, block.describe()) == (0.2, "dynamics at knot 3")


def test_a_row_that_is_not_a_number_is_the_worst():
    block, violation = make().worst_row(np.array([5.0, 0.0, np.nan]))
    assert block is BLOCKS[1]
    assert violation == np.inf


def test_a_program_without_rows_has_no_worst_row():
    nlp = make(g=ca.SX(0, 1), lbg=np.zeros(0), ubg=np.zeros(0), blocks=())
    assert nlp.worst_row(np.zeros(0)) == (None, 0.0)


def test_rows_outside_all_blocks_have_no_block():
    assert make().block_of(3) is None
    assert make().block_of(2) is BLOCKS[1]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"lbx": np.zeros(3)}, r"nlp.lbx: has shape \(3,\), but x has 2 entries"),
        ({"x0": np.zeros((2, 1))}, r"nlp.x0: has shape \(2, 1\)"),
        ({"ubg": np.zeros(2)}, r"nlp.ubg: has shape \(2,\), but g has 3 entries"),
        ({"p0": np.zeros(0)}, r"nlp.p0: has shape \(0,\), but p has 1 entries"),
        ({"lbx": np.array([0.0, 2.0]), "ubx": np.ones(2)}, r"nlp.lbx\[1\]: 2.0 must be at most ubx = 1.0"),
        ({"lbx": np.full(2, np.inf)}, r"nlp.lbx\[0\]: inf .* leave room for a finite number"),
        ({"lbg": np.array([0.0, np.nan, 0.0])}, r"nlp.lbg\[1\]: nan must be at most ubg = 0.0"),
    ],
)
def test_what_does_not_fit_is_refused(changes, words):
    with pytest.raises(InputError, match=words):
        make(**changes)


@pytest.mark.parametrize("backend", BACKENDS.values(), ids=lambda backend: backend.name)
@pytest.mark.parametrize(
    ("name", "value"),
    [(name, value) for name in ("tolerance", "time_limit") for value in (0, -1.0, np.nan, np.inf, None, "1", True)]
    + [("max_iterations", value) for value in (-1, 1.5, None, "3", True, 10**12)],
)
def test_limits_that_make_no_sense_are_named(backend, name, value):
    with pytest.raises(InputError, match=rf"solver\.{name}: "):
        backend(**{name: value})


@pytest.mark.parametrize("backend", BACKENDS.values(), ids=lambda backend: backend.name)
def test_limits_may_be_of_any_type_of_number(backend):
    solver = backend(tolerance=np.float32(1e-6), time_limit=5, max_iterations=np.int64(7))
    assert solver.with_time_limit(1.0).time_limit == 1.0


def test_a_point_that_is_not_a_number_violates():
    nlp = make()
    for bad in (np.nan, np.inf):
        assert nlp.worst(np.array([bad, 0.0]), np.zeros(3))[1] > 1e300
        assert nlp.worst(np.zeros(2), np.array([0.0, 0.0, bad]))[1] > 1e300
