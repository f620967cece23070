"""The checker's own arithmetic: where the body is at given times, and the lowest it comes along a normal in
between.

A proof is evaluated between its own cuts and the knots, never between those of other proofs: the lemma counts
from the lower end of an interval, so that cutting an interval into shorter ones may lower what follows, by up to a
quarter of ``P h^2 / 8`` (a point that bulges as far as the lemma allows is at the middle already that far out).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tightspot.trajectory import Trajectory
from tightspot.vehicles import SingleTrack, VehicleModel
from tightspot.verification.extrapolation import general_motion
from tightspot.verification.quadrature import CheckedMotion, IntegrationError, single_track_motion

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Bounds = tuple[Array, Array, Array]
"""Largest ``|T''|``, ``|theta'|`` and ``|theta''|`` between neighbouring times, each (M-1,)."""

_EPS = float(np.finfo(float).eps)


@dataclass(frozen=True, eq=False)
class Lemma:
    """The lemma of docs/certification.md, evaluated between chosen times of a grid.

    Attributes:
        motion: The checker's motion on the grid.
        t: The knots, s, shape (N+1,).
        vertices: Of each body part on the grid, m, each (K, n_V, 2).
        pad: What integration and rounding may have changed of n.p at each time, m, each (K,).
        bounds: Of the motion between the times of the grid with the given indices, for each frame.
        frame: Of each body part.
        radius: Largest distance of each part's vertices from its frame's origin, m.
    """

    motion: CheckedMotion
    t: Array
    vertices: tuple[Array, ...]
    pad: tuple[Array, ...]
    bounds: Callable[[Index], list[Bounds]]
    frame: tuple[int, ...]
    radius: tuple[float, ...]
    _pieces: dict[bytes, _Pieces] = field(default_factory=dict)

    @classmethod
    def of(cls, vehicle: VehicleModel, trajectory: Trajectory, times: Array) -> Lemma:
        """For the motion of the trajectory's inputs; ``times`` must lie within the horizon.

        Raises:
            IntegrationError: See :func:`single_track_motion`.
        """
        if isinstance(vehicle, SingleTrack) and vehicle.moves_as_stated:
            single_track, motion = vehicle, single_track_motion(vehicle, trajectory, times)
            frames = [motion.states[:, :3]]

            def bounds(chosen: Index) -> list[Bounds]:
                return [_single_track_bounds(single_track, trajectory, motion, chosen)]
        else:
            motion = general_motion(vehicle, trajectory, times)
            columns = vehicle.frames(list(motion.states.T), np)
            frames = [np.stack(np.broadcast_arrays(*frame), axis=1) for frame in columns]

            def bounds(chosen: Index) -> list[Bounds]:
                return _stated_bounds(vehicle, trajectory, motion, chosen)

        vertices, pad, radii = [], [], []
        for part in vehicle.parts:
            corners, pose = part.polygon.vertices, frames[part.frame]
            radius = float(np.sqrt((corners**2).sum(axis=1).max()) * (1 + 4 * _EPS))
            vertices.append(_moved(corners, pose))
            rounding = 32 * _EPS * (np.abs(pose[:, :2]).sum(axis=1) + 2 * radius * (1 + np.abs(pose[:, 2])))
            pad.append(motion.position_error + radius * motion.heading_error + rounding)
            radii.append(radius)
        frame = tuple(part.frame for part in vehicle.parts)
        return cls(motion, trajectory.t, tuple(vertices), tuple(pad), bounds, frame, tuple(radii))

    def lowest(self, part: int, cuts: Array, normal: Array) -> Array:
        """Lower bound of n.p over the part on each interval of ``cuts``, with the interval's normal.

        Args:
            part: Index of the body part.
            cuts: Times of the grid, s, shape (M+1,), from its first to its last.
            normal: Shape (M, 2).

        Raises:
            IntegrationError: The model bounds nothing on some interval.
        """
        pieces = self._between(cuts)
        n, start, end = normal[pieces.interval], pieces.chosen[:-1], pieces.chosen[1:]
        V, pad = self.vertices[part], self.pad[part]
        at_start = (n[:, :1] * V[start, :, 0] + n[:, 1:] * V[start, :, 1]).min(axis=1) - pad[start]
        at_end = (n[:, :1] * V[end, :, 0] + n[:, 1:] * V[end, :, 1]).min(axis=1) - pad[end]
        between = np.minimum(at_start, at_end) - pieces.loss[part]
        return np.asarray(np.minimum.reduceat(between, pieces.first))

    def _between(self, cuts: Array) -> _Pieces:
        """The pieces between the cuts and the knots; most proofs share the cuts of others."""
        key = cuts.tobytes()
        if key not in self._pieces:
            own = np.union1d(cuts, self.t)
            chosen, interval = (
                np.searchsorted(self.motion.times, own),
                np.searchsorted(cuts, own[:-1], side="right") - 1,
            )
            bounds, h = self.bounds(chosen), np.diff(own)
            loss = tuple(_loss(bounds[f], rho, h) for f, rho in zip(self.frame, self.radius, strict=True))
            self._pieces[key] = _Pieces(chosen, interval, np.searchsorted(own, cuts[:-1]), loss)
        return self._pieces[key]


