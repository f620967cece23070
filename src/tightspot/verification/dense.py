"""The second opinion: clearance at densely sampled times, by brute force. It proves nothing between its
samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tightspot.geometry import PolygonStack, transform
from tightspot.geometry import clearance as signed_distance
from tightspot.scenarios import Scenario
from tightspot.trajectory import Trajectory
from tightspot.vehicles import VehicleModel
from tightspot.verification.replay import replay

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ClearanceSeries:
    """Clearance over time.

    Attributes:
        t: s, shape (M,).
        clearance: Smallest signed distance of any body part to any obstacle part, m, shape (M,); infinite
            without obstacles.
        part: Name of the body part that comes nearest, at each time.
        obstacle: Name of the obstacle part that it comes nearest to, empty without obstacles.
        workspace: Smallest ``f - E q`` over the body, m, shape (M,); negative outside W.
    """

    t: Array
    clearance: Array
    part: tuple[str, ...]
    obstacle: tuple[str, ...]
    workspace: Array

    @property
    def minimum(self) -> float:
        """The smallest clearance of all samples, m."""
        return float(self.clearance.min())

    @property
    def worst(self) -> int:
        """Index of the sample with the smallest clearance."""
        return int(self.clearance.argmin())


def minimum_clearance(
    scenario: Scenario, vehicle: VehicleModel, trajectory: Trajectory, dt: float = 1e-3
) -> ClearanceSeries:
    """Clearance of the replayed motion at times at most ``dt`` (s) apart, the knots included.

    Raises:
        InputError: The trajectory does not fit the vehicle or cannot be integrated.
    """
    motion = replay(vehicle, trajectory)
    t = motion.dense(dt)
    return clearance_series(scenario, vehicle, motion.at(t), t)


def clearance_series(scenario: Scenario, vehicle: VehicleModel, states: Array, t: Array) -> ClearanceSeries:
    """Clearance at given states.

    Args:
        scenario: In the coordinates of the states.
        vehicle: Whose body it is.
        states: Shape (M, n_x); poses (M, 3) are enough for vehicles with one frame.
        t: Their times, or whatever tells them apart, shape (M,).
    """
    columns = vehicle.frames(list(states.T), np)
    poses = [np.stack(np.broadcast_arrays(*frame), axis=-1) for frame in columns]
    best, pair, inside = np.full(t.size, np.inf), np.zeros(t.size, dtype=np.intp), np.full(t.size, np.inf)
    obstacles = scenario.obstacle_polygons
    names = [(part.name, obstacle) for part in vehicle.parts for obstacle in scenario.part_names] or [("", "")]
    for i, part in enumerate(vehicle.parts):
        V = transform(part.polygon.vertices, poses[part.frame])
        inside = np.minimum(inside, (scenario.workspace.b - V @ scenario.workspace.A.T).min(axis=(1, 2)))
        for j in _candidates(V, obstacles):
            gap = _clearance_where_near(V, obstacles[j].vertices, best)
            pair = np.where(gap < best, i * len(obstacles) + j, pair)
            best = np.minimum(best, gap)
    named = [names[index] for index in pair]
    return ClearanceSeries(t, best, tuple(name for name, _ in named), tuple(name for _, name in named), inside)


def _candidates(V: Array, obstacles: PolygonStack) -> list[int]:
    """Which polygons may be the nearest to V (M, n, 2) at some time: none is that is always farther than another."""
    if not (len(obstacles) and V.size):
        return []
    apart = obstacles.box_distances(V.reshape(-1, 2))
    farthest = signed_distance(V, obstacles[int(apart.argmin())].vertices).max()
    candidates: list[int] = np.flatnonzero(apart <= max(farthest, 0.0)).tolist()
    return candidates


def _clearance_where_near(V: Array, O: Array, best: Array) -> Array:
    """Signed distance (M,) of V (M, n, 2) to O (m, 2); infinite where bounding circles exclude less than
    ``best``."""
    center_V, center_O = V.mean(axis=1), O.mean(axis=0)
    radius_V = np.hypot(*(V[0] - center_V[0]).T).max()
    radius_O = np.hypot(*(O - center_O).T).max()
    near = np.flatnonzero(np.hypot(*(center_V - center_O).T) - radius_V - radius_O < best)
    gap = np.full(best.size, np.inf)
    gap[near] = signed_distance(V[near], O)
    return gap
