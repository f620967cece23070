"""The motion between the rows of a table, in two readings, as the cover wants it.

The parameter s of the motion is the row: 0 at the first, k at the k-th, k + 1/2 midway to the next. Between two rows
the heading turns evenly, theta(s) is linear. The position of the rear-axle midpoint

- **as interpolated** runs straight: x(s) and y(s) are linear. A body point at the distance rho then has
  ``p'' = -theta'^2 R q``, so that on a piece that turns by dtheta in all
  ``P h^2 = rho dtheta^2`` in the lemma of :mod:`tightspot.verification.motion`;
- **on arcs** runs on the circular arc through both positions that turns by the same angle as the heading: what a
  vehicle does at a constant speed and steering angle. With the arc's length l
  ``P h^2 = l |dtheta| + rho dtheta^2``.

The two are nowhere further apart than the arc's sagitta, ``c/2 tan(dtheta/4)`` with the chord c.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tightspot.vehicles import SingleTrack
from tightspot.verification.motion import BOUND_RESERVE, ROUNDING, Motion, parts_of

Array = NDArray[np.float64]
Index = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class RowMotion(Motion):
    """Poses in rows and the motion between them.

    Attributes:
        poses_at_rows: (x, y, theta) without jumps of theta, m and rad, shape (M, 3).
        arcs: Whether positions run on arcs.
    """

    poses_at_rows: Array
    arcs: bool

    @classmethod
    def of(cls, vehicle: SingleTrack, poses: Array, *, extent: float, arcs: bool = False) -> RowMotion:
        """The motion through the poses among things no further than ``extent`` (m) from the origin."""
        names, V0, radius, frame = parts_of(vehicle)
        reach = extent + np.abs(poses[:, :2]).max() + radius * (1 + np.abs(poses[:, 2]).max())
        return cls(vehicle, names, V0, radius, frame, ROUNDING * reach, poses, arcs)

    @property
    def t(self) -> Array:
        return np.arange(len(self.poses_at_rows), dtype=float)

    @property
    def knots(self) -> Array:
        return self.poses_at_rows

    def at(self, times: Array) -> Array:
        """Poses at the parameters ``times`` (...), shape (..., 3)."""
        poses = self.poses_at_rows
        times = np.asarray(times, dtype=float)
        k = np.clip(times.astype(np.intp), 0, len(poses) - 2)
        part = (times - k)[..., None]
        before, step = poses[k], poses[k + 1] - poses[k]
        if not self.arcs:
            return np.asarray(before + part * step)
        half = 0.5 * step[..., 2:]
        # The chord to the point at this part of the arc: its share of the whole chord, turned back.
        share = part * np.sinc(part * half / np.pi) / np.sinc(half / np.pi)
        back = (part - 1) * half
        cos, sin = share * np.cos(back), share * np.sin(back)
        dx, dy = step[..., :1], step[..., 1:2]
        return np.asarray(before + np.concatenate([cos * dx - sin * dy, sin * dx + cos * dy, part * step[..., 2:]], -1))

    def loss(self, part: Index, interval: Index, before: Array, after: Array, duration: Array) -> Array:
        turn = np.abs(after[:, 2] - before[:, 2])
        bulge = self.radius[part] * turn**2
        if self.arcs:
            bulge = bulge + arc_length(after - before) * turn
        return np.asarray(bulge / 8 * (1 + BOUND_RESERVE))


def arc_length(steps: Array) -> Array:
    """Length of the arc with the chord (dx, dy) that turns by dtheta, m; steps (..., 3), shape (...)."""
    return np.asarray(np.hypot(steps[..., 0], steps[..., 1]) / np.sinc(0.5 * steps[..., 2] / np.pi))


def sagitta(poses: Array) -> Array:
    """How far the two readings may be apart between neighbouring poses (M, 3), m, shape (M-1,)."""
    steps = np.diff(poses, axis=0)
    return np.asarray(0.5 * np.hypot(steps[:, 0], steps[:, 1]) * np.tan(0.25 * np.abs(steps[:, 2])))
