"""A motion as the pictures need it: closely sampled, its legs between gear changes, samples at a spacing."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tightspot.trajectory import Trajectory
from tightspot.vehicles import VehicleModel
from tightspot.verification import replay

Array = NDArray[np.float64]

_SHORTEST_LEG = 0.005
"""A change of direction for less than this, m, is a solver's rounding at rest and no gear change."""


class Leg(NamedTuple):
    """A stretch driven in one gear.

    Attributes:
        gear: +1 forward, -1 reverse.
        first: Index of the sample at which it begins.
        last: Index of the sample at which it ends; the next leg begins there.
    """

    gear: int
    first: int
    last: int


def sampling_step(trajectory: Trajectory) -> float:
    """Time between samples that no picture resolves: 20 ms, more for motions over 30 s."""
    return max(0.02, trajectory.duration / 1500)


def dense_motion(vehicle: VehicleModel, trajectory: Trajectory) -> Trajectory:
    """What the vehicle does under the trajectory's inputs, sampled closely, every knot among the samples.

    Args:
        vehicle: Its dynamics are integrated by :func:`tightspot.verification.replay`.
        trajectory: Its first state and its inputs are used.
    """
    motion = replay(vehicle, trajectory)
    t = motion.dense(sampling_step(trajectory))
    inputs = trajectory.inputs[motion.interval((t[:-1] + t[1:]) / 2)]
    return Trajectory(t, motion.at(t), inputs, trajectory.state_names, trajectory.input_names)


def travelled(states: ArrayLike) -> Array:
    """Length driven until each sample, m: the running sum of distances between positions, shape (M,)."""
    steps = np.diff(np.asarray(states, dtype=float)[:, :2], axis=0)
    return np.concatenate([[0.0], np.cumsum(np.hypot(*steps.T))])


def drive_legs(trajectory: Trajectory) -> list[Leg]:
    """The legs of a densely sampled trajectory, in order, from its first to its last sample.

    The gear of an interval is the sign of the speed at its middle. Standing still belongs to the leg before,
    and a leg shorter than 5 mm to its neighbour. A motion that never moves is one forward leg.
    """
    v = trajectory.column("v")
    length = np.diff(travelled(trajectory.poses))
    gears = np.sign(v[:-1] + v[1:]).astype(int)
    runs: list[list[int]] = []  # gear, first, last
    driven: list[float] = []
    for k, gear in enumerate(gears):
        if gear and (not runs or runs[-1][0] != gear):
            runs.append([int(gear), k, k + 1])
            driven.append(0.0)
        if runs:
            runs[-1][2] = k + 1
            driven[-1] += length[k]
    legs: list[Leg] = []
    for (gear, first, last), distance in zip(runs, driven, strict=True):
        if legs and (distance < _SHORTEST_LEG or legs[-1].gear == gear):
            legs[-1] = legs[-1]._replace(last=last)
        elif distance >= _SHORTEST_LEG:
            legs.append(Leg(gear, first, last))
    if not legs:
        return [Leg(1, 0, len(v) - 1)]
    return [legs[0]._replace(first=0), *legs[1:]]


def spaced(states: ArrayLike, spacing: float) -> list[int]:
    """Indices of samples about ``spacing`` m apart, evenly spread, with the first and the last.

    Turning counts too, at one metre a radian, so that a vehicle turning on the spot is seen to turn.
    """
    states = np.asarray(states, dtype=float)
    moved = travelled(states) + np.concatenate([[0.0], np.cumsum(np.abs(np.diff(states[:, 2])))])
    count = max(1, round(moved[-1] / spacing))
    return sorted(
        {int(i) for i in np.searchsorted(moved, np.linspace(0, moved[-1], count + 1) - 1e-9)} | {0, len(states) - 1}
    )
