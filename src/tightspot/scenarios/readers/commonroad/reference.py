"""Which point of the vehicle a position in a CommonRoad file is, and the way there from the rear axle.

tightspot's poses are of the rear-axle midpoint p. CommonRoad's are of the vehicle's *centre*: the middle of its
rectangle. With c the body's centre in the rear-axle frame::

    centre = p + R(theta) c          p = centre - R(theta) c

c is the centre of the bounding box of the body's parts in the rear-axle frame, m; for CommonRoad's own vehicles that is
(b, 0), b being the distance from the rear axle to the centre of gravity by which CommonRoad's checkers convert, too.
Speed and steering angle are not converted: the kinematic single-track model ``KS`` takes both at the rear axle.
"""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem
from tightspot.vehicles import VehicleModel

Array = NDArray[np.float64]

Reference = Literal["centre", "rear-axle"]
REFERENCES: tuple[Reference, ...] = get_args(Reference)


def checked_reference(reference: str) -> Reference:
    """The name if there is such a reference point; raises :class:`InputError` with the two there are."""
    for known in REFERENCES:
        if reference == known:
            return known
    raise InputError(Problem("reference", f"{reference!r} is not known; it is {' or '.join(REFERENCES)}"))


def reference_offset(vehicle: VehicleModel, reference: Reference) -> Array:
    """c: the reference point in the rear-axle frame, m, shape (2,); zero for ``rear-axle``."""
    if reference == "rear-axle":
        return np.zeros(2)
    corners = np.vstack([part.polygon.vertices for part in vehicle.parts if part.frame == 0])
    return np.asarray((corners.min(axis=0) + corners.max(axis=0)) / 2)


def to_reference(poses: Array, offset: Array) -> Array:
    """Positions of the reference point at rear-axle poses (..., 3), m, shape (..., 2)."""
    return np.asarray(poses[..., :2] + _turned(poses[..., 2], offset))


def to_rear_axle(positions: Array, headings: Array, offset: Array) -> Array:
    """Positions of the rear axle for reference positions (..., 2) and headings (...), m, shape (..., 2)."""
    return np.asarray(positions - _turned(headings, offset))


def _turned(headings: Array, offset: Array) -> Array:
    if not offset.any():
        return np.zeros((*np.shape(headings), 2))
    cos, sin = np.cos(headings), np.sin(headings)
    return np.stack([cos * offset[0] - sin * offset[1], sin * offset[0] + cos * offset[1]], axis=-1)
