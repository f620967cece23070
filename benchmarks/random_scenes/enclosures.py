"""Garages behind a forecourt, and dead ends."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from benchmarks.random_scenes.car import Car
from benchmarks.random_scenes.layout import Layout, box, free_pose, slot_ratio

Array = NDArray[np.float64]
Rng = np.random.Generator


def enclosure(rng: Rng, car: Car) -> Layout:
    """A garage, an alley to leave, or an alley to turn round in."""
    return (garage, garage, leave_alley, turn_in_alley)[int(rng.integers(4))](rng, car)


def garage(rng: Rng, car: Car) -> Layout:
    """Through a door into a box, which is one obstacle that is not convex, or three walls and two posts."""
    ratio, reverse = slot_ratio(rng), bool(rng.random() < 0.4)
    door, wall = ratio * car.width, float(rng.uniform(0.2, 0.4))
    left, right = -door / 2 - rng.uniform(0.1, 1.0), door / 2 + rng.uniform(0.1, 1.0)
    depth = car.length + float(rng.uniform(0.5, 1.2))
    court = car.length * float(rng.uniform(1.5, 2.4))
    side = float(rng.uniform(6, 10))
    workspace = (left - side, right + side, -depth - wall, court)
    outer, inner = (left - wall, right + wall), -depth
    if rng.random() < 0.5:
        ring = [(-door / 2, 0), (outer[0], 0), (outer[0], -depth - wall), (outer[1], -depth - wall), (outer[1], 0)]
        ring += [(door / 2, 0), (door / 2, -wall), (right, -wall), (right, inner), (left, inner), (left, -wall)]
        obstacles = {"garage": np.array([*ring, (-door / 2, -wall)])}
    else:
        obstacles = {
            "left post": box(outer[0], -door / 2, -wall, 0),
            "right post": box(door / 2, outer[1], -wall, 0),
            "left wall": box(outer[0], left, -depth, -wall),
            "right wall": box(right, outer[1], -depth, -wall),
            "back wall": box(*outer, -depth - wall, -depth),
        }
    if rng.random() < 0.4:
        obstacles["hedge"] = box(workspace[0], workspace[1], court, court + 0.5)
        workspace = (*workspace[:3], court + 0.5)
    middle = -depth + float(rng.uniform(0.15, 0.35)) + car.length / 2
    goal = car.centred(0.0, middle, math.pi / 2 if reverse else -math.pi / 2)
    region = (left - side + car.length / 2, right + side - car.length / 2, car.width / 2, court - car.width / 2)
    start = free_pose(
        rng,
        car,
        workspace,
        list(obstacles.values()),
        region=region,
        headings=(0.0, math.pi, -math.pi / 2),
        spread=0.3,
    )
    kind = f"{'reverse' if reverse else 'forward'} through a door into a garage"
    return Layout(kind, workspace, obstacles, start, goal, ratio, (door - car.width) / 2)


def leave_alley(rng: Rng, car: Car) -> Layout:
    """Nose in a dead end; out of it in reverse and away along the street."""
    ratio = float(rng.uniform(1.15, 2.0))
    width, depth = ratio * car.width, car.length * float(rng.uniform(1.2, 2.0))
    street = car.width * float(rng.uniform(2.2, 4.0))
    side = float(rng.uniform(9, 13))
    workspace = (-side, side, -depth - 0.4, street)
    left, right = box(-side, -width / 2, -depth, 0), box(width / 2, side, -depth, 0)
    obstacles = {"left": left, "right": right, "end": box(-width / 2, width / 2, -depth - 0.4, -depth)}
    if rng.random() < 0.5:
        ring = [(-side, 0), (-width / 2, 0), (-width / 2, -depth), (width / 2, -depth), (width / 2, 0), (side, 0)]
        obstacles = {"blind alley": np.array([*ring, (side, -depth - 0.4), (-side, -depth - 0.4)])}
    start = car.centred(0.0, -depth + 0.4 + car.length / 2, -math.pi / 2)
    region = (-side + car.length / 2, side - car.length / 2, car.width / 2, street - car.width / 2)
    goal = free_pose(rng, car, workspace, list(obstacles.values()), region=region, headings=(0.0, math.pi), spread=0.1)
    return Layout("out of a dead end", workspace, obstacles, start, goal, ratio, (width - car.width) / 2)


def turn_in_alley(rng: Rng, car: Car) -> Layout:
    """Turn round in an alley that is closed at one end, on 1.4 to 2 times the car's length."""
    ratio = float(rng.uniform(1.4, 2.0))
    width, depth = ratio * car.length, car.length * float(rng.uniform(2.2, 3.2))
    workspace = (-width / 2 - 0.4, width / 2 + 0.4, -0.4, depth)
    obstacles = {
        "left": box(-width / 2 - 0.4, -width / 2, 0, depth),
        "right": box(width / 2, width / 2 + 0.4, 0, depth),
        "end": box(-width / 2, width / 2, -0.4, 0),
    }
    reach = (width - car.width) / 2 - 0.2
    ends = [
        car.centred(float(rng.uniform(-reach, reach)), float(rng.uniform(0.5, 0.8)) * depth, theta)
        for theta in (-math.pi / 2, math.pi / 2)
    ]
    kind = f"turn round in an alley of {ratio:.2f} times the car's length"
    return Layout(kind, workspace, obstacles, ends[0], ends[1], width / car.width, reach)
