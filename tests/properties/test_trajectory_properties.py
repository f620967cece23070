"""Trajectories survive their file and their resampling; odd files are refused, nothing else happens."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from tightspot.errors import InputError
from tightspot.trajectory import Trajectory
from tightspot.transcription import TimeGrid, resample

number = st.floats(-1e6, 1e6)


@st.composite
def trajectories(draw):
    knots = draw(st.integers(2, 12))
    gaps = draw(arrays(float, knots - 1, elements=st.floats(1e-3, 10)))
    t = draw(st.floats(-5, 5)) + np.r_[0.0, np.cumsum(gaps)]
    states = draw(arrays(float, (knots, 5), elements=number))
    return Trajectory(t, states, draw(arrays(float, (knots - 1, 2), elements=number)))


@st.composite
def grids(draw):
    widths = draw(arrays(float, st.integers(1, 15), elements=st.floats(0.05, 1.0)))
    fractions = np.r_[0.0, np.cumsum(widths)] / widths.sum()
    fractions[-1] = 1.0
    return TimeGrid(fractions)


@given(trajectories())
def test_the_file_form_is_exact(trajectory):
    copy = Trajectory.from_dict(json.loads(json.dumps(trajectory.to_dict())))
    for field in ("t", "states", "inputs"):
        np.testing.assert_array_equal(getattr(copy, field), getattr(trajectory, field))


@given(trajectories(), grids())
def test_resampling_keeps_the_duration_the_ends_and_the_integral_of_the_inputs(trajectory, grid):
    result = resample(trajectory, grid)
    scale = 1 + np.abs(trajectory.states).max() + np.abs(trajectory.inputs).max() * trajectory.duration
    assert result.steps == grid.steps
    assert result.duration == pytest.approx(trajectory.duration, rel=1e-12)
    np.testing.assert_allclose(result.states[[0, -1]], trajectory.states[[0, -1]], atol=1e-9 * scale)
    integral = np.diff(trajectory.t) @ trajectory.inputs
    np.testing.assert_allclose(np.diff(result.t) @ result.inputs, integral, atol=1e-9 * scale)
    slack = 1e-9 * scale
    assert (result.states >= trajectory.states.min(axis=0) - slack).all()
    assert (result.states <= trajectory.states.max(axis=0) + slack).all()
    assert (result.inputs >= trajectory.inputs.min(axis=0) - 1e4 * slack).all()
    assert (result.inputs <= trajectory.inputs.max(axis=0) + 1e4 * slack).all()


@given(grids(), st.lists(st.integers(0, 14), max_size=6), st.integers(1, 4))
def test_splitting_keeps_the_knots_there_are(grid, intervals, parts):
    chosen = [k for k in intervals if k < grid.steps]
    finer = grid.split(chosen, parts)
    assert finer.steps == grid.steps + len(set(chosen)) * (parts - 1)
    assert np.isin(grid.fractions, finer.fractions).all()
    assert finer.widths.sum() == pytest.approx(1.0)
    assert finer.widths.min() >= grid.widths.min() / parts * (1 - 1e-9)


leaves = st.one_of(st.none(), st.booleans(), st.floats(), st.integers(), st.text(max_size=3), st.just(10**400))
columns = st.dictionaries(
    st.sampled_from(["x", "y", "theta", "v", "delta", "a", "omega"]), st.lists(leaves, max_size=3)
)
values = st.one_of(leaves, st.lists(leaves, max_size=4), columns, st.lists(st.lists(leaves, max_size=2), max_size=2))


@given(st.dictionaries(st.sampled_from(["t", "states", "inputs", "more"]), values), st.booleans())
def test_arbitrary_objects_are_a_trajectory_or_an_input_error(data, named):
    names = (("x", "y"), ("a",)) if named else (None, None)
    try:
        result = Trajectory.from_dict(data, *names)
    except InputError as error:
        result, problems = None, error.problems
    if result is None:
        assert all(problem.message for problem in problems)
    else:
        assert result.states.shape == (result.t.size, len(result.state_names))
        assert np.isfinite(result.states).all()