@dataclass(frozen=True, eq=False)
class _Pieces:
    """A proof's intervals, cut at the knots.

    Attributes:
        chosen: The pieces' ends as indices into the grid, shape (M'+1,).
        interval: The proof's interval in which each piece lies, shape (M',).
        first: The first piece of each of the proof's intervals, shape (M,).
        loss: ``P h^2 / 8`` of each body part on the pieces, m, each (M',).
    """

    chosen: Index
    interval: Index
    first: Index
    loss: tuple[Array, ...]


def _moved(corners: Array, pose: Array) -> Array:
    x, y, theta = pose[:, 0, None], pose[:, 1, None], pose[:, 2, None]
    cos, sin = np.cos(theta), np.sin(theta)
    moved = np.empty((len(pose), len(corners), 2))
    moved[:, :, 0] = x + (cos * corners[:, 0] - sin * corners[:, 1])
    moved[:, :, 1] = y + (sin * corners[:, 0] + cos * corners[:, 1])
    return moved


def _loss(bounds: Bounds, radius: float, h: Array) -> Array:
    """``P h^2 / 8`` from (|T''|, |theta'|, |theta''|).

    The turning and the centripetal acceleration of a body point are perpendicular.
    """
    acceleration, yaw_rate, yaw_acceleration = bounds
    P = acceleration + radius * np.sqrt(yaw_acceleration**2 + yaw_rate**4)
    return np.asarray(P * h * h / 8 * (1 + 1e-12))


def _single_track_bounds(vehicle: SingleTrack, trajectory: Trajectory, motion: CheckedMotion, chosen: Index) -> Bounds:
    """Largest |T''|, |theta'|, |theta''| between the chosen times, all knots among them.

    ``theta' = v tan(delta) / L``, ``theta'' = (a tan(delta) + v omega / cos(delta)^2) / L`` and T'' has the
    parts a along and ``v theta'`` across the heading. v and delta are linear, so their absolute values are
    largest at an end.
    """
    times, states = motion.times[chosen], motion.states[chosen]
    k = np.searchsorted(trajectory.t, times[:-1], side="right") - 1
    a, omega = np.abs(trajectory.inputs[k]).T
    grow = 1 + 64 * _EPS * (1 + trajectory.steps)
    v, delta = (grow * np.maximum(np.abs(column[:-1]), np.abs(column[1:])) for column in states[:, 3:].T)
    tangent = np.tan(delta)
    yaw_rate = v * tangent / vehicle.wheelbase
    yaw_acceleration = (a * tangent + v * omega * (1 + tangent * tangent)) / vehicle.wheelbase
    return np.sqrt(a * a + (v * yaw_rate) ** 2), yaw_rate, yaw_acceleration


def _stated_bounds(vehicle: VehicleModel, trajectory: Trajectory, motion: CheckedMotion, chosen: Index) -> list[Bounds]:
    """What the model itself says of its motion: there is no other source for an unknown model."""
    times, states = motion.times[chosen], motion.states[chosen]
    k = np.searchsorted(trajectory.t, times[:-1], side="right") - 1
    stated = vehicle.motion_bounds(states[:-1], states[1:], trajectory.inputs[k])
    for bounds in stated:
        if not all(np.isfinite(bound).all() for bound in bounds):
            raise IntegrationError("the model bounds nothing on some interval")
    return [
        (bounds.acceleration * (1 + 1e-9), bounds.yaw_rate, bounds.yaw_acceleration * (1 + 1e-9)) for bounds in stated
    ]
