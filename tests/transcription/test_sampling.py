"""Motions on other knots, against NumPy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tightspot.solvers.stage_core import compiled
from tightspot.trajectory import Trajectory
from tightspot.transcription import TimeGrid, resample
from tightspot.transcription.sampling import inputs_on, states_at

SEEDS = st.integers(0, 2**32 - 1)


def motion(rng, knots):
    t = np.concatenate([[0.0], rng.uniform(0.01, 1.0, knots - 1).cumsum()])
    return Trajectory(t, rng.normal(size=(knots, 5)), rng.normal(size=(knots - 1, 2)))


@given(SEEDS, st.integers(2, 12), st.integers(1, 30))
def test_states_are_those_that_numpy_interpolates(seed, knots, count):
    rng = np.random.default_rng(seed)
    guess = motion(rng, knots)
    times = np.concatenate([rng.uniform(-0.5, guess.t[-1] + 0.5, count), guess.t])
    wanted = np.column_stack([np.interp(times, guess.t, column) for column in guess.states.T])
    assert states_at(guess, times) == pytest.approx(wanted, abs=1e-12)
    assert (states_at(guess, guess.t) == guess.states).all()


@given(SEEDS, st.integers(2, 12), st.integers(1, 30))
def test_inputs_are_means_over_the_intervals(seed, knots, steps):
    rng = np.random.default_rng(seed)
    guess = motion(rng, knots)
    times = np.sort(rng.uniform(0, guess.t[-1], steps + 1))
    times += 1e-3 * np.arange(steps + 1)
    guess = Trajectory(np.append(guess.t, max(times[-1], guess.t[-1]) + 1), np.vstack([guess.states, guess.states[-1]]),
                       np.vstack([guess.inputs, [0.5, -0.5]]))  # fmt: skip
    cuts = np.unique(np.concatenate([times, guess.t[(guess.t > times[0]) & (guess.t < times[-1])]]))
    middles, widths = (cuts[1:] + cuts[:-1]) / 2, np.diff(cuts)
    shares = guess.inputs[np.searchsorted(guess.t, middles) - 1] * widths[:, None]
    owner = np.searchsorted(times, middles) - 1
    wanted = [shares[owner == k].sum(axis=0) / (times[k + 1] - times[k]) for k in range(steps)]
    assert inputs_on(guess, times) == pytest.approx(np.array(wanted), abs=1e-9)


def test_a_motion_on_its_own_knots_stays_what_it_is():
    guess = motion(np.random.default_rng(0), 9)
    again = resample(guess, TimeGrid(guess.t / guess.t[-1]))
    assert again.states == pytest.approx(guess.states, abs=1e-12)
    assert again.inputs == pytest.approx(guess.inputs, abs=1e-12)


def test_a_motion_needs_a_row_for_each_knot():
    core, states, inputs = compiled(), np.zeros((3, 5)), np.zeros((2, 2))
    for t in (np.zeros(0), np.zeros(1), np.arange(2.0), np.arange(4.0)):
        with pytest.raises(ValueError, match="knot"):
            core.states_at(t, states, np.arange(2.0))
        with pytest.raises(ValueError, match="knot"):
            core.inputs_on(t, inputs, np.arange(2.0))
    with pytest.raises(ValueError, match="times"):
        core.inputs_on(np.arange(3.0), inputs, np.zeros(0))
