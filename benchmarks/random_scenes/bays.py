"""Slots beside an aisle: perpendicular, parallel, oblique.

The aisle runs along x, the slot opens to it at y = 0 and lies below.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from benchmarks.random_scenes.car import Car
from benchmarks.random_scenes.layout import Layout, box, free_pose, slot_ratio

Array = NDArray[np.float64]
Rng = np.random.Generator

PARALLEL_TIGHTEST, PARALLEL_LONGEST = 1.18, 1.6
"""A parallel slot of 1.03 times the car's length takes thousands of moves; these take one to about ten."""


def perpendicular(rng: Rng, car: Car) -> Layout:
    """Into a slot square to the aisle, forwards or in reverse."""
    ratio, reverse = slot_ratio(rng), bool(rng.random() < 0.6)
    width, back = ratio * car.width, float(rng.uniform(0.15, 0.8))
    depth = car.length + back + float(rng.uniform(0.0, 0.4))
    aisle = car.length * float(rng.uniform(1.25, 2.1) if reverse else rng.uniform(1.6, 2.4))
    left, right = rng.uniform(7, 12, 2)
    workspace = (-left, right, -depth - 0.3, aisle)
    obstacles = {
        "left": _neighbour(rng, -1, width / 2, left, depth),
        "right": _neighbour(rng, 1, width / 2, right, depth),
    }
    if rng.random() < 0.6:
        obstacles["back"] = box(-left, right, -depth - 0.3, -depth)
    workspace = _far_side(rng, workspace, obstacles)
    middle = -depth + back + car.length / 2
    goal = car.centred(0.0, middle, math.pi / 2 if reverse else -math.pi / 2)
    region = (-left + car.length / 2, right - car.length / 2, car.width / 2, aisle - car.width / 2)
    start = free_pose(
        rng, car, workspace, list(obstacles.values()), region=region, headings=(0.0, math.pi), spread=0.15
    )
    kind = f"{'reverse' if reverse else 'forward'} into a perpendicular slot"
    return Layout(kind, workspace, obstacles, start, goal, ratio, (width - car.width) / 2)


def parallel(rng: Rng, car: Car) -> Layout:
    """Into a slot along the aisle."""
    ratio = float(PARALLEL_TIGHTEST + (PARALLEL_LONGEST - PARALLEL_TIGHTEST) * rng.random() ** 1.5)
    length, depth = ratio * car.length, slot_ratio(rng) * car.width
    turn_round = bool(rng.random() < 0.1)
    aisle = car.length * float(rng.uniform(1.4, 2.0)) if turn_round else car.width * float(rng.uniform(1.8, 3.2))
    left, right = length / 2 + rng.uniform(6, 10, 2)
    workspace = (-left, right, -depth - 0.3, aisle)
    obstacles = {
        "behind": _neighbour(rng, -1, length / 2, left, depth),
        "ahead": _neighbour(rng, 1, length / 2, right, depth),
    }
    if rng.random() < 0.7:
        obstacles["kerb"] = box(-left, right, -depth - 0.3, -depth)
    workspace = _far_side(rng, workspace, obstacles)
    gap = (depth - car.width) / 2
    slack = (length - car.length) / 2
    goal = car.centred(float(rng.uniform(-0.5, 0.5) * slack), -depth / 2, 0.0)
    region = (-left + car.length / 2, right - car.length / 2, car.width / 2, aisle - car.width / 2)
    start = free_pose(
        rng,
        car,
        workspace,
        list(obstacles.values()),
        region=region,
        headings=(math.pi,) if turn_round else (0.0,),
        spread=0.12,
    )
    kind = "into a parallel slot" + (", having turned round" if turn_round else "")
    return Layout(kind, workspace, obstacles, start, goal, ratio, min(gap, slack / 2))


def oblique(rng: Rng, car: Car) -> Layout:
    """Into a slot at 30 to 75 degrees to the aisle."""
    ratio, phi = slot_ratio(rng), math.radians(float(rng.uniform(30, 75)))
    reverse = bool(rng.random() < 0.5)
    width, back = ratio * car.width, float(rng.uniform(0.15, 0.6))
    depth = (car.length + back + float(rng.uniform(0.0, 0.4))) + 0.5 * car.width / math.tan(phi)
    height, shear = depth * math.sin(phi), depth * math.cos(phi)
    left, right = rng.uniform(8, 13, 2) + shear / 2
    half = width / 2 / math.sin(phi)
    aisle = car.length * float(rng.uniform(1.25, 2.1))
    workspace = (-left, right + shear, -height - 0.3, aisle)
    obstacles = {
        "left": np.array([(-left, 0), (-half, 0), (-half + shear, -height), (-left, -height)]),
        "right": np.array([(half, 0), (right + shear, 0), (right + shear, -height), (half + shear, -height)]),
    }
    if rng.random() < 0.6:
        obstacles["back"] = box(-left, right + shear, -height - 0.3, -height)
    workspace = _far_side(rng, workspace, obstacles)
    along = depth - back - 0.5 * car.width / math.tan(phi) - car.length / 2
    inward = -phi
    x, y = along * math.cos(inward), along * math.sin(inward)
    goal = car.centred(x, y, inward + math.pi if reverse else inward)
    region = (-left + car.length / 2, right - car.length / 2, car.width / 2, aisle - car.width / 2)
    easy = math.pi if reverse else 0.0
    start = free_pose(
        rng,
        car,
        workspace,
        list(obstacles.values()),
        region=region,
        headings=(easy, easy, easy + math.pi),
        spread=0.15,
    )
    way = "reverse" if reverse else "forward"
    kind = f"{way} into a slot at {math.degrees(phi):.0f} degrees"
    return Layout(kind, workspace, obstacles, start, goal, ratio, (width - car.width) / 2)


def _neighbour(rng: Rng, side: int, inner: float, outer: float, depth: float) -> Array:
    """What stands beside the slot: a block to the end of the scene, a parked car, or a block with a notch."""
    kind = rng.choice(["block", "car", "notch"], p=[0.4, 0.4, 0.2])
    setback = float(rng.uniform(0.0, 0.4))
    end = outer if kind != "car" else min(outer, inner + float(rng.uniform(1.7, 2.1)))
    ring = box(inner, end, -depth, -setback if kind == "car" else 0.0)
    if kind == "notch":
        x, y = inner + 0.6 * (outer - inner), -float(rng.uniform(0.3, 0.7)) * depth
        ring = np.array([(inner, -depth), (outer, -depth), (outer, y), (x, y), (x, 0.0), (inner, 0.0)])
    return ring * (side, 1)


def _far_side(
    rng: Rng, workspace: tuple[float, float, float, float], obstacles: dict[str, Array]
) -> tuple[float, float, float, float]:
    """The aisle's other side: the workspace's edge, a wall, or a row of parked cars; returns the workspace."""
    x_min, x_max, y_min, aisle = workspace
    kind = rng.choice(["edge", "wall", "cars"], p=[0.5, 0.25, 0.25])
    if kind == "wall":
        obstacles["wall"] = box(x_min, x_max, aisle, aisle + 0.3)
        return x_min, x_max, y_min, aisle + 0.3
    if kind == "cars":
        count = int(rng.integers(1, 5))
        for place in np.sort(rng.choice(int((x_max - x_min) // 2.6), count, replace=False)):
            x = x_min + 2.6 * float(place) + 0.3
            setback = float(rng.uniform(0.0, 0.4))
            obstacles[f"parked-{place}"] = box(x, x + 2.0, aisle + setback, aisle + 4.6)
        return x_min, x_max, y_min, aisle + 4.6
    return workspace
