"""Why a table may be inconsistent: what other people's tables most often do differently."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tightspot.verification.tables.steps import Steps

Array = NDArray[np.float64]

_EXPLAINED = 0.15
"""A reason counts if it leaves less than this share of the slip."""
_NEAREST_POINT = 0.2
_SHORTEST_WHEELBASE = 0.1


def slip_hint(steps: Steps) -> str:
    """What would explain motion across the heading, as the end of a sentence; empty if nothing simple does."""
    total = float(np.abs(steps.across).sum())
    turning = float((steps.turn**2).sum())
    if turning > 1e-9:
        # A point at the distance d ahead of the rear axle moves sideways by d dtheta.
        ahead = float((steps.across * steps.turn).sum()) / turning
        if abs(ahead) > _NEAREST_POINT and _rest(steps.across - ahead * steps.turn, total):
            where = "ahead of" if ahead > 0 else "behind"
            return f"; it fits a point {abs(ahead):.2f} m {where} the rear axle: positions must be of its midpoint"
    for sign, row in ((1.0, "before"), (-1.0, "after")):
        # Euler's rule steps along the heading at one end, which is half the turn away from the mean.
        if _rest(steps.across + 0.5 * sign * steps.turn * steps.along, total):
            return f"; the steps follow the heading of the row {row} (Euler's rule): integrate in smaller steps"
    moved = np.abs(steps.along).sum()
    offset = float((steps.across * np.sign(steps.along)).sum() / moved) if moved > 0 else 0.0
    if _rest(steps.across - offset * steps.along, total):
        return f"; the heading is off by {np.degrees(np.arctan(offset)):.2f} deg throughout"
    return ""


def speed_hint(steps: Steps) -> str:
    """What would explain speeds that do not fit the motion."""
    v, h = steps.table.columns["v"], steps.h
    if h is None:
        return ""
    mean = 0.5 * (v[1:] + v[:-1]) * h
    total = float(np.abs(steps.along - mean).sum())
    if (v >= 0).all() and (steps.along < 0).any() and _rest(np.abs(steps.along) - mean, total):
        return "; speeds must be negative in reverse"
    if _rest(steps.along + mean, total):
        return "; the speed has the wrong sign throughout, or headings point backwards"
    if _rest(3.6 * steps.along - mean, total):
        return "; the speeds look like km/h: write the unit, for example v [km/h]"
    return ""


def steering_hint(steps: Steps) -> str:
    """What would explain steering angles that do not fit the turns."""
    tan = np.tan(steps.table.columns["delta"])
    turned = 0.5 * steps.along * (tan[1:] + tan[:-1])  # times the wheelbase
    squares, own = float((steps.turn**2).sum()), steps.vehicle.wheelbase
    total = float(np.abs(steps.turn - turned / own).sum())
    wheelbase = float((turned * steps.turn).sum()) / squares if squares > 0 else 0.0
    if abs(wheelbase) < _SHORTEST_WHEELBASE or not _rest(steps.turn - turned / wheelbase, total):
        return ""
    if wheelbase < 0:
        return "; steering angles must be positive to the left"
    return f"; they fit a wheelbase of {wheelbase:.2f} m, the vehicle has {own:.2f} m"


def _rest(rest: Array, total: float) -> bool:
    return float(np.abs(rest).sum()) < _EXPLAINED * total
