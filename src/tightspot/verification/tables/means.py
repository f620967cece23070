"""Speed and steering angle from the poses alone: means over neighbouring stretches of 1, 2, 4, ... rows.

Where a table has no column of speeds or steering angles, the motion still has both. Its mean speed over a stretch is
the way over the time; the steering angle that belongs to the mean curvature is taken on somewhere in the stretch, as
long as the gear does not change there.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tightspot.verification.tables.steps import Steps
from tightspot.verification.tables.windows import running

Array = NDArray[np.float64]
Index = NDArray[np.intp]

_LONG_ENOUGH = 10.0
"""A stretch tells its curvature if it is so many times longer than rounding, ..."""
_SHORTEST = 0.02
"""... and longer than this, m."""


class Change(NamedTuple):
    """How a quantity differs between neighbouring stretches; every entry has shape (K,), K > 0.

    Attributes:
        value: Second minus first.
        blur: What sampling and rounding may have added to it.
        time: The longest time in which it may have changed so, s.
        row: The row between the stretches.
    """

    value: Array
    blur: Array
    time: Array
    row: Array


def speed_changes(steps: Steps, h: Array) -> Iterator[Change]:
    """Changes of the mean speed, m/s. If v changes at most by a in a second, they are at most a (T1 + T2) / 2."""
    way, time = running(steps.along), running(h)
    xy = np.sqrt(2) * steps.xy
    error = running(steps.along_error + xy * np.abs(steps.turn))
    for first, middle, last in _neighbours(h.size):
        T1, T2 = time[middle] - time[first], time[last] - time[middle]
        value = (way[last] - way[middle]) / T2 - (way[middle] - way[first]) / T1
        blur = (error[middle] - error[first] + 2 * xy) / T1 + (error[last] - error[middle] + 2 * xy) / T2 + 1e-6
        blur += 2 * steps.rounding("t") * np.abs(way[last] - way[first]) / (T1 * T2)
        yield Change(value, blur, 0.5 * (T1 + T2), middle.astype(float))


def steering_changes(steps: Steps, h: Array) -> Iterator[Change]:
    """Changes of the tangent of the steering angle, L times the mean curvature.

    Mean curvatures are weighted by the way. If a function changes at most by F in a second, its weighted means over two
    stretches, one after the other, differ by at most F times the time between the weights' centres. Here F is
    omega / cos(delta)^2 for the largest steering angle that may occur on both; the cosine is counted in
    :attr:`Change.time`.
    """
    way, turn, time = running(steps.along), running(steps.turn), running(h)
    moment = running(steps.along * 0.5 * (time[1:] + time[:-1]))
    xy, L, limits = np.sqrt(2) * steps.xy, steps.vehicle.wheelbase, steps.vehicle.limits
    error = running(steps.along_error + xy * np.abs(steps.turn))
    gears = running(np.where(steps.hidden > 0, 0.0, np.sign(steps.along)))
    for first, middle, last in _neighbours(h.size):
        one_gear = np.abs(gears[last] - gears[first]) == last - first
        shorter = np.minimum(np.abs(way[middle] - way[first]), np.abs(way[last] - way[middle]))
        chosen = one_gear & (shorter > max(_SHORTEST, _LONG_ENOUGH * xy))
        first, middle, last = (rows[chosen] for rows in (first, middle, last))
        if not first.size:
            continue
        tangent, centre, blur = [], [], np.full(first.size, 1e-3)
        for a, b in ((first, middle), (middle, last)):
            length = np.abs(way[b] - way[a])
            tangent.append(L * (turn[b] - turn[a]) / (way[b] - way[a]))
            centre.append((moment[b] - moment[a]) / (way[b] - way[a]))
            blur += (L * 2 * steps.rounding("theta") + np.abs(tangent[-1]) * (2 * xy + error[b] - error[a])) / length
        # Within an interval the centre may be anywhere.
        between = np.minimum(centre[1] - centre[0] + 0.5 * (h[first] + h[last - 1]), time[last] - time[first])
        angle = np.arctan(np.maximum(np.abs(tangent[0]), np.abs(tangent[1])))
        largest = np.minimum(angle + limits.steering_rate * (time[last] - time[first]), max(limits.steering, 1.2))
        yield Change(tangent[1] - tangent[0], blur, between / np.cos(largest) ** 2, middle.astype(float))


def _neighbours(count: int) -> Iterator[tuple[Index, Index, Index]]:
    """First, middle and last rows of all pairs of neighbouring stretches of 1, 2, 4, ... intervals."""
    length = 1
    while 2 * length <= count:
        first = np.arange(count - 2 * length + 1, dtype=np.intp)
        yield first, first + length, first + 2 * length
        length *= 2
