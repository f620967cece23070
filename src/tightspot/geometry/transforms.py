"""Rigid motions of the plane and angles."""

from __future__ import annotations

from typing import overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def rotation(theta: ArrayLike) -> Array:
    """``R(theta) = [[cos, -sin], [sin, cos]]`` for angles (...) in rad, shape (..., 2, 2)."""
    theta = np.asarray(theta, dtype=float)
    cos, sin = np.cos(theta), np.sin(theta)
    return np.stack([np.stack([cos, -sin], axis=-1), np.stack([sin, cos], axis=-1)], axis=-2)


def transform(points: ArrayLike, poses: ArrayLike) -> Array:
    """``V = R(theta) V0 + T``: points fixed to a frame, at many poses of the frame.

    Args:
        points: In the frame's coordinates, m, shape (n, 2).
        poses: (x m, y m, theta rad), shape (..., 3).

    Returns:
        Points in the plane's coordinates, m, shape (..., n, 2).
    """
    points, poses = np.asarray(points, dtype=float), np.asarray(poses, dtype=float)
    x, y, theta = poses[..., 0, None], poses[..., 1, None], poses[..., 2, None]
    cos, sin = np.cos(theta), np.sin(theta)
    out = np.empty(poses.shape[:-1] + points.shape)
    out[..., 0] = cos * points[:, 0] - sin * points[:, 1] + x
    out[..., 1] = sin * points[:, 0] + cos * points[:, 1] + y
    return out


@overload
def wrap_angle(angle: float) -> float: ...
@overload
def wrap_angle(angle: ArrayLike) -> Array: ...
def wrap_angle(angle: ArrayLike) -> Array | float:
    """``angle + 2 pi k`` in (-pi, pi], rad; angles already there come back unchanged."""
    angle = np.asarray(angle, dtype=float)
    wrapped = angle - 2 * np.pi * np.ceil((angle - np.pi) / (2 * np.pi))
    wrapped = np.where((-np.pi < wrapped) & (wrapped <= np.pi), wrapped, np.pi)
    return np.asarray(np.where((-np.pi < angle) & (angle <= np.pi), angle, wrapped))[()]


@overload
def nearest_angle(angle: float, reference: float) -> float: ...
@overload
def nearest_angle(angle: ArrayLike, reference: ArrayLike) -> Array: ...
def nearest_angle(angle: ArrayLike, reference: ArrayLike) -> Array | float:
    """``angle + 2 pi k`` with the integer k that brings it nearest to the reference, rad."""
    if isinstance(angle, float) and isinstance(reference, float):
        return float(angle - 2 * np.pi * np.rint((angle - reference) / (2 * np.pi)))
    angle, reference = np.asarray(angle, dtype=float), np.asarray(reference, dtype=float)
    return np.asarray(angle - 2 * np.pi * np.round((angle - reference) / (2 * np.pi)))[()]


def seen_from(poses: ArrayLike, frames: ArrayLike) -> Array:
    """Poses (..., 3) in the coordinates of frames whose own poses are (..., 3): ``(R' (p - p_o), theta - theta_o)``.

    >>> seen_from([1.0, 1.0, 0.5], [1.0, 0.0, np.pi / 2]).round(2).tolist()
    [1.0, 0.0, -1.07]
    """
    poses, frames = np.asarray(poses, dtype=float), np.asarray(frames, dtype=float)
    dx, dy, turn = np.moveaxis(poses - frames, -1, 0)
    cos, sin = np.cos(frames[..., 2]), np.sin(frames[..., 2])
    return np.stack([cos * dx + sin * dy, cos * dy - sin * dx, turn], axis=-1)
