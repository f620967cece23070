"""A scene in its own convenient axes, before it is turned and moved; and the tools to lay one out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from benchmarks.random_scenes.car import Car, Pose

Array = NDArray[np.float64]
Rng = np.random.Generator

TIGHTEST, WIDEST = 1.03, 1.6
ROOM = 0.004
"""Start and goal keep the margin and this much from obstacles, m."""
MOST_OBSTACLES = 10


class NoLayoutError(Exception):
    """This draw came to nothing; draw again."""


@dataclass(frozen=True, eq=False)
class Layout:
    """A scene in its own axes.

    Attributes:
        kind: What it is, for people.
        workspace: (x_min, x_max, y_min, y_max), m.
        obstacles: Vertices by name, m.
        start: Pose of the rear-axle midpoint.
        goal: Pose of the rear-axle midpoint.
        ratio: Width of the narrowest place to pass over the car's width; for parallel slots, length over length.
        gap: What is left on either side of the car in the narrowest place, m; the margin keeps below it.
    """

    kind: str
    workspace: tuple[float, float, float, float]
    obstacles: dict[str, Array]
    start: Pose
    goal: Pose
    ratio: float
    gap: float

    @property
    def shapes(self) -> list[shapely.Polygon]:
        """The obstacles as polygons."""
        return [shapely.Polygon(vertices) for vertices in self.obstacles.values()]


def box(x_min: float, x_max: float, y_min: float, y_max: float) -> Array:
    """A rectangle's corners."""
    return np.array([(x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max)])


def slot_ratio(rng: Rng) -> float:
    """Slot width over car width, in [1.03, 1.6]: a tenth are 1.03, a third of the others are below 1.1."""
    return TIGHTEST if rng.random() < 0.1 else float(TIGHTEST + (WIDEST - TIGHTEST) * rng.random() ** 2)


def free_pose(
    rng: Rng,
    car: Car,
    workspace: Sequence[float],
    obstacles: Sequence[Array],
    *,
    region: Sequence[float],
    headings: Sequence[float],
    spread: float,
    room: float = 0.12,
) -> Pose:
    """A pose whose middle lies in ``region``, near one of the headings, with ``room`` (m) around the body.

    Raises:
        NoLayoutError: None was found.
    """
    shapes = [shapely.Polygon(vertices) for vertices in obstacles]
    W = shapely.Polygon(box(*workspace))
    for _ in range(60):
        theta = float(rng.choice(headings) + rng.uniform(-spread, spread))
        pose = car.centred(float(rng.uniform(*region[:2])), float(rng.uniform(*region[2:])), theta)
        if car.stands(pose, W, shapes, room):
            return pose
    raise NoLayoutError
