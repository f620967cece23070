"""What would free a vehicle that cannot stand where it shall: the smallest change of place, heading or width."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import shapely
from numpy.typing import NDArray

from tightspot.errors import GeometryError, VehicleError
from tightspot.geometry import ConvexPolygon
from tightspot.geometry import clearance as signed_distance
from tightspot.scenarios.clearances import body_vertices, clearances, padded_vertices, workspace_excess
from tightspot.scenarios.scenario import Scenario
from tightspot.vehicles import VehicleModel, body_width, narrowed

Array = NDArray[np.float64]

SLACK = 1e-9
"""Rounding that is forgiven, m, m/s, rad."""
NEAR = 2.0
"""A better place is first sought among the obstacles this near, m."""
NARROWEST = 0.5
"""A body narrower than this part of the vehicle's is no advice."""

_QUADRANT = 16
_DECIMALS = (3, 6)


def fits(scenario: Scenario, vehicle: VehicleModel, state: Array, margin: float) -> bool:
    """Whether the standing vehicle keeps the margin from every obstacle and lies within the workspace."""
    near = clearances(scenario, vehicle, state, reach=margin)
    clear = not near or near[0].value >= margin - SLACK
    return clear and workspace_excess(scenario, vehicle, state)[0] <= SLACK


def shortest_move(scenario: Scenario, vehicle: VehicleModel, state: Array, margin: float) -> tuple[float, float] | None:
    """The shortest displacement (x, y), m, after which the vehicle fits with the same heading, if there is one.

    A body part B collides when displaced by the vectors of the Minkowski sum of the obstacle part O and -B, enlarged by
    the margin; it is within W when displaced by those of a convex polygon. The nearest point of what is left is the
    answer, away from the border by a millimetre so that it can be written with three decimals; where that leaves
    nothing, with six. The displaced vehicle is then checked against everything.
    """
    for decimals in _DECIMALS:
        for reach in (NEAR, np.inf):
            step = _nearest_step(scenario, vehicle, state, margin, 10.0**-decimals, reach)
            if step is None or np.hypot(*step) > reach:
                continue
            x, y = np.round(step, decimals) + 0.0
            if fits(scenario, vehicle, state + np.array([x, y, 0.0, 0.0, 0.0]), margin):
                return float(x), float(y)
    return None


def overlap_depth(scenario: Scenario, vehicle: VehicleModel, state: Array, obstacle: str) -> float:
    """The shortest displacement of the whole body out of a whole obstacle, m; 0 if they do not overlap.

    Where both are convex this is minus the signed distance; of other shapes no single pair of convex parts tells it.
    The displacements that collide are the union of the parts' Minkowski sums, the answer is how deep 0 is in there.
    """
    polygons = scenario.obstacle_polygons
    rows = [i for i, label in enumerate(scenario.part_labels) if label == obstacle]
    parts = [polygon.vertices - state[:2] for polygon in polygons.chosen(np.array(rows, dtype=int))]
    if not parts:
        return 0.0
    bodies = [vertices - state[:2] for _, vertices in body_vertices(vehicle, state)]
    colliding = shapely.union_all(np.concatenate([_sums(padded_vertices(parts), vertices) for vertices in bodies]))
    here = shapely.Point(0.0, 0.0)
    return float(shapely.distance(here, shapely.boundary(colliding))) if shapely.contains(colliding, here) else 0.0


