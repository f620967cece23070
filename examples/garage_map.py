"""A garage as a robot maps it: walls, pillars, parked cars seen from outside only, ragged edges and specks.

python examples/garage_map.py garage-map
tightspot plan garage-map/garage.yaml
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray

FREE, UNKNOWN, OCCUPIED = 254, 205, 0
COLUMNS, ROWS = 400, 300


@dataclass(frozen=True)
class GarageMap:
    """A picture (its first row on top), and poses in the plane of the map file."""

    picture: NDArray[np.uint8]
    resolution: float
    origin: tuple[float, float, float]
    start: tuple[float, float, float]
    goal: tuple[float, float, float]

    @property
    def occupied(self) -> NDArray[np.bool_]:
        """The cells that are black or unknown, the first row at the bottom."""
        return (self.picture != FREE)[::-1]

    def corners(self, rows: NDArray[np.intp], columns: NDArray[np.intp]) -> NDArray[np.float64]:
        """The corners of cells in the plane, (n, 4, 2): p = origin + R(yaw) (column, row) * resolution."""
        x, y, yaw = self.origin
        square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
        local = (np.stack([columns, rows], axis=-1)[:, None] + square) * self.resolution
        turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
        return (x, y) + local @ turn.T

    def write(self, directory: Path, name: str = "garage", *, ends: bool = False) -> Path:
        """A PGM picture and its YAML file, with start and goal in it if they are asked for; returns the latter."""
        rows, columns = self.picture.shape
        header = f"P5\n# made for a test\n{columns} {rows}\n255\n".encode()
        (directory / f"{name}.pgm").write_bytes(header + self.picture.tobytes())
        path = directory / f"{name}.yaml"
        keys: dict[str, object] = {
            "image": f"{name}.pgm",
            "resolution": self.resolution,
            "origin": list(self.origin),
            "negate": 0,
            "occupied_thresh": 0.65,
            "free_thresh": 0.196,
        }
        if ends:
            poses = {key: dict(zip(("x", "y", "theta"), getattr(self, key), strict=True)) for key in ("start", "goal")}
            keys["tightspot"] = {**poses, "vehicle": "tpcap", "margin": 0.02}
        path.write_text(yaml.safe_dump(keys, sort_keys=False))
        return path


def garage(
    resolution: float = 0.1,
    turned: float = 0.0,
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
    seed: int = 0,
    noise: bool = True,
) -> GarageMap:
    """A garage of 34 m x 24 m in a map of 40 m x 30 m; one bay between parked cars is the goal.

    Args:
        resolution: Side of a cell, m.
        turned: Angle of the garage against the map's rows, rad.
        origin: Pose of the map's lower left corner.
        seed: Of the noise.
        noise: Whether edges are ragged and specks lie about.
    """
    rng = np.random.default_rng(seed)
    size = np.array([COLUMNS, ROWS]) * resolution
    X, Y = np.meshgrid((np.arange(COLUMNS) + 0.5) * resolution, (np.arange(ROWS) + 0.5) * resolution)
    cos, sin = np.cos(turned), np.sin(turned)
    x = cos * (X - size[0] / 2) + sin * (Y - size[1] / 2)
    y = -sin * (X - size[0] / 2) + cos * (Y - size[1] / 2)
    scale = 0.75 if turned else 1.0
    half_x, half_y = 17.0 * scale, 12.0 * scale

    def box(cx: float, cy: float, width: float, height: float) -> NDArray[np.bool_]:
        return (abs(x - cx) <= width / 2) & (abs(y - cy) <= height / 2)

    inside = box(0, 0, 2 * half_x, 2 * half_y)
    shell = box(0, 0, 2 * half_x + 0.6, 2 * half_y + 0.6) & ~inside
    unknown = ~(inside | shell)
    occupied = shell.copy()
    bays = np.arange(-half_x + 1.5, half_x - 1.4, 2.8)
    goal_bay = len(bays) // 2
    for k, cx in enumerate(bays):
        for side in (-1, 1):
            if (side == 1 and k == goal_bay) or rng.uniform() < 0.25:
                continue
            cy = side * (half_y - 2.8 + rng.uniform(-0.2, 0.2))
            body = box(cx + rng.uniform(-0.1, 0.1), cy, 1.8, 4.4)
            rim = body & ~box(cx, cy, 1.4, 4.0)
            occupied |= rim
            unknown |= body & ~rim
    for cx in bays[::3] + 1.4:
        for side in (-1, 1):
            occupied |= box(cx, side * (half_y - 5.6), 0.4, 0.4)
    if noise:
        beside = np.zeros_like(occupied)
        for axis in (0, 1):
            for step in (-1, 1):
                beside |= np.roll(occupied, step, axis=axis)
        occupied |= beside & (rng.uniform(size=occupied.shape) < 0.2)
        occupied &= rng.uniform(size=occupied.shape) > 0.02
        quiet = box(bays[goal_bay], half_y / 2, 2.4, half_y) | box(0, 0, 2 * half_x, 7.0)
        occupied |= (rng.uniform(size=occupied.shape) < 0.002) & inside & ~quiet
    picture = np.full((ROWS, COLUMNS), FREE, dtype=np.uint8)
    picture[unknown] = UNKNOWN
    picture[occupied] = OCCUPIED

    def pose(cx: float, cy: float, theta: float) -> tuple[float, float, float]:
        ox, oy, yaw = origin
        px, py = cos * cx - sin * cy + size[0] / 2, sin * cx + cos * cy + size[1] / 2
        return (
            float(ox + np.cos(yaw) * px - np.sin(yaw) * py),
            float(oy + np.sin(yaw) * px + np.cos(yaw) * py),
            float(theta + turned + yaw),
        )

    start, goal = pose(-half_x + 3.0, 0.0, 0.0), pose(float(bays[goal_bay]), half_y - 1.5, -np.pi / 2)
    return GarageMap(picture[::-1].copy(), resolution, origin, start, goal)


if __name__ == "__main__":
    directory = Path(sys.argv[1] if len(sys.argv) > 1 else "garage-map")
    directory.mkdir(parents=True, exist_ok=True)
    print(garage(turned=0.0, origin=(-20.0, 35.5, 0.6), seed=1).write(directory, ends=True))
