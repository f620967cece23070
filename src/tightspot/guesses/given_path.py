"""A path drawn by the user, timed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem
from tightspot.geometry.transforms import nearest_angle
from tightspot.guesses.base import Guess, GuessResult, as_single_track, known
from tightspot.scenarios.scenario import Scenario
from tightspot.trajectory import Trajectory
from tightspot.vehicles.base import VehicleModel
from tightspot.vehicles.single_track import SingleTrack

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class GivenPath(Guess):
    """Poses given by the user, driven in their order; gear and steering follow from them.

    Between two poses the vehicle goes forward if the second lies ahead of the first, otherwise in reverse. Speed
    is a trapezoid over each stretch of one gear, from rest to rest; the steering angle is that of the path's
    curvature, within its limit, at a rate within its limit. The poses need not be drivable: it is a guess.

    Attributes:
        poses: (M, 3) x m, y m, theta rad, from start to goal in the scene file's coordinates; two or more.
    """

    name: ClassVar[str] = "path"
    collision_free: ClassVar[bool] = False
    poses: Sequence[Sequence[float]] | Array

    def __post_init__(self) -> None:
        try:
            poses = np.array(self.poses, dtype=float)
        except (TypeError, ValueError):
            raise InputError(Problem("guess.poses", "must be a list of [x, y, theta]")) from None
        if poses.ndim != 2 or poses.shape[1] != 3 or len(poses) < 2 or not np.isfinite(poses).all():
            raise InputError(Problem("guess.poses", "must be two or more finite [x, y, theta] in m, m, rad"))
        poses[:, 2] = np.unwrap(poses[:, 2])
        poses.setflags(write=False)
        object.__setattr__(self, "poses", poses)

    def make(self, scenario: Scenario, vehicle: VehicleModel, *, margin: float) -> GuessResult:
        car = as_single_track(vehicle, self.name)
        poses = np.array(self.poses) - np.r_[scenario.offset, 0.0]
        start, goal = known(scenario.start), known(scenario.goal)
        poses[:, 2] += nearest_angle(poses[0, 2], start[2]) - poses[0, 2]
        goal[2] = nearest_angle(goal[2], poses[-1, 2])
        poses = np.vstack([start[:3], poses, goal[:3]])
        trajectory = time_path(_distinct(poses), car, start, goal)
        return GuessResult(trajectory, f"The given path of {len(self.poses)} poses.")


def _distinct(poses: Array, tolerance: float = 1e-6) -> Array:
    """The poses without those that stay where the one before is; the first and the last are kept."""
    keep = np.r_[True, np.hypot(*np.diff(poses[:, :2], axis=0).T) > tolerance]
    if not keep[-1]:
        keep[np.flatnonzero(keep[1:])[-1:] + 1] = False
        keep[-1] = True
    return poses[keep]


def time_path(poses: Array, car: SingleTrack, start: Array, goal: Array) -> Trajectory:
    """Trapezoidal speed over each stretch of one gear; steering from the path's curvature."""
    steps = np.diff(poses, axis=0)
    chords = np.hypot(steps[:, 0], steps[:, 1])
    ahead = steps[:, 0] * np.cos(poses[:-1, 2]) + steps[:, 1] * np.sin(poses[:-1, 2])
    gears = np.where(ahead >= 0, 1.0, -1.0)
    curvature = np.divide(gears * steps[:, 2], chords, out=np.zeros_like(chords), where=chords > 1e-9)
    limit = car.limits.steering
    steering = np.clip(np.arctan(curvature * car.wheelbase), -limit, limit)
    durations, speeds = _speeds(chords, gears, car)
    delta = np.r_[start[4], (steering[1:] + steering[:-1]) / 2, goal[4]]
    durations = np.maximum(durations, np.abs(np.diff(delta)) / car.limits.steering_rate)
    t = np.r_[0.0, np.cumsum(durations)]
    states = np.column_stack([poses, speeds, delta])
    inputs = np.column_stack([np.diff(speeds), np.diff(delta)]) / durations[:, None]
    low, high = car.input_bounds
    return Trajectory(t, states, np.clip(inputs, low, high), car.state_names, car.input_names)


def _speeds(chords: Array, gears: Array, car: SingleTrack) -> tuple[Array, Array]:
    """Durations of the steps and signed speeds at the poses: rest at both ends and at every gear change."""
    low, high = car.limits.speed
    rate = min(car.limits.acceleration[1], -car.limits.acceleration[0])
    cuts = np.flatnonzero(np.diff(gears)) + 1
    speeds = np.zeros(len(chords) + 1)
    for first, last in zip(np.r_[0, cuts], np.r_[cuts, len(chords)], strict=True):
        s = np.r_[0.0, np.cumsum(chords[first:last])]
        top = high if gears[first] > 0 else -low
        profile = np.minimum(top, np.sqrt(2 * rate * np.minimum(s, s[-1] - s)))
        speeds[first : last + 1] = gears[first] * profile
    mean = np.abs(speeds[1:] + speeds[:-1]) / 2
    crawl = np.sqrt(np.maximum(chords, 1e-6) * rate) / 2
    return np.maximum(chords, 1e-6) / np.maximum(mean, crawl), speeds
