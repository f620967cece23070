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

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tightspot.vehicles import SingleTrack, VehicleModel
from tightspot.verification import compiled
from tightspot.verification.replay import Replay

if TYPE_CHECKING:
    from tightspot.verification.compiled import Body

Array = NDArray[np.float64]
Index = NDArray[np.intp]

# Relative reserve for rounding in the motion bounds; their terms are sums and products of a few doubles.
BOUND_RESERVE = 1e-9
ROUNDING = 64 * np.finfo(float).eps


@dataclass(frozen=True, eq=False)
class Motion(ABC):
    """Body parts that ride on a motion, as the cover sees them.

    Attributes:
        vehicle: Whose parts and frames they are.
        names: Of the body parts.
        V0: Their vertices in their frames, m, shape (n_B, n_V, 2); short polygons repeat their first vertex.
        radius: Largest distance of a vertex from the frame's origin, m, shape (n_B,).
        frame: Frame index of each part, shape (n_B,).
        pad: What each part's clearances lose to integration error and rounding, m, shape (n_B,).
    """

    vehicle: VehicleModel
    names: tuple[str, ...]
    V0: Array
    radius: Array
    frame: Index
    pad: Array

    @property
    def body(self) -> Body | None:
        """The same in the compiled core, if that knows this kind of motion."""
        return None

    @property
    @abstractmethod
    def t(self) -> Array:
        """Knots, ascending, shape (N+1,): times in s, or another parameter of the motion."""

    @property
    @abstractmethod
    def knots(self) -> Array:
        """States at the knots, shape (N+1, n_x)."""

    @abstractmethod
    def at(self, times: Array) -> Array:
        """States at ``times`` (...), shape (..., n_x)."""

    @abstractmethod
    def loss(self, part: Index, interval: Index, before: Array, after: Array, duration: Array) -> Array:
        """The lemma's ``P h^2 / 8`` for each part between two states of one interval between knots, m, (B,).

        Args:
            part: Shape (B,).
            interval: Index of the interval, shape (B,).
            before: States at the beginning, shape (B, n_x).
            after: States at the end, shape (B, n_x).
            duration: h, shape (B,).

        Returns:
            Infinite where nothing is bounded.
        """

    def poses(self, part: Index, states: Array) -> Array:
        """(x, y, theta) of the parts' frames at the states (B, n_x), shape (B, 3)."""
        frames = self.vehicle.frames(list(states.T), np)
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


@dataclass(frozen=True, eq=False)
class ReplayedMotion(Motion):
    """The motion of inputs that are constant between the knots; times are in s.

    Attributes:
        replay: Its integration.
    """

    replay: Replay

    @classmethod
    def of(cls, replay: Replay, extent: float) -> ReplayedMotion:
        """The motion of the replay's vehicle among things no further than ``extent`` (m) from the origin."""
        names, V0, radius, frame = parts_of(replay.vehicle)
        reach = extent + np.abs(replay.extremes[:, :2]).max() + radius
        pad = replay.position_error + replay.heading_error * radius + ROUNDING * reach
        return cls(replay.vehicle, names, V0, radius, frame, pad, replay)

    @cached_property
    def body(self) -> Body | None:
        """The same in the compiled core, if that knows the model."""
        core, vehicle = self.replay.core, self.vehicle
        if core is None or not isinstance(vehicle, SingleTrack):
            return None
        return compiled.body_on(core, vehicle, self.radius, self.pad, BOUND_RESERVE)

    @property
    def t(self) -> Array:
        return self.replay.trajectory.t

    @property
    def knots(self) -> Array:
        return self.replay.knots

    def at(self, times: Array) -> Array:
        return self.replay.at(times)

    def loss(self, part: Index, interval: Index, before: Array, after: Array, duration: Array) -> Array:
        controls = self.replay.trajectory.inputs[interval]
        with np.errstate(over="ignore", invalid="ignore"):
            frames = self.vehicle.motion_bounds(before, after, controls)
            bounds = np.stack([np.stack(np.broadcast_arrays(*frame)) for frame in frames])
            _, yaw_rate, acceleration, yaw_acceleration = bounds[self.frame[part], :, np.arange(part.size)].T
            P = acceleration + (yaw_acceleration + yaw_rate**2) * self.radius[part]
            return np.where(np.isfinite(P), P * duration**2 / 8 * (1 + BOUND_RESERVE), np.inf)


def parts_of(vehicle: VehicleModel) -> tuple[tuple[str, ...], Array, Array, Index]:
    """Names, padded vertices, radii and frames of the body parts, see :class:`Motion`."""
    parts = vehicle.parts
    radius = np.array([part.polygon.radius for part in parts])
    frame = np.array([part.frame for part in parts], dtype=np.intp)
    return tuple(part.name for part in parts), stack_padded([part.polygon.vertices for part in parts]), radius, frame


def lowest(normal: Array, vertices: Array) -> Array:
    """``min(n.V)`` for normals (..., 2) and vertices (..., n, 2), shape (...)."""
    return np.asarray((normal[..., None, :] * vertices).sum(axis=-1).min(axis=-1))


def stack_padded(polygons: list[Array]) -> Array:
    """Vertex lists (n_i, 2) as one array (m, max n_i, 2); short ones repeat their first vertex."""
    longest = max(len(vertices) for vertices in polygons)
    if all(len(vertices) == longest for vertices in polygons):
        return np.array(polygons)
    return np.stack([np.concatenate([v, np.repeat(v[:1], longest - len(v), axis=0)]) for v in polygons])
