"""The checker's own arithmetic: where the body is at given times, and the lowest it comes along a normal in
between."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tightspot.trajectory import Trajectory
from tightspot.vehicles import SingleTrack, VehicleModel
from tightspot.verification.extrapolation import general_motion
from tightspot.verification.quadrature import CheckedMotion, IntegrationError, single_track_motion

Array = NDArray[np.float64]

_EPS = float(np.finfo(float).eps)


@dataclass(frozen=True, eq=False)
class Lemma:
    """The lemma of docs/certification.md, evaluated between neighbouring times of a grid.

    Attributes:
        motion: The checker's motion on the grid.
        vertices: Of each body part on the grid, m, each (K, n_V, 2).
        loss: ``P h^2 / 8`` of each body part between neighbouring times, m, each (K-1,).
        pad: What integration and rounding may have changed of n.p at each time, m, each (K,).
    """

    motion: CheckedMotion
    vertices: tuple[Array, ...]
    loss: tuple[Array, ...]
    pad: tuple[Array, ...]

    @classmethod
    def of(cls, vehicle: VehicleModel, trajectory: Trajectory, times: Array) -> Lemma:
        """For the motion of the trajectory's inputs; ``times`` must lie within the horizon.

        Raises:
            IntegrationError: See :func:`single_track_motion`.
        """
        if isinstance(vehicle, SingleTrack) and vehicle.moves_as_stated:
            motion = single_track_motion(vehicle, trajectory, times)
            frames = [motion.states[:, :3]]
            bounds = [_single_track_bounds(vehicle, trajectory, motion)]
        else:
            motion = general_motion(vehicle, trajectory, times)
            columns = vehicle.frames(list(motion.states.T), np)
            frames = [np.stack(np.broadcast_arrays(*frame), axis=1) for frame in columns]
            bounds = _stated_bounds(vehicle, trajectory, motion)
        vertices, loss, pad = [], [], []
        for part in vehicle.parts:
            corners, pose = part.polygon.vertices, frames[part.frame]
            radius = float(np.sqrt((corners**2).sum(axis=1).max()) * (1 + 4 * _EPS))
            vertices.append(_moved(corners, pose))
            loss.append(_loss(bounds[part.frame], radius, np.diff(motion.times)))
            rounding = 32 * _EPS * (np.abs(pose[:, :2]).sum(axis=1) + 2 * radius * (1 + np.abs(pose[:, 2])))
            pad.append(motion.position_error + radius * motion.heading_error + rounding)
        return cls(motion, tuple(vertices), tuple(loss), tuple(pad))

    def lowest(self, part: int, cuts: Array, normal: Array) -> Array:
        """Lower bound of n.p over the part on each interval of ``cuts``, with the interval's normal.

        Args:
            part: Index of the body part.
            cuts: Times of the grid, s, shape (M+1,), from its first to its last.
            normal: Shape (M, 2).
        """
        interval = np.searchsorted(cuts, self.motion.times[:-1], side="right") - 1
        n, V, pad = normal[interval], self.vertices[part], self.pad[part]
        at_start = (n[:, :1] * V[:-1, :, 0] + n[:, 1:] * V[:-1, :, 1]).min(axis=1) - pad[:-1]
        at_end = (n[:, :1] * V[1:, :, 0] + n[:, 1:] * V[1:, :, 1]).min(axis=1) - pad[1:]
        between = np.minimum(at_start, at_end) - self.loss[part]
        return np.asarray(np.minimum.reduceat(between, np.searchsorted(self.motion.times, cuts[:-1])))


def _moved(corners: Array, pose: Array) -> Array:
    x, y, theta = pose[:, 0, None], pose[:, 1, None], pose[:, 2, None]
    cos, sin = np.cos(theta), np.sin(theta)
    moved = np.empty((len(pose), len(corners), 2))
    moved[:, :, 0] = x + (cos * corners[:, 0] - sin * corners[:, 1])
    moved[:, :, 1] = y + (sin * corners[:, 0] + cos * corners[:, 1])
    return moved


def _loss(bounds: tuple[Array, Array, Array], radius: float, h: Array) -> Array:
    """``P h^2 / 8`` from (|T''|, |theta'|, |theta''|).

    The turning and the centripetal acceleration of a body point are perpendicular.
    """
    acceleration, yaw_rate, yaw_acceleration = bounds
    P = acceleration + radius * np.sqrt(yaw_acceleration**2 + yaw_rate**4)
    return np.asarray(P * h * h / 8 * (1 + 1e-12))


def _single_track_bounds(
    vehicle: SingleTrack, trajectory: Trajectory, motion: CheckedMotion
) -> tuple[Array, Array, Array]:
    """Largest |T''|, |theta'|, |theta''| between neighbouring times.

    ``theta' = v tan(delta) / L``, ``theta'' = (a tan(delta) + v omega / cos(delta)^2) / L`` and T'' has the
    parts a along and ``v theta'`` across the heading. v and delta are linear, so their absolute values are
    largest at an end.
    """
    k = np.searchsorted(trajectory.t, motion.times[:-1], side="right") - 1
    a, omega = np.abs(trajectory.inputs[k]).T
    grow = 1 + 64 * _EPS * (1 + trajectory.steps)
    v, delta = (grow * np.maximum(np.abs(column[:-1]), np.abs(column[1:])) for column in motion.states[:, 3:].T)
    tangent = np.tan(delta)
    yaw_rate = v * tangent / vehicle.wheelbase
    yaw_acceleration = (a * tangent + v * omega * (1 + tangent * tangent)) / vehicle.wheelbase
    return np.sqrt(a * a + (v * yaw_rate) ** 2), yaw_rate, yaw_acceleration


def _stated_bounds(
    vehicle: VehicleModel, trajectory: Trajectory, motion: CheckedMotion
) -> list[tuple[Array, Array, Array]]:
    """What the model itself says of its motion: there is no other source for an unknown model."""
    k = np.searchsorted(trajectory.t, motion.times[:-1], side="right") - 1
    stated = vehicle.motion_bounds(motion.states[:-1], motion.states[1:], trajectory.inputs[k])
    for bounds in stated:
        if not all(np.isfinite(bound).all() for bound in bounds):
            raise IntegrationError("the model bounds nothing on some interval")
    return [
        (bounds.acceleration * (1 + 1e-9), bounds.yaw_rate, bounds.yaw_acceleration * (1 + 1e-9)) for bounds in stated
    ]
