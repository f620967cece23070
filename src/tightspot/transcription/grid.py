"""The time grid: knots at fixed fractions of a horizon whose length may be free."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tightspot.errors import InputError, Problem

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TimeGrid:
    """Knots ``t_k = t_f s_k`` with fixed fractions ``0 = s_0 < ... < s_N = 1``.

    Attributes:
        fractions: (N+1,).
    """

    fractions: Array

    def __post_init__(self) -> None:
        fractions = np.array(self.fractions, float)
        fractions.setflags(write=False)
        object.__setattr__(self, "fractions", fractions)
        valid = fractions.ndim == 1 and fractions.size >= 2 and fractions[0] == 0 and fractions[-1] == 1
        if not (valid and (fractions[1:] > fractions[:-1]).all()):
            raise InputError(Problem("grid.fractions", "must increase from 0 to 1 with at least one interval"))

    @classmethod
    def uniform(cls, steps: int) -> TimeGrid:
        """N equal intervals, the paper's grid."""
        if steps < 1:
            raise InputError(Problem("steps", f"{steps} is too few; give at least 1 interval"))
        fractions = np.arange(steps + 1) * (1 / steps)  # as numpy.linspace has them
        fractions[-1] = 1.0
        fractions.setflags(write=False)
        made: TimeGrid = object.__new__(cls)
        made.__dict__["fractions"] = fractions
        return made

    @property
    def steps(self) -> int:
        """Number of intervals N."""
        return self.fractions.size - 1

    @property
    def widths(self) -> Array:
        """Fractions ``s_{k+1} - s_k`` of the intervals, (N,)."""
        return self.fractions[1:] - self.fractions[:-1]

    def split(self, intervals: ArrayLike, parts: int = 2) -> TimeGrid:
        """A grid in which each of the named intervals (0 to N - 1) is cut into ``parts`` equal ones."""
        if parts < 1:
            raise InputError(Problem("parts", f"{parts} is too few; an interval is cut into 1 or more"))
        chosen = np.atleast_1d(np.asarray(intervals, int))
        for k in chosen[(chosen < 0) | (chosen >= self.steps)]:
            raise InputError(Problem("intervals", f"{k} is not an interval of a grid of {self.steps}"))
        pieces = np.ones(self.steps, int)
        pieces[chosen] = parts
        return self.cut(pieces)

    def cut(self, pieces: ArrayLike) -> TimeGrid:
        """A grid in which interval k is cut into ``pieces[k]`` equal ones, 1 or more; ``pieces`` is (N,)."""
        counts = np.asarray(pieces, int)
        if counts.shape != (self.steps,) or (counts < 1).any():
            raise InputError(Problem("pieces", f"must be {self.steps} numbers, one an interval, 1 or more each"))
        last = counts.cumsum()
        number = np.arange(1, last[-1] + 1) - (last - counts).repeat(counts)
        fractions = np.zeros(last[-1] + 1)
        fractions[1:] = self.fractions[:-1].repeat(counts) + number * (self.widths / counts).repeat(counts)
        fractions[last] = self.fractions[1:]
        return TimeGrid(fractions)
