"""Trajectories resampled onto another grid, for starting points and warm re-solves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tightspot.trajectory import Trajectory
from tightspot.transcription.grid import TimeGrid

Array = NDArray[np.float64]


def states_at(guess: Trajectory, t: Array) -> Array:
    """States at times t by linear interpolation between the guess's knots, (len(t), n_x)."""
    return _interpolated(t, guess.t, guess.states)


def inputs_on(guess: Trajectory, t: Array) -> Array:
    """Mean inputs on the intervals between the times t, (len(t) - 1, n_u)."""
    integral = np.zeros((guess.t.size, guess.inputs.shape[1]))
    (guess.inputs * (guess.t[1:] - guess.t[:-1])[:, None]).cumsum(axis=0, out=integral[1:])
    at_t = _interpolated(t, guess.t, integral)
    return np.asarray((at_t[1:] - at_t[:-1]) / (t[1:] - t[:-1])[:, None])


def _interpolated(t: Array, knots: Array, values: Array) -> Array:
    """Each column of the values at the knots (K, n), linearly interpolated at times t, (len(t), n)."""
    if t.size == knots.size and (t == knots).all():
        return values.copy()
    found = np.empty((len(t), values.shape[1]))
    for i, column in enumerate(values.T):
        found[:, i] = np.interp(t, knots, column)
    return found


def times_on(guess: Trajectory, grid: TimeGrid) -> Array:
    """The grid's knots over the guess's horizon, s, (N + 1,)."""
    t: Array = guess.t[0] + guess.duration * grid.fractions
    t[-1] = guess.t[-1]
    return t


def resample(guess: Trajectory, grid: TimeGrid) -> Trajectory:
    """The guess on the grid: interpolated states, mean inputs, the same duration."""
    t = times_on(guess, grid)
    return Trajectory(t - t[0], states_at(guess, t), inputs_on(guess, t), guess.state_names, guess.input_names)
