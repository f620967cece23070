"""Free-form clutter, by itself and strewn over the other families."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import shapely
from numpy.typing import NDArray

from benchmarks.random_scenes.bays import oblique, parallel, perpendicular
from benchmarks.random_scenes.car import Car
from benchmarks.random_scenes.corridors import pinch
from benchmarks.random_scenes.enclosures import garage
from benchmarks.random_scenes.layout import MOST_OBSTACLES, Layout, NoLayoutError, box, free_pose
from benchmarks.random_scenes.shapes import any_polygon

Array = NDArray[np.float64]
Rng = np.random.Generator


def clutter(rng: Rng, car: Car) -> Layout:
    """A yard with one to ten polygons, convex and not, between start and goal."""
    half = float(rng.uniform(8, 13))
    workspace = (-half, half, -half, half)
    region = tuple(0.8 * side for side in workspace)
    ends = [
        free_pose(rng, car, workspace, [], region=region, headings=(0.0,), spread=math.pi),
        free_pose(rng, car, workspace, [], region=region, headings=(0.0,), spread=math.pi),
    ]
    if math.dist(ends[0][:2], ends[1][:2]) < 6:
        raise NoLayoutError
    empty = Layout("across a yard", workspace, {}, ends[0], ends[1], math.inf, 0.2)
    return strewn(rng, car, empty, int(rng.integers(1, MOST_OBSTACLES + 1)), (0.6, 3.0))


def mixture(rng: Rng, car: Car) -> Layout:
    """Another family with one to four things lying about."""
    family = (perpendicular, parallel, oblique, garage, pinch)[int(rng.integers(5))]
    layout = family(rng, car)
    count = min(int(rng.integers(1, 5)), MOST_OBSTACLES - len(layout.obstacles))
    if count < 1:
        raise NoLayoutError
    mixed = strewn(rng, car, layout, count, (0.2, 0.9))
    return dataclasses.replace(mixed, kind=f"{layout.kind}, things lying about")


def strewn(rng: Rng, car: Car, layout: Layout, count: int, sizes: tuple[float, float]) -> Layout:
    """The layout with ``count`` polygons more, none on start or goal, none in the slot's mouth.

    Raises:
        NoLayoutError: There is no room for so many.
    """
    W = shapely.Polygon(box(*layout.workspace))
    keep = shapely.union_all([car.placed(pose).convex_hull.buffer(0.15) for pose in (layout.start, layout.goal)])
    keep = shapely.union_all([keep, *(_run_up(car, pose) for pose in (layout.start, layout.goal))])
    obstacles = dict(layout.obstacles)
    taken = layout.shapes
    for _ in range(40 * count):
        if len(obstacles) == len(layout.obstacles) + count:
            break
        size = float(np.exp(rng.uniform(*np.log(sizes))))
        ring = any_polygon(rng, size) + _place(rng, layout)
        shape = shapely.Polygon(ring)
        if shape.intersection(W).area < 0.5 * shape.area or shape.intersects(keep):
            continue
        if layout.obstacles and any(shape.intersects(other) for other in taken):
            continue
        taken.append(shape)
        obstacles[f"thing-{len(obstacles)}"] = ring
    else:
        raise NoLayoutError
    return dataclasses.replace(layout, obstacles=obstacles)


def _place(rng: Rng, layout: Layout) -> Array:
    """Anywhere in the workspace, or every other time near the way from start to goal."""
    x_min, x_max, y_min, y_max = layout.workspace
    if rng.random() < 0.5:
        return rng.uniform([x_min, y_min], [x_max, y_max])
    start, goal = np.array(layout.start[:2]), np.array(layout.goal[:2])
    return np.asarray(start + rng.random() * (goal - start) + rng.normal(0.0, 2.5, 2))


def _run_up(car: Car, pose: tuple[float, float, float]) -> shapely.Geometry:
    """A strip half as long as the car before and behind it, so that it is not walled in."""
    x, y, theta = pose
    ends = [
        (x + reach * math.cos(theta), y + reach * math.sin(theta))
        for reach in (-car.rear - 0.5 * car.length, car.front + 0.5 * car.length)
    ]
    return shapely.LineString(ends).buffer(car.width / 2 + 0.1, cap_style="flat")
