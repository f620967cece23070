"""How near every body part comes to everything at given states: fast, and no proof of anything between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tightspot.geometry import PolygonStack, clearance, transform
from tightspot.scenarios import Scenario
from tightspot.vehicles import SingleTrack, VehicleModel
from tightspot.verification import compiled
from tightspot.verification.replay import Replay

Array = NDArray[np.float64]

FAR = 8.0
"""Farther than this, m, nobody asks for the exact distance."""


def sampled_clearance(states: Array, scenario: Scenario, vehicle: VehicleModel, far: float = FAR) -> Array:
    """Signed distance of every body part and obstacle part at the states (M, n_x), m, (M, parts, obstacle parts).

    Of what is farther than ``far`` (m) it is the distance of bounding boxes, which is no larger: that of the body part
    or that of all its places.
    """
    near, apart, found = near_clearance(states, scenario, vehicle, far)
    result = np.empty((len(states), *apart.shape))
    result[:] = apart
    result[:, :, near] = found
    return result


def near_clearance(
    states: Array, scenario: Scenario, vehicle: VehicleModel, far: float = FAR
) -> tuple[NDArray[np.intp], Array, Array]:
    """:func:`sampled_clearance` where most obstacle parts are far away.

    Returns:
        Which obstacle parts may come nearer to a body part than ``far``, (n,); how far the bounding boxes of each
        body part's whole motion and of each obstacle part are apart, m, (parts, obstacle parts); and what
        :func:`sampled_clearance` says of the near ones, (M, parts, n).
    """
    polygons, poses = scenario.obstacle_polygons, _poses(states, vehicle)
    bodies = [transform(part.polygon.vertices, at) for part, at in zip(vehicle.parts, poses, strict=True)]
    apart = np.array([polygons.box_distances(body.reshape(-1, 2)) for body in bodies])
    near = np.flatnonzero((apart <= far).any(axis=0))
    chosen = polygons if near.size == len(polygons) else polygons.chosen(near)
    barriers = compiled.obstacles(chosen) if compiled.is_there() else None
    found = np.empty((len(states), len(vehicle.parts), near.size))
    for i, (part, at, body) in enumerate(zip(vehicle.parts, poses, bodies, strict=True)):
        if barriers is not None:
            found[:, i] = compiled.clearances(part.polygon, at, barriers, far).reshape(found[:, i].shape)
        else:
            found[:, i] = _clearances(body, chosen, far)
    return near, apart, found


def _clearances(body: Array, polygons: PolygonStack, far: float) -> Array:
    """Of a body part at its places (M, n, 2): see :func:`sampled_clearance`, (M, len(polygons))."""
    low, high = body.min(axis=1), body.max(axis=1)
    found = np.empty((len(body), len(polygons)))
    for j, polygon in enumerate(polygons):
        gaps = np.maximum(polygons.low[j] - high, low - polygons.high[j])
        found[:, j] = np.hypot(*np.maximum(gaps, 0.0).T)
        close = found[:, j] <= far
        if close.any():
            found[close, j] = clearance(body[close], polygon.vertices)
    return found


def sampled_room(states: Array, scenario: Scenario, vehicle: VehicleModel) -> Array:
    """How far every body part is inside every edge of W at the states (M, n_x), m, (M, parts, edges)."""
    workspace = scenario.workspace
    barriers = compiled.walls(workspace) if compiled.is_there() else None
    result = np.empty((len(states), len(vehicle.parts), len(workspace.b)))
    for i, (part, poses) in enumerate(zip(vehicle.parts, _poses(states, vehicle), strict=True)):
        if barriers is not None:
            result[:, i] = compiled.depths(part.polygon, poses, barriers).reshape(result[:, i].shape)
        else:
            result[:, i] = (workspace.b - transform(part.polygon.vertices, poses) @ workspace.A.T).min(axis=1)
    return result


@dataclass(frozen=True, eq=False)
class Nearness:
    """How near a motion comes to everything on each of its N intervals.

    Attributes:
        near: Which obstacle parts may come nearer to a body part than asked for, (n,).
        apart: How far the bounding boxes of each body part's whole motion and of each obstacle part are apart, m,
            (parts, obstacle parts).
        clearances: Smallest of :func:`sampled_clearance` of the near ones, m, (N, parts, n).
        depths: Smallest of :func:`sampled_room`, m, (N, parts, edges).
    """

    near: NDArray[np.intp]
    apart: Array
    clearances: Array
    depths: Array


def nearness(states: Array, per_interval: int, scenario: Scenario, vehicle: VehicleModel, far: float = FAR) -> Nearness:
    """Of ``N * per_interval + 1`` states in order; what lies at both ends of an interval counts for it."""
    if not compiled.is_there():
        near, apart, found = near_clearance(states, scenario, vehicle, far)
        depths = sampled_room(states, scenario, vehicle)
        return Nearness(near, apart, by_interval(found, per_interval), by_interval(depths, per_interval))
    parts = vehicle.part_stack if isinstance(vehicle, SingleTrack) else PolygonStack(p.polygon for p in vehicle.parts)
    barriers = compiled.obstacles(scenario.obstacle_polygons), compiled.walls(scenario.workspace)
    nearby = compiled.nearness(parts, _poses(states, vehicle), per_interval, *barriers, far)
    return _shaped(nearby, (len(states) - 1) // per_interval, len(parts), scenario)


def nearness_along(motion: Replay, scenario: Scenario, far: float = FAR) -> Nearness:
    """Of a replayed motion on the intervals between its knots, at the nodes of its integration."""
    vehicle = motion.vehicle
    if motion.core is None or not isinstance(vehicle, SingleTrack):
        near, apart, found = near_clearance(motion.node_states, scenario, vehicle, far)
        depths = sampled_room(motion.node_states, scenario, vehicle)
        return Nearness(near, apart, *(_least(each, motion.first_nodes) for each in (found, depths)))
    barriers = compiled.obstacles(scenario.obstacle_polygons), compiled.walls(scenario.workspace)
    nearby = compiled.nearness_along(motion.core, vehicle, *barriers, far)
    return _shaped(nearby, motion.trajectory.steps, len(vehicle.parts), scenario)


def _least(samples: Array, first: NDArray[np.intp]) -> Array:
    """Smallest value on each interval of samples ``first[k]`` to ``first[k + 1]``, (N, ...)."""
    return np.asarray(np.minimum(np.minimum.reduceat(samples[:-1], first[:-1], axis=0), samples[first[1:]]))


_Found = tuple[NDArray[np.int64], Array, Array, Array]


def _shaped(found: _Found, steps: int, parts: int, scenario: Scenario) -> Nearness:
    """What the core found on so many intervals, of so many parts."""
    near, apart, clearances, depths = found
    return Nearness(
        near.astype(np.intp, copy=False),
        apart.reshape(parts, len(scenario.obstacle_polygons)),
        clearances.reshape(steps, parts, near.size),
        depths.reshape(steps, parts, len(scenario.workspace.b)),
    )


def by_interval(samples: Array, per_interval: int) -> Array:
    """Smallest value on each interval, both ends included, of ``N * per_interval + 1`` samples: (N, ...)."""
    return _least(samples, np.arange(0, len(samples), per_interval))


def _poses(states: Array, vehicle: VehicleModel) -> Array:
    """Of every body part's frame at the states, (parts, M, 3)."""
    frames = vehicle.frames(list(states.T), np)
    poses = np.empty((len(vehicle.parts), len(states), 3))
    for part, places in zip(vehicle.parts, poses, strict=True):
        places[:, 0], places[:, 1], places[:, 2] = frames[part.frame]
    return poses
