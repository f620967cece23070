"""Corridors: a corner, an offset, a pinch."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from benchmarks.random_scenes.car import Car
from benchmarks.random_scenes.layout import Layout, box, slot_ratio

Array = NDArray[np.float64]
Rng = np.random.Generator


def corridor(rng: Rng, car: Car) -> Layout:
    """One of the three."""
    return (corner, offset, pinch)[int(rng.integers(3))](rng, car)


def one_turn_width(car: Car) -> float:
    """Width that the body sweeps at full steering, m: a corner of that width is driven without stopping."""
    half = car.width / 2
    return math.hypot(car.turning_radius + half, car.front) - (car.turning_radius - half)


def corner(rng: Rng, car: Car) -> Layout:
    """Round a square corner, from 0.95 of the width that takes no move back and forth."""
    first, second = (one_turn_width(car) * rng.uniform(0.95, 1.6, 2)).tolist()
    arm = car.length * 1.3 + max(first, second)
    workspace = (-arm, second, -first, arm)
    obstacles = {
        "inner": box(-arm, 0.0, 0.0, arm),
        "outer": np.array(
            [
                (-arm, -first - 0.4),
                (second + 0.4, -first - 0.4),
                (second + 0.4, arm),
                (second, arm),
                (second, -first),
                (-arm, -first),
            ]
        ),
    }
    workspace = (-arm, second + 0.4, -first - 0.4, arm)
    ways = (0.0, math.pi / 2) if rng.random() < 0.6 else (math.pi, -math.pi / 2)
    shift = rng.uniform(-0.3, 0.3, 2) * (np.array([first, second]) - car.width)
    start = car.centred(-arm + 0.6 * car.length, -first / 2 + float(shift[0]), ways[0])
    goal = car.centred(second / 2 + float(shift[1]), arm - 0.6 * car.length, ways[1])
    ratio = min(first, second) / car.width
    way = "forward" if ways[0] == 0.0 else "reverse"
    return Layout(f"{way} round a corner", workspace, obstacles, start, goal, ratio, (ratio - 1) * car.width / 2)


def offset(rng: Rng, car: Car) -> Layout:
    """A corridor that jumps to the side."""
    ratio = float(rng.uniform(1.3, 2.2))
    width = ratio * car.width
    jump = float(rng.uniform(0.3, 1.0)) * width
    run = car.length * float(rng.uniform(1.0, 1.8)) * max(1.0, jump / 1.5)
    arm = car.length * 1.3
    ends = (-arm - run / 2, arm + run / 2)
    top = width + jump
    workspace = (*ends, -0.4, top + 0.4)
    obstacles = {
        "lower": np.array(
            [(ends[0], -0.4), (ends[1], -0.4), (ends[1], jump), (run / 2, jump), (run / 2, 0), (ends[0], 0)]
        ),
        "upper": np.array(
            [
                (ends[0], width),
                (-run / 2, width),
                (-run / 2, top),
                (ends[1], top),
                (ends[1], top + 0.4),
                (ends[0], top + 0.4),
            ]
        ),
    }
    heading = 0.0 if rng.random() < 0.7 else math.pi
    start = car.centred(ends[0] + 0.6 * car.length, width / 2, heading)
    goal = car.centred(ends[1] - 0.6 * car.length, jump + width / 2, heading)
    way = "forward" if heading == 0.0 else "reverse"
    return Layout(f"{way} along a jog", workspace, obstacles, start, goal, ratio, (width - car.width) / 2)


def pinch(rng: Rng, car: Car) -> Layout:
    """Through one or two gaps in walls across a lane."""
    ratio = slot_ratio(rng)
    gap, lane = ratio * car.width, car.width * float(rng.uniform(2.5, 4.0))
    thickness = rng.uniform(0.3, 2.0, 2)
    apart = car.length * float(rng.uniform(1.8, 2.8))
    count = int(rng.integers(1, 3))
    end = apart / 2 + 1.6 * car.length
    workspace = (-end, end, 0.0, lane)
    obstacles: dict[str, Array] = {}
    for i in range(count):
        x = (i - (count - 1) / 2) * apart
        low = float(rng.uniform(0.1, lane - gap - 0.1))
        near, far = x - thickness[i] / 2, x + thickness[i] / 2
        obstacles[f"lower-{i}"] = box(near, far, 0.0, low)
        obstacles[f"upper-{i}"] = box(near, far, low + gap, lane)
    heading = 0.0 if rng.random() < 0.7 else math.pi
    reach = (lane - car.width) / 2 - 0.15
    y = lane / 2 + rng.uniform(-reach, reach, 2)
    start = car.centred(-end + 0.6 * car.length, float(y[0]), heading)
    goal = car.centred(end - 0.6 * car.length, float(y[1]), heading)
    way = "forward" if heading == 0.0 else "reverse"
    kind = f"{way} through {count} gap{'s' if count > 1 else ''}"
    return Layout(kind, workspace, obstacles, start, goal, ratio, (gap - car.width) / 2)
