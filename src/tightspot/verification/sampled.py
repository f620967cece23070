"""How near every body part comes to everything at given states: fast, and no proof of anything between them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tightspot.geometry import clearance, transform
from tightspot.scenarios import Scenario
from tightspot.vehicles import VehicleModel
from tightspot.verification import compiled

Array = NDArray[np.float64]

FAR = 8.0
"""Farther than this, m, nobody asks for the exact distance."""


def sampled_clearance(states: Array, scenario: Scenario, vehicle: VehicleModel, far: float = FAR) -> Array:
    """Signed distance of every body part and obstacle part at the states (M, n_x), m, (M, parts, obstacle parts).

    Of what is farther than ``far`` (m) it is the distance of the bounding boxes, which is no larger.
    """
    polygons = [polygon for _, polygon in scenario.obstacle_parts]
    barriers = compiled.obstacles(polygons) if compiled.is_there() else None
    result = np.empty((len(states), len(vehicle.parts), len(polygons)))
    for i, (part, poses) in enumerate(zip(vehicle.parts, _poses(states, vehicle), strict=True)):
        if barriers is not None:
            result[:, i] = compiled.clearances(part.polygon, poses, barriers, far).reshape(result[:, i].shape)
            continue
        body = transform(part.polygon.vertices, poses)
        low, high = body.min(axis=1), body.max(axis=1)
        for j, polygon in enumerate(polygons):
            gaps = np.maximum(polygon.vertices.min(axis=0) - high, low - polygon.vertices.max(axis=0))
            result[:, i, j] = np.hypot(*np.maximum(gaps, 0.0).T)
            near = result[:, i, j] <= far
            if near.any():
                result[near, i, j] = clearance(body[near], polygon.vertices)
    return result


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


def _poses(states: Array, vehicle: VehicleModel) -> list[Array]:
    """Of every body part's frame at the states, each (M, 3)."""
    frames = vehicle.frames(list(states.T), np)
    return [np.column_stack(np.broadcast_arrays(*frames[part.frame])) for part in vehicle.parts]
