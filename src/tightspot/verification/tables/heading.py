"""Headings of a table that has none: the direction of motion, forward or in reverse."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import Problem, TableError

Array = NDArray[np.float64]

SHORTEST = 0.01
"""Rows closer than this to the last one that counted, m, do not tell a direction, ..."""
ROUNDINGS = 100.0
"""... nor rows closer than so many times their rounding."""
_UNDECIDED = np.radians(20)


def shortest_step(rounding: float) -> float:
    """Positions closer than this, m, do not tell a direction if they are off by ``rounding`` (m)."""
    return max(SHORTEST, ROUNDINGS * rounding)


def headings(x: Array, y: Array, start: float, rounding: float) -> Array:
    """Headings of a vehicle that drives through the points, shape (M,), rad, without jumps.

    Where the way turns back by more than a right angle, the gear changes and the heading goes on. The first gear is the
    one in which the heading agrees with the scene's. Between three points the heading is that of the circle through
    them, at the ends of a leg that of the circle's tangent.

    Args:
        x: m, shape (M,).
        y: m, shape (M,).
        start: The heading at the beginning, to choose the first gear by, rad.
        rounding: How far a position may be from what was rounded, m.

    Raises:
        TableError: Nothing moves, or the vehicle would start sideways.
    """
    kept = _apart(x, y, shortest_step(rounding))
    if kept.size < 2:
        sentence = f"is missing, and no two positions are {shortest_step(rounding):.2g} m apart, as it takes to tell it"
        raise TableError(Problem("column theta", f"{sentence}; give the headings"))
    direction = np.arctan2(np.diff(y[kept]), np.diff(x[kept]))
    length = np.hypot(np.diff(y[kept]), np.diff(x[kept]))
    away = _wrapped(direction[0] - start)
    if abs(abs(away) - np.pi / 2) < _UNDECIDED:
        sentence = f"is missing, and the way begins {abs(np.degrees(away)):.0f} deg off the scene's heading"
        raise TableError(Problem("column theta", f"{sentence}: forward or reverse cannot be told; give the headings"))
    # Each step's heading is its direction or the opposite, whichever is nearer to the one before.
    along = np.empty_like(direction)
    heading = start
    for k, way in enumerate(direction.tolist()):
        offset = _wrapped(way - heading)
        heading += offset if abs(offset) <= np.pi / 2 else offset - np.copysign(np.pi, offset)
        along[k] = heading
    reverse = np.cos(along - direction) < 0
    at_points = _at_points(along, length, reverse)
    driven = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    return np.asarray(np.interp(driven, driven[kept], at_points), dtype=float)


def _apart(x: Array, y: Array, shortest: float) -> NDArray[np.intp]:
    """Rows that are far enough from the one before; the last row takes the place of the last of them."""
    kept = [0]
    for k in range(1, x.size):
        if np.hypot(x[k] - x[kept[-1]], y[k] - y[kept[-1]]) >= shortest:
            kept.append(k)
    if len(kept) > 1:
        kept[-1] = x.size - 1 if np.hypot(x[-1] - x[kept[-1]], y[-1] - y[kept[-1]]) > 0 else kept[-1]
    return np.array(kept, dtype=np.intp)


def _at_points(along: Array, length: Array, reverse: NDArray[np.bool_]) -> Array:
    """Headings at the points from those of the steps between them."""
    found = np.empty(along.size + 1)
    weighted = (along[1:] * length[:-1] + along[:-1] * length[1:]) / (length[1:] + length[:-1])
    found[1:-1] = weighted
    cusps = np.flatnonzero(reverse[1:] != reverse[:-1])
    found[0] = 2 * along[0] - found[1] if along.size > 1 and not (cusps == 0).any() else along[0]
    found[-1] = 2 * along[-1] - found[-2] if along.size > 1 and not (cusps == along.size - 2).any() else along[-1]
    for k in cusps.tolist():
        before = 2 * along[k] - found[k] if k > 0 and not (cusps == k - 1).any() else along[k]
        found[k + 1] = before
    for k in cusps.tolist():
        after = 2 * along[k + 1] - found[k + 2] if k + 2 < found.size else along[k + 1]
        found[k + 1] = 0.5 * (found[k + 1] + after)
    return found


def _wrapped(angle: float) -> float:
    return float(np.remainder(angle + np.pi, 2 * np.pi) - np.pi)
