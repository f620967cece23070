"""Random polygons, convex and not."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rng = np.random.Generator


def convex(rng: Rng, size: float) -> Array:
    """A convex polygon of 3 to 8 corners on a random ellipse about the origin; ``size`` is its longer half axis, m."""
    corners = int(rng.integers(3, 9))
    gaps = rng.dirichlet(np.full(corners, 3.0))
    angles = 2 * np.pi * np.cumsum(gaps)
    points = np.stack([size * np.cos(angles), size * rng.uniform(0.35, 1.0) * np.sin(angles)], axis=1)
    return turned(points, rng.uniform(0, 2 * np.pi))


def star(rng: Rng, size: float) -> Array:
    """A star-shaped polygon of 6 to 12 corners that is hardly ever convex."""
    corners = int(rng.integers(6, 13))
    angles = 2 * np.pi * (np.arange(corners) + rng.uniform(-0.3, 0.3, corners)) / corners
    radii = size * rng.uniform(0.35, 1.0, corners)
    return np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)


def bracket(rng: Rng, size: float) -> Array:
    """An L, a U or a T of random limbs."""
    a, b = size * rng.uniform(0.6, 1.0, 2)
    s = float(min(a, b) * rng.uniform(0.25, 0.6))
    kind = rng.integers(3)
    if kind == 0:
        points = [(-a, -b), (a, -b), (a, -b + s), (-a + s, -b + s), (-a + s, b), (-a, b)]
    elif kind == 1:
        points = [(-a, -b), (a, -b), (a, b), (a - s, b), (a - s, -b + s), (-a + s, -b + s), (-a + s, b), (-a, b)]
    else:
        points = [(-s / 2, -b), (s / 2, -b), (s / 2, b - s), (a, b - s), (a, b), (-a, b), (-a, b - s), (-s / 2, b - s)]
    return turned(np.array(points), rng.uniform(0, 2 * np.pi))


def any_polygon(rng: Rng, size: float) -> Array:
    """One of the above, convex every other time; simple, and of some area."""
    while True:
        draw = (convex, convex, star, bracket)[int(rng.integers(4))]
        points = draw(rng, size)
        shape = shapely.Polygon(points)
        if shape.is_valid and shape.area > 0.05 * size**2:
            return points


def turned(points: Array, angle: float) -> Array:
    """The points turned about the origin."""
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(points @ np.array([[c, s], [-s, c]]))
