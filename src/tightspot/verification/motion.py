"""The judge's view of the moving body: where it is at given states, and how far it bulges between two.

**Lemma.** Let a line with unit normal n be given and let the input be constant on [t0, t1], h = t1 - t0. A
point p of a body part whose polygon lies within the distance rho of its frame's origin accelerates by at most
``P = acceleration + (yaw_acceleration + yaw_rate^2) rho``: it is ``p'' = T'' + theta'' R' q - theta'^2 R q``
with ``|q| <= rho``. So ``f(t) = n.p(t)`` stays above its chord minus ``P h^2 / 8``, and ::

    min over the part of n.p(t)  >=  min over its vertices of min(n.p(t0), n.p(t1))  -  P h^2 / 8

on [t0, t1]. If the obstacle part satisfies ``n.o <= s`` on its vertices, the clearance on [t0, t1] is at
least the right side minus s.

The loss shrinks with h^2, that of the usual test (separation at the middle, speed times h/2) with h. The
usual test is never needed beside it: its bound exceeds this one by at most ``P h^2 / 8``, which the next
bisection divides by four.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tightspot.verification.replay import Replay

Array = NDArray[np.float64]
Index = NDArray[np.intp]

# Relative reserve for rounding in the motion bounds; their terms are sums and products of a few doubles.
_BOUND_RESERVE = 1e-9
_ROUNDING = 64 * np.finfo(float).eps


@dataclass(frozen=True, eq=False)
class Motion:
    """A replayed motion and the body parts that ride on it.

    Attributes:
        replay: The motion.
        names: Of the body parts.
        V0: Their vertices in their frames, m, shape (n_B, n_V, 2); short polygons repeat their first vertex.
        radius: Largest distance of a vertex from the frame's origin, m, shape (n_B,).
        frame: Frame index of each part, shape (n_B,).
        pad: What each part's clearances lose to integration error and rounding, m, shape (n_B,).
    """

    replay: Replay
    names: tuple[str, ...]
    V0: Array
    radius: Array
    frame: Index
    pad: Array

    @classmethod
    def of(cls, replay: Replay, extent: float) -> Motion:
        """The motion of the replay's vehicle among things no further than ``extent`` (m) from the origin."""
        parts = replay.vehicle.parts
        radius = np.array([part.polygon.radius for part in parts])
        reach = extent + np.abs(replay.node_states[:, :2]).max() + radius
        pad = replay.position_error + replay.heading_error * radius + _ROUNDING * reach
        return cls(
            replay,
            tuple(part.name for part in parts),
            stack_padded([part.polygon.vertices for part in parts]),
            radius,
            np.array([part.frame for part in parts], dtype=np.intp),
            pad,
        )

    def poses(self, part: Index, states: Array) -> Array:
        """(x, y, theta) of the parts' frames at the states (B, n_x), shape (B, 3)."""
        frames = self.replay.vehicle.frames(list(states.T), np)
        if len(frames) == 1:
            return np.stack(frames[0], axis=-1)
        stacked = np.stack([np.stack(np.broadcast_arrays(*frame), axis=-1) for frame in frames])
        return np.asarray(stacked[self.frame[part], np.arange(part.size)])

    def vertices(self, part: Index, states: Array) -> Array:
        """Vertices of the parts at the states, m, shape (B, n_V, 2)."""
        x, y, theta = (column[:, None] for column in self.poses(part, states).T)
        cos, sin = np.cos(theta), np.sin(theta)
        V0 = self.V0[part]
        return np.stack([x + cos * V0[..., 0] - sin * V0[..., 1], y + sin * V0[..., 0] + cos * V0[..., 1]], axis=-1)

    def lowest(self, part: Index, states: Array, normal: Array) -> Array:
        """``min(n.V)`` of each part at its state in its direction ``normal`` (B, 2), m, shape (B,)."""
        return np.asarray(lowest(normal, self.vertices(part, states)))

    def loss(self, part: Index, before: Array, after: Array, controls: Array, duration: Array) -> Array:
        """The lemma's ``P h^2 / 8`` for each part between two states, m, (B,); infinite if unbounded."""
        with np.errstate(over="ignore", invalid="ignore"):
            frames = self.replay.vehicle.motion_bounds(before, after, controls)
            bounds = np.stack([np.stack(np.broadcast_arrays(*frame)) for frame in frames])
            _, yaw_rate, acceleration, yaw_acceleration = bounds[self.frame[part], :, np.arange(part.size)].T
            P = acceleration + (yaw_acceleration + yaw_rate**2) * self.radius[part]
            return np.where(np.isfinite(P), P * duration**2 / 8 * (1 + _BOUND_RESERVE), np.inf)


def lowest(normal: Array, vertices: Array) -> Array:
    """``min(n.V)`` for normals (..., 2) and vertices (..., n, 2), shape (...)."""
    return np.asarray((normal[..., None, :] * vertices).sum(axis=-1).min(axis=-1))


def stack_padded(polygons: list[Array]) -> Array:
    """Vertex lists (n_i, 2) as one array (m, max n_i, 2); short ones repeat their first vertex."""
    longest = max(len(vertices) for vertices in polygons)
    return np.stack([np.concatenate([v, np.repeat(v[:1], longest - len(v), axis=0)]) for v in polygons])
