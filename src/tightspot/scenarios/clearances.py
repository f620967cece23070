"""How near a standing vehicle is to every obstacle, and to the workspace's sides."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tightspot.geometry import ConvexPolygon, best_line, transform
from tightspot.scenarios.scenario import Scenario
from tightspot.scenarios.states import STATE
from tightspot.vehicles import VehicleModel

Array = NDArray[np.float64]


class Clearance(NamedTuple):
    """The nearest obstacle of a vehicle that stands still.

    Attributes:
        value: Signed distance, m: minus the penetration depth if they overlap, infinite without obstacles.
        obstacle: Name of the obstacle, or ``a+b`` where a part of the solid is of both.
        part: Name of the body part.
        normal: Unit vector from the obstacle to the body; along it is the shortest way out, shape (2,).
    """

    value: float
    obstacle: str
    part: str
    normal: Array


def clearances(
    scenario: Scenario,
    vehicle: VehicleModel,
    state: Array,
    reach: float = np.inf,
    bodies: list[tuple[str, Array]] | None = None,
) -> list[Clearance]:
    """One :class:`Clearance` an obstacle, nearest first, of the vehicle in one state.

    Args:
        scenario: The scene.
        vehicle: The vehicle.
        state: (x, y, theta, v, delta), free entries NaN.
        reach: Obstacles farther away than this may be left out, m.
        bodies: The :func:`body_vertices` in that state if they are known.
    """
    bodies = body_vertices(vehicle, state) if bodies is None else bodies
    corners = np.vstack([vertices for _, vertices in bodies])
    labels, parts = scenario.part_labels, scenario.obstacle_polygons
    boxes = np.flatnonzero(parts.box_distances(corners) <= reach).tolist()
    near = [i for i in boxes if not _beyond_an_edge(parts[i], corners, reach)]
    if not near:
        return []
    padded = padded_vertices([parts[i].vertices for i in near])
    nearest: dict[str, Clearance] = {}
    for part_name, vertices in bodies:
        line = best_line(vertices, padded)
        for row in np.argsort(line.clearance, kind="stable"):
            name, value = labels[near[row]], float(line.clearance[row])
            if name not in nearest or value < nearest[name].value:
                nearest[name] = Clearance(value, name, part_name, line.normal[row])
    return sorted(nearest.values(), key=lambda clearance: clearance.value)


def clearance(scenario: Scenario, vehicle: VehicleModel, state: Array) -> Clearance:
    """The nearest obstacle of the vehicle in one state; its value is infinite if there is no obstacle."""
    found = clearances(scenario, vehicle, state)
    return found[0] if found else Clearance(np.inf, "", "", np.zeros(2))


def surely_free(scenario: Scenario, vehicle: VehicleModel, states: Array, reach: float, slack: float) -> bool:
    """Whether it is seen at a glance that the vehicle is free in all the states (m, 5): by one edge of each obstacle.

    True only if nothing is nearer than ``reach`` (m) and the body leaves the workspace nowhere by more than ``slack``
    (m). If false, one has to look closer.
    """
    frames = vehicle.frames([states[:, STATE.index(name)] for name in vehicle.state_names], np)
    placed = []
    for part in vehicle.parts:
        poses = np.empty((len(states), 3))
        poses[:, 0], poses[:, 1], poses[:, 2] = frames[part.frame]
        placed.append(transform(part.polygon.vertices, poses))
    corners = np.concatenate(placed, axis=1)
    W, parts = scenario.workspace, scenario.obstacle_polygons
    if (corners @ W.A.T - W.b).max() > slack:
        return False
    low, high = corners.min(axis=1), corners.max(axis=1)
    gaps = np.maximum(np.maximum(parts.low - high[:, None], low[:, None] - parts.high), 0.0)
    near = (np.hypot(gaps[..., 0], gaps[..., 1]) <= reach).nonzero()
    return all(
        _beyond_an_edge(parts[i], corners[m], reach) for m, i in zip(*(index.tolist() for index in near), strict=True)
    )


def _beyond_an_edge(polygon: ConvexPolygon, points: Array, distance: float) -> bool:
    """Whether all points are farther than that from the line through one edge, hence from the polygon."""
    return bool(((points @ polygon.A.T).min(axis=0) - polygon.b).max() > distance)


def workspace_excess(
    scenario: Scenario, vehicle: VehicleModel, state: Array, bodies: list[tuple[str, Array]] | None = None
) -> tuple[float, Array]:
    """How far the body reaches out of the workspace, m (negative inside), and that side's outward normal."""
    bodies = body_vertices(vehicle, state) if bodies is None else bodies
    corners = np.vstack([vertices for _, vertices in bodies])
    W = scenario.workspace
    beyond = (corners @ W.A.T - W.b).max(axis=0)
    side = int(beyond.argmax())
    return float(beyond[side]), W.A[side]


def body_vertices(vehicle: VehicleModel, state: Array) -> list[tuple[str, Array]]:
    """Each body part's name and vertices in the scene, m, (n, 2); free entries of the state count as zero."""
    known = {
        name: 0.0 if math.isnan(value) else value for name, value in zip(STATE, np.asarray(state).tolist(), strict=True)
    }
    frames = vehicle.frames([known.get(name, 0.0) for name in vehicle.state_names], np)
    return [
        (part.name, transform(part.polygon.vertices, np.array(frames[part.frame], dtype=float)))
        for part in vehicle.parts
    ]


def padded_vertices(polygons: list[Array]) -> Array:
    """Vertex lists as one array (len, n, 2); shorter ones repeat their last vertex."""
    n = max(len(vertices) for vertices in polygons)
    return np.stack([np.vstack([v, np.repeat(v[-1:], n - len(v), axis=0)]) for v in polygons])
