"""How finely the horizon is divided, from the guess."""

from __future__ import annotations

import math

import numpy as np

from tightspot.formulations import Formulation
from tightspot.trajectory import Trajectory
from tightspot.vehicles.base import VehicleModel

METRES_PER_STEP = 0.5
STEPS_PER_GEAR = 4
FEWEST, MOST = 30, 70
COVER = 0.01


def path_length(trajectory: Trajectory) -> float:
    """Length of the reference point's path, m, from the chords between the knots."""
    return float(np.hypot(*np.diff(trajectory.poses[:, :2], axis=0).T).sum())


def gear_changes(trajectory: Trajectory, threshold: float = 1e-3) -> int:
    """How often the sign of v changes, not counting standstill below ``threshold`` m/s."""
    v = trajectory.column("v")
    signs = np.sign(v[np.abs(v) > threshold])
    return int(np.count_nonzero(np.diff(signs)))


def steps_for(guess: Trajectory) -> int:
    """Number of intervals: some for every metre and for every gear, within bounds."""
    wanted = path_length(guess) / METRES_PER_STEP + STEPS_PER_GEAR * gear_changes(guess)
    return int(np.clip(math.ceil(wanted), FEWEST, MOST))


def poses_for(formulation: Formulation, guess: Trajectory, vehicle: VehicleModel, steps: int) -> int:
    """Sub-intervals of an interval, so that the motion between two poses needs a cover of about ``COVER`` m.

    The optimised trajectory's speed is not known yet; it is taken as the guess's path at half the speed limit.
    """
    if formulation.holds == "knots":
        return 1
    low, high = vehicle.state_bounds
    speed = min(high[3], -low[3]) / 2
    interval = max(path_length(guess) / speed, 1.0) / steps
    lower, upper = vehicle.input_bounds
    control = np.minimum(-lower, upper)
    state = np.zeros(vehicle.n_states)
    state[3] = speed
    part = max(vehicle.parts, key=lambda part: part.polygon.radius)
    bound = vehicle.acceleration_bound(part.frame, part.polygon.radius, list(state), list(control), 0.0, np)
    return int(np.clip(math.ceil(interval / math.sqrt(8 * COVER / bound)), 2, 6))
