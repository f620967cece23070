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
    return _means(t, _interpolated(t, guess.t, _integral(guess)))


def _integral(guess: Trajectory) -> Array:
    """Of the inputs from the first knot to each, (K, n_u)."""
    integral = np.zeros((guess.t.size, guess.inputs.shape[1]))
    (guess.inputs * (guess.t[1:] - guess.t[:-1])[:, None]).cumsum(axis=0, out=integral[1:])
    return integral


def _means(t: Array, integral: Array) -> Array:
    """Between the times t, of what has this integral there."""
    return np.asarray((integral[1:] - integral[:-1]) / (t[1:] - t[:-1])[:, None])


def _interpolated(t: Array, knots: Array, values: Array) -> Array:
    """Each column of the values at the knots (K, n), linearly interpolated at times t, (len(t), n).

    As by :func:`numpy.interp`, of all columns at once.
    """
    if t.size == knots.size and (t == knots).all():
        return values.copy()
    slopes = (values[1:] - values[:-1]) / (knots[1:] - knots[:-1])[:, None]
    below = np.minimum(np.maximum(knots.searchsorted(t, side="right") - 1, 0), knots.size - 2)
    found: Array = slopes[below] * (t - knots[below])[:, None] + values[below]
    found[t <= knots[0]], found[t >= knots[-1]] = values[0], values[-1]
    return found


def times_on(guess: Trajectory, grid: TimeGrid) -> Array:
    """The grid's knots over the guess's horizon, s, (N + 1,)."""
    t: Array = guess.t[0] + guess.duration * grid.fractions
    t[-1] = guess.t[-1]
    return t


def resample(guess: Trajectory, grid: TimeGrid) -> Trajectory:
    """The guess on the grid: interpolated states, mean inputs, the same duration."""
    t, n_x = times_on(guess, grid), guess.states.shape[1]
    both = _interpolated(t, guess.t, np.concatenate([guess.states, _integral(guess)], axis=1))
    names = guess.state_names, guess.input_names
    return Trajectory.of_sound(t - t[0], both[:, :n_x].copy(), _means(t, both[:, n_x:]), *names)
