"""Which pairs enter the problem: those that the motion comes near to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tightspot.scenarios.scenario import Scenario
from tightspot.trajectory import Trajectory
from tightspot.transcription import TimeGrid
from tightspot.transcription.sampling import states_at
from tightspot.vehicles.base import VehicleModel
from tightspot.verification.replay import Replay
from tightspot.verification.sampled import near_clearance, sampled_room

Array = NDArray[np.float64]

GUESS_SAMPLES = 4
REPLAY_SAMPLES = 12


def by_interval(samples: Array, per_interval: int) -> Array:
    """Smallest value on each interval, both ends included, of ``N * per_interval + 1`` samples: (N, ...)."""
    intervals = (len(samples) - 1) // per_interval
    inner = samples[:-1].reshape(intervals, per_interval, *samples.shape[1:]).min(axis=1)
    return np.asarray(np.minimum(inner, samples[per_interval::per_interval]))


@dataclass(frozen=True, eq=False)
class Room:
    """How near a motion comes to everything, by interval.

    Attributes:
        obstacles: Smallest sampled clearance, (N, parts, obstacle parts), m; a lower bound of what is far.
        walls: Smallest sampled distance inside W's edges, (N, parts, edges), m.
    """

    obstacles: Array
    walls: Array

    @property
    def deepest(self) -> float:
        """Smallest clearance of obstacles and distance inside W, m."""
        return float(min(self.obstacles.min(initial=np.inf), self.walls.min(initial=np.inf)))

    def spare(self, margin: float) -> Array:
        """How much nearer the motion might come on each interval, m, (N,); negative where it is too near.

        To obstacles the ``margin`` is demanded, to W's boundary nothing.
        """
        obstacles = self.obstacles.min(axis=(1, 2), initial=np.inf)
        return np.asarray(np.minimum(obstacles - margin, self.walls.min(axis=(1, 2), initial=np.inf)))

    @classmethod
    def of_guess(cls, guess: Trajectory, grid: TimeGrid, scenario: Scenario, vehicle: VehicleModel) -> Room:
        """Of the interpolated guess on the grid's intervals."""
        states = states_at(guess, guess.t[0] + guess.duration * _subdivided(grid.fractions, GUESS_SAMPLES))
        return cls._of(states, GUESS_SAMPLES, scenario, vehicle)

    @classmethod
    def of_replay(cls, replay: Replay, scenario: Scenario, vehicle: VehicleModel) -> Room:
        """Of the replayed motion on its own intervals."""
        times = _subdivided(replay.trajectory.t, REPLAY_SAMPLES)
        return cls._of(replay.at(times), REPLAY_SAMPLES, scenario, vehicle)

    @classmethod
    def _of(cls, states: Array, per_interval: int, scenario: Scenario, vehicle: VehicleModel) -> Room:
        near, apart, found = near_clearance(states, scenario, vehicle)
        obstacles = np.empty(((len(states) - 1) // per_interval, *apart.shape))
        obstacles[:] = apart
        obstacles[:, :, near] = by_interval(found, per_interval)
        return cls(obstacles, by_interval(sampled_room(states, scenario, vehicle), per_interval))


def _subdivided(knots: Array, parts: int) -> Array:
    """Each interval between the knots cut into ``parts`` equal pieces."""
    weights = np.arange(parts) / parts
    inner = knots[:-1, None] + np.diff(knots)[:, None] * weights
    return np.concatenate([inner.ravel(), knots[-1:]])
