"""How finely the horizon is divided, from the guess."""

from __future__ import annotations

import math
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from tightspot.formulations import Formulation
from tightspot.trajectory import Trajectory
from tightspot.vehicles.base import VehicleModel

Array = NDArray[np.float64]

METRES_PER_STEP = 0.5
STEPS_PER_GEAR = 4
FEWEST, MOST = 30, 70
COVER = 0.05
EASY = 0.1
MOST_POSES = 3
ROOMY, SLIGHT = 0.3, 0.015
STILL = 0.004


def path_length(trajectory: Trajectory) -> float:
    """Length of the reference point's path, m, from the chords between the knots."""
    x, y = trajectory.column("x"), trajectory.column("y")
    return float(np.hypot(x[1:] - x[:-1], y[1:] - y[:-1]).sum())


def gear_changes(trajectory: Trajectory, threshold: float = 1e-3) -> int:
    """How often the sign of v changes, not counting standstill below ``threshold`` m/s."""
    v = trajectory.column("v")
    signs = np.sign(v[np.abs(v) > threshold])
    return int(np.count_nonzero(signs[1:] != signs[:-1]))


def steps_for(guess: Trajectory) -> int:
    """Number of intervals: some for every metre and for every gear, within bounds."""
    wanted = path_length(guess) / METRES_PER_STEP + STEPS_PER_GEAR * gear_changes(guess)
    return min(max(math.ceil(wanted), FEWEST), MOST)


def poses_for(formulation: Formulation, guess: Trajectory, vehicle: VehicleModel, steps: int) -> int:
    """Sub-intervals of every interval of a uniform mesh, from a guess whose speed means nothing.

    The motion between two poses then needs a cover of about ``COVER`` if the guess's path is driven at half the speed
    limit with full use of the inputs and straight wheels.
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
    return int(np.clip(math.ceil(interval / math.sqrt(8 * COVER / bound)), 1, MOST_POSES))


def covers_of(motion: Trajectory, vehicle: VehicleModel) -> Array:
    """What the lemma adds to the margin on each interval without interior poses: ``P h^2 / 8``, m, (N,).

    With the states at the knots and the inputs of a motion that is about to be optimised further.
    """
    middle = (motion.states[:-1] + motion.states[1:]) / 2
    h = motion.t[1:] - motion.t[:-1]
    bounds = [
        np.broadcast_to(
            vehicle.acceleration_bound(
                part.frame, part.polygon.radius, list(middle.T), list(motion.inputs.T), h / 2, np
            ),
            h.shape,
        )
        for part in vehicle.parts
    ]
    return np.asarray(reduce(np.maximum, bounds) * h**2 / 8)


def travels_of(motion: Trajectory, vehicle: VehicleModel) -> Array:
    """How far no body point goes beyond on each interval, m, (N,): by the largest speeds there."""
    bounds = vehicle.motion_bounds(motion.states[:-1], motion.states[1:], motion.inputs)
    speeds = [bounds[part.frame].speed + part.polygon.radius * bounds[part.frame].yaw_rate for part in vehicle.parts]
    return np.asarray(reduce(np.maximum, speeds) * (motion.t[1:] - motion.t[:-1]))


def poses_on(formulation: Formulation, covers: Array, clearances: Array, travels: Array) -> tuple[int, ...]:
    """Sub-intervals of each interval, so that a cover of about ``COVER`` is left where it matters.

    There are none, but rows at the last knot only, where the motion hardly moves: if no point moves by more than
    ``STILL``, it comes nearer between two knots than at them by half of that, which is what planning demands beyond the
    margin. There are none, either, where more than ``ROOMY`` is left, if the motion need not give way by more than
    ``SLIGHT`` anywhere; one that has to change more would use what is not asked of it.

    Args:
        formulation: Members that hold at the knots have one.
        covers: Of each interval without interior poses, m, (N,).
        clearances: Room beyond the margin on each interval, m, (N,); with more than the cover and ``EASY`` no interior
            pose is needed.
        travels: How far body points go on each interval at most, m, (N,).
    """
    if formulation.holds == "knots":
        return (1,) * covers.size
    wanted = np.ceil(np.sqrt(covers / COVER))
    wanted[clearances > covers + EASY] = 1
    wanted = np.minimum(np.maximum(wanted, 1), MOST_POSES)
    far = ROOMY if clearances.min(initial=0.0) >= -SLIGHT else np.inf
    wanted[(clearances > far) | (travels < STILL)] = 0
    return tuple(wanted.astype(int).tolist())
