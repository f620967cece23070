"""Oracles that share no code with the core: shapely for clearances, plain sums for arcs."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest
import shapely
from numpy.typing import NDArray
from shapely import affinity

from tightspot import scenarios
from tightspot.geometry import ConvexPolygon
from tightspot.search import Car, Path
from tightspot.vehicles import load_vehicle

Array = NDArray[np.float64]
Scene = tuple[ConvexPolygon, list[ConvexPolygon], Car, Array, Array]


@pytest.fixture
def scene() -> Callable[[str], Scene]:
    """Workspace, obstacle parts, vehicle, start pose and goal pose of a built-in scene."""

    def of(name: str) -> Scene:
        loaded = scenarios.builtin(name)
        parts = [part for obstacle in loaded.obstacles for part in obstacle.parts]
        return loaded.workspace, parts, load_vehicle(str(loaded.vehicle)), loaded.start[:3], loaded.goal[:3]

    return of


@pytest.fixture
def body_at() -> Callable[[Car, Array], shapely.Geometry]:
    """The body at a pose, as one shapely geometry."""

    def at(vehicle: Car, pose: Array) -> shapely.Geometry:
        body = shapely.union_all([part.polygon.to_shapely() for part in vehicle.parts])
        turned = affinity.rotate(body, pose[2], origin=(0, 0), use_radians=True)
        return affinity.translate(turned, pose[0], pose[1])

    return at


@pytest.fixture
def clearance_along(
    body_at: Callable[[Car, Array], shapely.Geometry],
) -> Callable[[Path, Car, ConvexPolygon, Sequence[ConvexPolygon]], tuple[float, float]]:
    """Smallest distance to an obstacle, and farthest reach out of the workspace, on poses 2 cm apart."""

    def along(
        path: Path, vehicle: Car, workspace: ConvexPolygon, obstacles: Sequence[ConvexPolygon]
    ) -> tuple[float, float]:
        fine = Path.from_arcs(path.poses[0], path.arcs, 0.02)
        bodies = [body_at(vehicle, pose) for pose in fine.poses]
        corners = shapely.get_coordinates(bodies)
        excess = float((corners @ workspace.A.T - workspace.b).max())
        if not obstacles:
            return np.inf, excess
        everything = shapely.union_all([obstacle.to_shapely() for obstacle in obstacles])
        return float(shapely.distance(bodies, everything).min()), excess

    return along


@pytest.fixture
def driven() -> Callable[[Array, Array], Array]:
    """The end of the arcs (signed length, curvature) from a pose, summed up in small steps."""

    def drive(start: Array, arcs: Array, steps: int = 4000) -> Array:
        x, y, theta = (float(value) for value in start)
        for length, curvature in arcs:
            ds = length / steps
            headings = theta + curvature * ds * (np.arange(steps) + 0.5)
            x += float(np.cos(headings).sum() * ds)
            y += float(np.sin(headings).sum() * ds)
            theta += curvature * length
        return np.array([x, y, theta])

    return drive