def _nearest_step(
    scenario: Scenario, vehicle: VehicleModel, state: Array, margin: float, spare: float, reach: float
) -> Array | None:
    """The shortest displacement, free by ``spare`` more than demanded of W and of the obstacles within ``reach``."""
    here = state[:2]
    bodies = [vertices - here for _, vertices in body_vertices(vehicle, state)]
    W = scenario.workspace
    support = np.max([(vertices @ W.A.T).max(axis=0) for vertices in bodies], axis=0)
    try:
        room = ConvexPolygon.from_halfplanes(W.A, W.b - W.A @ here - support - spare)
    except GeometryError:
        return None
    free = room.to_shapely()
    corners = np.vstack(bodies)
    polygons = scenario.obstacle_polygons
    within = np.flatnonzero(polygons.box_distances(corners + here) <= reach + margin + spare)
    near = [polygon.vertices - here for polygon in polygons.chosen(within)]
    if near:
        outside = (margin + spare) / np.cos(np.pi / (4 * _QUADRANT))  # the arcs' chords lie outside the circle
        sums = np.concatenate([_sums(padded_vertices(near), vertices) for vertices in bodies])
        free = shapely.difference(free, shapely.union_all(shapely.buffer(sums, outside, quad_segs=_QUADRANT)))
    if free.is_empty:
        return None
    step: Array = shapely.get_coordinates(shapely.shortest_line(free, shapely.Point(0.0, 0.0)))[0]
    return step


def _sums(obstacles: Array, body: Array) -> NDArray[np.object_]:
    """Minkowski sums of obstacles (M, n, 2) and the mirrored body (m, 2): the displacements that collide."""
    differences = obstacles[:, :, None] - body
    return np.asarray(shapely.convex_hull(shapely.multipoints(differences.reshape(len(obstacles), -1, 2))))


def smallest_turn(scenario: Scenario, vehicle: VehicleModel, state: Array, margin: float) -> float | None:
    """The smallest change of heading, a multiple of 0.1 deg, after which the vehicle fits in the same place, rad."""
    found = _first_free_turn(scenario, vehicle, state, margin, np.arange(0.5, 180.1, 0.5))
    if found is None:
        return None
    finer = abs(found) - np.array([0.4, 0.3, 0.2, 0.1])
    return float(np.radians(_first_free_turn(scenario, vehicle, state, margin, finer) or found))


def _first_free_turn(
    scenario: Scenario, vehicle: VehicleModel, state: Array, margin: float, sizes: Array
) -> float | None:
    """The first of the angles, in degrees, left before right, at which the vehicle fits."""
    degrees = np.column_stack([sizes, -sizes]).ravel()
    free = np.ones(degrees.size, bool)
    bodies = _turned_bodies(vehicle, state, np.radians(degrees))
    W = scenario.workspace
    for vertices in bodies:
        free &= (vertices @ W.A.T <= W.b + SLACK).all(axis=(1, 2))
    corners = np.concatenate([vertices.reshape(-1, 2) for vertices in bodies])
    polygons = scenario.obstacle_polygons
    for polygon in polygons.chosen(np.flatnonzero(polygons.box_distances(corners) <= margin)):
        for vertices in bodies:
            rows = np.flatnonzero(free)
            if rows.size:
                free[rows] = signed_distance(vertices[rows], polygon.vertices) >= margin - SLACK
    return float(degrees[free.argmax()]) if free.any() else None


def _turned_bodies(vehicle: VehicleModel, state: Array, angles: Array) -> list[Array]:
    """Vertices of every part with the heading changed by each angle, (M, n, 2)."""
    standing = [vertices - state[:2] for _, vertices in body_vertices(vehicle, state)]
    cos, sin = np.cos(angles), np.sin(angles)
    turns = np.stack([np.stack([cos, sin], axis=-1), np.stack([-sin, cos], axis=-1)], axis=-2)
    return [vertices @ turns + state[:2] for vertices in standing]


def largest_width(scenario: Scenario, vehicle: VehicleModel, state: Array, margin: float) -> float | None:
    """The largest width of the body, in whole mm, with which the vehicle fits in this pose, m, if that is advice."""
    width = body_width(vehicle)

    def passes(millimetres: int) -> bool:
        return fits(scenario, narrowed(vehicle, millimetres / 1000 / width), state, margin)

    low, high = int(np.ceil(1000 * NARROWEST * width)), int(np.ceil(1000 * width))
    try:
        if not passes(low):
            return None
    except VehicleError:
        return None
    return bisected(passes, low, high) / 1000


def bisected(passes: Callable[[int], bool], low: int, high: int) -> int:
    """A whole number that passes while its successor, or ``high``, does not; ``low`` passes and ``high`` does not."""
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if passes(middle) else (low, middle)
    return low
