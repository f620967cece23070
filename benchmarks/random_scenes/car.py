"""What the generator must know of a vehicle: its outline, and whether it can stand somewhere."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from tightspot.vehicles import SingleTrack

Array = NDArray[np.float64]
Pose = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Car:
    """A vehicle's outline in the rear-axle frame.

    Attributes:
        name: In the catalogue.
        rear: Rear axle to rear bumper, m.
        front: Rear axle to front bumper, m.
        width: Of the widest part, m.
        wheelbase: m.
        parts: Vertices of the body's convex parts, m, each (n, 2).
        turning_radius: Of the rear axle's midpoint at full steering, m.
    """

    name: str
    rear: float
    front: float
    width: float
    wheelbase: float
    parts: tuple[Array, ...]
    turning_radius: float

    @classmethod
    def of(cls, vehicle: SingleTrack) -> Car:
        """The outline of a vehicle that is symmetric about its x axis."""
        parts = tuple(part.polygon.vertices for part in vehicle.parts)
        low, high = np.vstack(parts).min(axis=0), np.vstack(parts).max(axis=0)
        radius = vehicle.wheelbase / np.tan(vehicle.limits.steering)
        width = float(2 * max(-low[1], high[1]))
        return cls(vehicle.name, float(-low[0]), float(high[0]), width, vehicle.wheelbase, parts, float(radius))

    @property
    def length(self) -> float:
        """Bumper to bumper, m."""
        return self.rear + self.front

    @property
    def disc(self) -> float:
        """Radius of the largest disc about the rear-axle midpoint that surely lies in the outline's box, m."""
        return min(self.rear, self.width / 2)

    def centred(self, x: float, y: float, theta: float) -> Pose:
        """The pose whose outline's middle is at (x, y)."""
        ahead = (self.front - self.rear) / 2
        return x - ahead * float(np.cos(theta)), y - ahead * float(np.sin(theta)), theta

    def placed(self, pose: Pose) -> shapely.MultiPolygon:
        """The body at a pose."""
        x, y, theta = pose
        turn = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
        return shapely.MultiPolygon([shapely.Polygon(part @ turn.T + (x, y)) for part in self.parts])

    def stands(self, pose: Pose, workspace: shapely.Polygon, obstacles: Iterable[shapely.Polygon], room: float) -> bool:
        """Whether the body at the pose lies in the workspace and keeps ``room`` (m) from the obstacles."""
        body = self.placed(pose)
        return bool(workspace.contains(body)) and all(body.distance(obstacle) >= room for obstacle in obstacles)
