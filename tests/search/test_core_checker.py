"""The core's collision checker against the package's own closed-form separation and shapely."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from tightspot import _core
from tightspot.geometry import ConvexPolygon, PolygonStack, clearance, transform
from tightspot.vehicles import vehicle

WORKSPACE = ConvexPolygon.rectangle(-20, 20, -20, 20)


def random_polygons(rng: np.random.Generator, count: int) -> list[ConvexPolygon]:
    polygons = []
    for corners in rng.integers(3, 9, count):
        points = rng.normal(0, 1.5, (corners, 2)) + rng.uniform(-15, 15, 2)
        hull = shapely.convex_hull(shapely.multipoints(points))
        polygons.append(ConvexPolygon.from_vertices(shapely.get_coordinates(hull)))
    return polygons


@pytest.mark.parametrize("name", ["paper", "forklift"])
@pytest.mark.parametrize("margin", [0.0, 0.1])
def test_clearances_and_verdicts_agree_with_the_closed_form(name, margin):
    rng = np.random.default_rng(7)
    car, obstacles = vehicle(name), random_polygons(rng, 25)
    parts = [part.polygon.vertices for part in car.parts]
    stack = PolygonStack(obstacles)
    checker = _core.CollisionChecker(parts, WORKSPACE.vertices, stack.vertices, stack.first, margin)
    poses = np.c_[rng.uniform(-14, 14, (400, 2)), rng.uniform(-4, 4, 400)]
    slacks = checker.slack(poses)
    pairs = [clearance(transform(part, poses), obstacle.vertices) for part in parts for obstacle in obstacles]
    for pose, slack, expected in zip(poses, slacks, np.min(pairs, axis=0), strict=True):
        index, measured = checker.contact(pose)
        assert measured == pytest.approx(expected, abs=1e-9)
        assert 0 <= index < len(obstacles)
        assert (slack > 0) == (expected > margin)
        assert slack <= max(expected - margin, 0) + 1e-9


def test_arrays_of_the_wrong_kind_are_refused():
    none = np.zeros((0, 2)), np.zeros(1, dtype=np.int64)
    with pytest.raises(TypeError):
        _core.CollisionChecker([np.zeros((4, 3))], WORKSPACE.vertices, *none, 0.0)
    with pytest.raises(ValueError, match="three distinct vertices"):
        _core.CollisionChecker([np.zeros((4, 2))], WORKSPACE.vertices, *none, 0.0)
    with pytest.raises(ValueError, match="must follow one another"):
        _core.CollisionChecker([WORKSPACE.vertices], WORKSPACE.vertices, none[0], np.array([0, 4]), 0.0)
