"""Sums over stretches of a table: the stretch that breaks its tolerance most, among all lengths 1, 2, 4, ... rows.

Numbers that are rounded or sampled may be off by much at a single row and by little over many; a lasting error is the
other way round. Looking at all lengths finds both.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Stretch(NamedTuple):
    """A stretch of rows and what was found on it.

    Attributes:
        first: Its first row.
        last: Its last row.
        value: The sum.
        limit: What was allowed.
    """

    first: int
    last: int
    value: float
    limit: float

    @property
    def ratio(self) -> float:
        """Value over limit: above 1 the tolerance is broken."""
        return self.value / self.limit

    @property
    def middle(self) -> float:
        """The row in its middle."""
        return 0.5 * (self.first + self.last)


def lengths(count: int) -> Iterator[int]:
    """1, 2, 4, ... and ``count`` itself."""
    length = 1
    while length < count:
        yield length
        length *= 2
    yield count


def worst_sum(change: Array, allowance: Array, ends: float) -> Stretch:
    """The stretch with the largest sum of ``change`` over the sum of ``allowance`` plus ``ends``.

    Args:
        change: One number for each interval between rows, shape (N,), N > 0.
        allowance: What it may be, 0 or more, shape (N,).
        ends: What its two ends may add, above 0.
    """
    return max(_sums(change, allowance, ends), key=lambda stretch: stretch.ratio)


def worst_absolute_sum(change: Array, allowance: Array, ends: float) -> Stretch:
    """:func:`worst_sum` of the absolute value of the sum."""
    return max((worst_sum(sign * change, allowance, ends) for sign in (1.0, -1.0)), key=lambda stretch: stretch.ratio)


def _sums(change: Array, allowance: Array, ends: float) -> Iterator[Stretch]:
    totals, allowed = running(change), running(allowance)
    for length in lengths(change.size):
        value = totals[length:] - totals[:-length]
        limit = allowed[length:] - allowed[:-length] + ends
        first = int((value / limit).argmax())
        yield Stretch(first, first + length, float(value[first]), float(limit[first]))


def running(values: Array) -> Array:
    """Sums of the first 0, 1, 2, ... values, shape (N+1,)."""
    return np.concatenate([[0.0], np.cumsum(values)])
