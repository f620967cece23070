"""Coordinates as a file had them, so that they are written back bit for bit.

On loading an offset is subtracted from coordinates that are far from the origin, and added again on writing. Both
round: 0.1 m - 20 km + 20 km is not 0.1 m. So what was read is remembered beside what it became, and written as
long as the one still follows from the other.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def in_file(points: Array, offset: ArrayLike, original: Array | None) -> Array:
    """The points' coordinates in the file: ``original`` if ``original - offset`` are the points, else their sum.

    Args:
        points: In the scenario's coordinates, m; entries may be NaN.
        offset: What was subtracted on loading; the shape must fit.
        original: In the file's coordinates, or ``None`` if that is not known.
    """
    shift = np.asarray(offset, dtype=float)
    if original is not None and np.array_equal(original - shift, points, equal_nan=True):
        return original
    return np.asarray(points + shift)


def read_only(points: ArrayLike) -> Array:
    """A copy that cannot be changed."""
    array = np.array(points, dtype=float)
    array.setflags(write=False)
    return array
