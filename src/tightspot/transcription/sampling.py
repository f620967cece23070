"""Trajectories resampled onto another grid, for starting points and warm re-solves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tightspot.trajectory import Trajectory
from tightspot.transcription.grid import TimeGrid

Array = NDArray[np.float64]


def states_at(guess: Trajectory, t: Array) -> Array:
    """States at times t by linear interpolation between the guess's knots, (len(t), n_x)."""
    return np.column_stack([np.interp(t, guess.t, column) for column in guess.states.T])


def inputs_on(guess: Trajectory, t: Array) -> Array:
    """Mean inputs on the intervals between the times t, (len(t) - 1, n_u)."""
    widths = np.diff(guess.t)[:, None]
    integral = np.vstack([np.zeros(guess.inputs.shape[1]), np.cumsum(guess.inputs * widths, axis=0)])
    at_t = np.column_stack([np.interp(t, guess.t, column) for column in integral.T])
    return np.asarray(np.diff(at_t, axis=0) / np.diff(t)[:, None])


def resample(guess: Trajectory, grid: TimeGrid) -> Trajectory:
    """The guess on the grid: interpolated states, mean inputs, the same duration."""
    t = guess.t[0] + guess.duration * grid.fractions
    t[-1] = guess.t[-1]
    return Trajectory(t - t[0], states_at(guess, t), inputs_on(guess, t), guess.state_names, guess.input_names)
