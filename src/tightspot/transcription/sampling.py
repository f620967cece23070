"""Trajectories resampled onto another grid, for starting points and warm re-solves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tightspot.solvers.stage_core import compiled
from tightspot.trajectory import Trajectory
from tightspot.transcription.grid import TimeGrid

Array = NDArray[np.float64]


def states_at(guess: Trajectory, t: Array) -> Array:
    """States at times t by linear interpolation between the guess's knots, (len(t), n_x), as of :func:`numpy.interp`.

    Raises:
        BuildError: The compiled core is missing.
    """
    found: Array = compiled().states_at(guess.t, guess.states, t)
    return found


def inputs_on(guess: Trajectory, t: Array) -> Array:
    """Mean inputs on the intervals between the times t, (len(t) - 1, n_u).

    Raises:
        BuildError: The compiled core is missing.
    """
    found: Array = compiled().inputs_on(guess.t, guess.inputs, t)
    return found


def times_on(guess: Trajectory, grid: TimeGrid) -> Array:
    """The grid's knots over the guess's horizon, s, (N + 1,)."""
    t: Array = guess.t[0] + guess.duration * grid.fractions
    t[-1] = guess.t[-1]
    return t


def resample(guess: Trajectory, grid: TimeGrid) -> Trajectory:
    """The guess on the grid: interpolated states, mean inputs, the same duration."""
    t = times_on(guess, grid)
    names = guess.state_names, guess.input_names
    return Trajectory.of_sound(t - t[0], states_at(guess, t), inputs_on(guess, t), *names)
