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
from tightspot.verification.certificate import metres
from tightspot.verification.replay import Replay
from tightspot.verification.sampled import Nearness, nearness, nearness_along

Array = NDArray[np.float64]

GUESS_SAMPLES = 4
SURE = 1e-5
"""More than rounding and the integration's error make of a distance, m."""


@dataclass(frozen=True, eq=False)
class Room:
    """How near a motion comes to everything, by interval.

    Attributes:
        near: Which obstacle parts the motion may come near to, (n,).
        clearances: Smallest sampled clearance of those, (N, parts, n), m.
        far: A lower bound of the clearance of all others, infinite of those, (parts, obstacle parts), m.
        walls: Smallest sampled distance inside W's edges, (N, parts, edges), m.
    """

    near: NDArray[np.intp]
    clearances: Array
    far: Array
    walls: Array

    @property
    def obstacles(self) -> Array:
        """Smallest sampled clearance of all obstacle parts, (N, parts, obstacle parts), m; a lower bound of the far."""
        dense = np.repeat(self.far[None], len(self.clearances), axis=0)
        dense[:, :, self.near] = self.clearances
        return dense

    def within(self, reach: float) -> NDArray[np.bool_]:
        """Where obstacle parts are nearer than ``reach`` (m), (N, parts, obstacle parts)."""
        dense = np.repeat((self.far < reach)[None], len(self.clearances), axis=0)
        dense[:, :, self.near] = self.clearances < reach
        return dense

    @property
    def by_obstacles(self) -> Array:
        """Smallest clearance of any obstacle on each interval, m, (N,)."""
        nearest = self.clearances.min(axis=(1, 2), initial=np.inf)
        return np.asarray(np.minimum(nearest, self.far.min(initial=np.inf)))

    @property
    def deepest(self) -> float:
        """Smallest clearance of obstacles and distance inside W, m."""
        return float(min(self.by_obstacles.min(), self.walls.min(initial=np.inf)))

    def spare(self, margin: float) -> Array:
        """How much nearer the motion might come on each interval, m, (N,); negative where it is too near.

        To obstacles the ``margin`` is demanded, to W's boundary nothing.
        """
        return np.asarray(np.minimum(self.by_obstacles - margin, self.walls.min(axis=(1, 2), initial=np.inf)))

    def objection(self, t: Array, margin: float, scenario: Scenario, vehicle: VehicleModel) -> str:
        """What is nearer than it may be at some sample, with the interval between the knots ``t``; empty if nothing is.

        What the judge proves of all times it has to prove of these, too.
        """
        nearest, inside = self.clearances.min(initial=np.inf), self.walls.min(initial=np.inf)
        if nearest < margin - SURE:
            k, part, n = np.unravel_index(self.clearances.argmin(), self.clearances.shape)
            what = f"is only {metres(nearest)} m from" if nearest >= 0 else f"overlaps by {metres(-nearest)} m"
            there = f"{what} {scenario.part_names[self.near[n]]}"
        elif inside < -SURE:
            k, part, _ = np.unravel_index(self.walls.argmin(), self.walls.shape)
            there = f"leaves the workspace by {metres(-inside)} m"
        else:
            return ""
        return f"{vehicle.parts[part].name} {there} between t = {t[k]:.3f} s and {t[k + 1]:.3f} s"

    @classmethod
    def of_guess(cls, guess: Trajectory, grid: TimeGrid, scenario: Scenario, vehicle: VehicleModel) -> Room:
        """Of the interpolated guess on the grid's intervals."""
        states = states_at(guess, guess.t[0] + guess.duration * _subdivided(grid.fractions, GUESS_SAMPLES))
        return cls._of(nearness(states, GUESS_SAMPLES, scenario, vehicle))

    @classmethod
    def of_replay(cls, replay: Replay, scenario: Scenario) -> Room:
        """Of the replayed motion on its own intervals."""
        return cls._of(nearness_along(replay, scenario))

    @classmethod
    def _of(cls, found: Nearness) -> Room:
        far = found.apart.copy()
        far[:, found.near] = np.inf
        return cls(found.near, found.clearances, far, found.depths)


def _subdivided(knots: Array, parts: int) -> Array:
    """Each interval between the knots cut into ``parts`` equal pieces."""
    weights = np.arange(parts) / parts
    inner = knots[:-1, None] + (knots[1:] - knots[:-1])[:, None] * weights
    return np.concatenate([inner.ravel(), knots[-1:]])
