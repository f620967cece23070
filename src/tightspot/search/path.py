"""Paths of a car: arcs of constant curvature, and the poses along them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tightspot.errors import InputError, Problem
from tightspot.search.core import compiled_core

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Path:
    """A path from a start pose to a goal pose without times.

    Attributes:
        poses: (x m, y m, theta rad) of the rear-axle midpoint along the path, shape (n, 3). The heading is
            continuous: it is not wrapped, and the last equals the goal's modulo 2 pi.
        curvature: Of the arc that leads to each pose, 1/m, positive to the left, shape (n,); the first entry
            is that of the first arc.
        gear: +1 or -1 of the arc that leads to each pose, shape (n,).
        arcs: Signed length (negative in reverse) in m and curvature in 1/m of each arc, shape (m, 2).
    """

    poses: Array
    curvature: Array
    gear: NDArray[np.int64]
    arcs: Array

    @cached_property
    def length(self) -> float:
        """Way of the rear-axle midpoint, m."""
        return float(np.abs(self.arcs[:, 0]).sum())

    @cached_property
    def gear_changes(self) -> int:
        """How often the direction of travel changes."""
        gears = np.sign(self.arcs[:, 0])
        return int(np.count_nonzero(gears[1:] != gears[:-1]))

    @classmethod
    def from_arcs(cls, start: ArrayLike, arcs: ArrayLike, spacing: float = 0.1, goal: ArrayLike | None = None) -> Path:
        """Samples of the arcs driven one after the other from ``start``, at most ``spacing`` m apart.

        Args:
            start: Pose, shape (3,).
            arcs: Signed lengths and curvatures, shape (m, 2).
            spacing: m; the ends of every arc are among the samples.
            goal: Pose that the arcs are known to reach; the last sample is set to it exactly (its heading to
                the equivalent angle nearest the path's), which removes rounding.
        """
        if not (math.isfinite(spacing) and spacing > 0):
            raise InputError(Problem("spacing", f"{spacing} m must be a positive, finite distance"))
        arcs = np.ascontiguousarray(arcs, dtype=float).reshape(-1, 2)
        samples = compiled_core().sample_arcs(pose_of(start, "start"), arcs, float(spacing))
        poses = samples[:, :3].copy()
        if goal is not None:
            x, y, theta = pose_of(goal, "goal")
            poses[-1] = x, y, theta + 2 * np.pi * round((poses[-1, 2] - theta) / (2 * np.pi))
        return cls(poses, samples[:, 3].copy(), samples[:, 4].astype(np.int64), arcs)


def pose_of(value: ArrayLike, name: str) -> Array:
    """Three finite numbers as an array; raises :class:`InputError` naming the argument."""
    pose = np.ascontiguousarray(value, dtype=float)
    if pose.shape != (3,) or not all(map(math.isfinite, pose.tolist())):
        raise InputError(Problem(name, f"{value!r} is not a pose; give three finite numbers (x m, y m, theta rad)"))
    return pose
