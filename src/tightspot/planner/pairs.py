"""Which pairs enter the problem: those that the motion comes near to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tightspot.geometry.separation import clearance
from tightspot.geometry.transforms import transform
from tightspot.scenarios.scenario import Scenario
from tightspot.trajectory import Trajectory
from tightspot.transcription import TimeGrid
from tightspot.transcription.sampling import states_at
from tightspot.vehicles.base import VehicleModel
from tightspot.verification.replay import Replay

Array = NDArray[np.float64]

SAMPLES = 4


def sampled_clearance(states: Array, scenario: Scenario, vehicle: VehicleModel) -> Array:
    """Signed distance of every pair at the states (M, n_x), shape (M, parts, obstacle parts)."""
    frames = vehicle.frames(list(states.T), np)
    obstacles = [polygon.vertices for _, polygon in scenario.obstacle_parts]
    result = np.empty((len(states), len(vehicle.parts), len(obstacles)))
    for i, part in enumerate(vehicle.parts):
        body = transform(part.polygon.vertices, np.column_stack(frames[part.frame]))
        for j, vertices in enumerate(obstacles):
            result[:, i, j] = clearance(body, vertices)
    return result


def interval_clearance(states: Array, per_interval: int, scenario: Scenario, vehicle: VehicleModel) -> Array:
    """Smallest sampled clearance on each interval, (N, parts, obstacle parts), both ends included.

    Args:
        states: ``N * per_interval + 1`` states in time order.
        per_interval: Samples an interval.
        scenario: Obstacles.
        vehicle: Body.
    """
    samples = sampled_clearance(states, scenario, vehicle)
    intervals = (len(states) - 1) // per_interval
    inner = samples[:-1].reshape(intervals, per_interval, *samples.shape[1:]).min(axis=1)
    return np.asarray(np.minimum(inner, samples[per_interval::per_interval]))


def near_guess(
    guess: Trajectory, grid: TimeGrid, scenario: Scenario, vehicle: VehicleModel, reach: float
) -> NDArray[np.bool_]:
    """Pairs that the interpolated guess brings within ``reach`` m, (N, parts, obstacle parts)."""
    states = states_at(guess, guess.duration * _subdivided(grid.fractions, SAMPLES))
    return np.asarray(interval_clearance(states, SAMPLES, scenario, vehicle) < reach)


def replay_clearance(replay: Replay, scenario: Scenario, vehicle: VehicleModel, per_interval: int) -> Array:
    """Smallest clearance of the replayed motion on each interval, (N, parts, obstacle parts)."""
    times = _subdivided(replay.trajectory.t, per_interval)
    return interval_clearance(replay.at(times), per_interval, scenario, vehicle)


def replay_outside(replay: Replay, scenario: Scenario, vehicle: VehicleModel, per_interval: int) -> NDArray[np.bool_]:
    """Intervals on which the replayed body leaves W, (N,)."""
    states = replay.at(_subdivided(replay.trajectory.t, per_interval))
    frames = vehicle.frames(list(states.T), np)
    outside = np.zeros(len(states), bool)
    for part in vehicle.parts:
        body = transform(part.polygon.vertices, np.column_stack(frames[part.frame]))
        outside |= (body @ scenario.workspace.A.T > scenario.workspace.b).any(axis=(1, 2))
    inner = outside[:-1].reshape(-1, per_interval).any(axis=1)
    return np.asarray(inner | outside[per_interval::per_interval])


def _subdivided(knots: Array, parts: int) -> Array:
    """Each interval between the knots cut into ``parts`` equal pieces."""
    weights = np.arange(parts) / parts
    inner = knots[:-1, None] + np.diff(knots)[:, None] * weights
    return np.concatenate([inner.ravel(), knots[-1:]])
