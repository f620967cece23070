"""From a path of arcs to a timed trajectory that steers while it drives, as a good motion does."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tightspot.search import Path
from tightspot.search.rolling import rolled
from tightspot.trajectory import Trajectory
from tightspot.vehicles.single_track import SingleTrack

Array = NDArray[np.float64]

HALF_WINDOW = 0.075
"""Steering is averaged over this much of the path to either side, in wheelbases. Measured: see docs/search.md."""


def lift_rolling(path: Path, start: Array, goal_steering: float, vehicle: SingleTrack) -> Trajectory:
    """Drive a path from rest to rest between gear changes, turning the wheels on the way.

    The curvature of a path of arcs jumps, the steering angle cannot. Here it is the mean of ``arctan(kappa L)`` over a
    short stretch of the path around each pose (from the start's angle and to the goal's at the ends), and the car is
    slow where it changes: speed is a trapezoid over each stretch of one gear, and no more than the steering's rate
    allows. The work is done in the core (``cpp/include/tightspot/rolling.hpp``).

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

    Raises:
        BuildError: The compiled core is missing.
    """
    limits = vehicle.limits
    t, states, inputs = rolled(
        path,
        float(start[4]),
        float(goal_steering),
        wheelbase=vehicle.wheelbase,
        steering=limits.steering,
        steering_rate=limits.steering_rate,
        forwards=limits.speed[1],
        backwards=-limits.speed[0],
        slowest=limits.acceleration[0],
        fastest=limits.acceleration[1],
        half_window=HALF_WINDOW * vehicle.wheelbase,
    )
    return Trajectory.of_sound(t, states, inputs, vehicle.state_names, vehicle.input_names)
