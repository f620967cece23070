"""From a path of arcs to a timed trajectory that steers while it drives, as a good motion does."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tightspot.search import Path
from tightspot.trajectory import Trajectory
from tightspot.vehicles.single_track import SingleTrack

Array = NDArray[np.float64]

HALF_WINDOW = 0.075
"""Steering is averaged over this much of the path to either side, in wheelbases. Measured: see docs/search.md."""
_CRAWL = 1e-3
_SHORTEST = 1e-9


def lift_rolling(path: Path, start: Array, goal_steering: float, vehicle: SingleTrack) -> Trajectory:
    """Drive a path from rest to rest between gear changes, turning the wheels on the way.

    The curvature of a path of arcs jumps, the steering angle cannot. Here it is the mean of ``arctan(kappa L)`` over a
    short stretch of the path around each pose (from the start's angle and to the goal's at the ends), and the car is
    slow where it changes: speed is a trapezoid over each stretch of one gear, and no more than the steering's rate
    allows.

    The poses at the knots lie on the path, and limits are kept. But where the steering changes it is not the path's,
    so the inputs do not reproduce the poses exactly: a guess, from which the optimiser gets to better optima in fewer
    iterations than from :func:`tightspot.guesses.lift_arcs`, which is exact and stands still while it steers.

    Args:
        path: From the search; of some length.
        start: Full start state (x, y, theta, v, delta); a steering angle of NaN is taken from the first arc. Its speed
            is left out: the optimiser restores it.
        goal_steering: Steering angle at the end, rad; NaN: as it comes.
        vehicle: Wheelbase and limits.

    Returns:
        Knots at the path's poses.
    """
    steps = path.poses[1:] - path.poses[:-1]
    ways = np.hypot(steps[:, 0], steps[:, 1]) / np.sinc(steps[:, 2] / (2 * np.pi))
    moves = ways > _SHORTEST
    poses = path.poses[np.concatenate(([True], moves))]
    gears, wanted = path.gear[1:][moves].astype(float), np.arctan(path.curvature[1:][moves] * vehicle.wheelbase)
    s = np.concatenate(([0.0], ways[moves].cumsum()))
    first = wanted[0] if np.isnan(start[4]) else float(start[4])
    last = goal_steering if np.isfinite(goal_steering) else wanted[-1]
    delta = _averaged(s, wanted, first, last, min(HALF_WINDOW * vehicle.wheelbase, s[-1] / 2))
    delta = np.minimum(np.maximum(delta, -vehicle.limits.steering), vehicle.limits.steering)
    durations, v = _timed(s, gears, np.abs(delta[1:] - delta[:-1]), vehicle)
    states = np.concatenate([poses, v[:, None], delta[:, None]], axis=1)
    inputs = (states[1:, 3:] - states[:-1, 3:]) / durations[:, None]
    low, high = vehicle.input_bounds
    t = np.concatenate(([0.0], durations.cumsum()))
    inputs = np.minimum(np.maximum(inputs, low), high)
    return Trajectory.of_sound(t, states, inputs, vehicle.state_names, vehicle.input_names)


def _averaged(s: Array, wanted: Array, first: float, last: float, half: float) -> Array:
    """The mean of the piecewise constant ``wanted`` (N,) over ``s`` +- ``half``, led to ``first`` and ``last``."""
    edges = np.concatenate(([-half], s, [s[-1] + half]))
    values = np.concatenate(([first], wanted, [last]))
    integral = np.concatenate(([0.0], (values * (edges[1:] - edges[:-1])).cumsum()))
    mean = (np.interp(s + half, edges, integral) - np.interp(s - half, edges, integral)) / (2 * half)
    from_first = np.maximum(1 - s / half, 0.0)
    from_last = np.maximum(1 - (s[-1] - s) / half, 0.0)
    return np.asarray(mean + (first - mean[0]) * from_first + (last - mean[-1]) * from_last)


def _timed(s: Array, gears: Array, swings: Array, vehicle: SingleTrack) -> tuple[Array, Array]:
    """Durations of the intervals (N,), in which the wheels swing by so many rad, and signed speeds at the knots."""
    limits = vehicle.limits
    rate = min(limits.acceleration[1], -limits.acceleration[0])
    changes = (gears[1:] != gears[:-1]).nonzero()[0] + 1
    stops = np.concatenate(([0], changes, [s.size - 1]))
    room = np.abs(s[:, None] - s[stops]).min(axis=1)
    top = np.where(gears > 0, limits.speed[1], -limits.speed[0])
    ramp = np.sqrt(2 * rate * room)
    ways = s[1:] - s[:-1]
    mean = np.minimum(top, (ramp[1:] + ramp[:-1]) / 2)
    mean = np.minimum(mean, limits.steering_rate * ways / np.maximum(swings, 1e-12))
    mean = np.maximum(mean, _CRAWL * top)
    durations = np.maximum(ways / mean, swings / limits.steering_rate)
    v = np.zeros(s.size)
    v[1:-1] = gears[1:] * np.minimum(mean[1:], mean[:-1])
    v[stops] = 0.0
    return durations, v
