"""What is found about a table: one number against one tolerance, where it is worst, and a sentence."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot.verification.tables.table import Table

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Finding:
    """One thing that was checked.

    Attributes:
        name: For example ``side slip``.
        group: ``clearance``, ``kinematics``, ``limits``, ``start`` or ``goal``.
        passed: Whether ``value`` keeps to ``limit``; ``None`` if that cannot be judged from this table.
        sentence: The same for people, with units.
        value: What was found, ``None`` if nothing could be.
        limit: What is allowed: a lower limit in the group ``clearance``, an upper limit in all others.
        unit: Of both.
        row: Where it is worst: 0 at the first row, between rows in between; ``None`` if it is nowhere in particular.
        span: Length of the stretch on which it was summed up, in s, or in m in tables without times; ``None`` if it
            is no sum.
        source: ``column`` if the table says so itself, ``derived`` if it follows from how it moves, else empty.
    """

    name: str
    group: str
    passed: bool | None
    sentence: str
    value: float | None = None
    limit: float | None = None
    unit: str = ""
    row: float | None = None
    span: float | None = None
    source: str = ""

    def to_dict(self, place: Place) -> dict[str, Any]:
        """Plain data; what is not finite becomes ``None``. ``rate`` is the value over the span in s."""
        where = None if self.row is None else place.to_dict(self.row)
        rate = None
        if self.group == "kinematics" and place.t is not None and self.value is not None and self.span:
            rate = finite(self.value / self.span)
        numbers = {key: finite(getattr(self, key)) for key in ("value", "limit", "span")}
        plain = {key: getattr(self, key) for key in ("name", "group", "passed", "unit", "source", "sentence")}
        return {**plain, **numbers, "rate": rate, "where": where}


@dataclass(frozen=True, eq=False)
class Place:
    """Where in a table: time, length driven and line in the file of any row, whole or between two.

    Attributes:
        t: Times of the rows, s, (M,), or ``None``.
        driven: Length of the path until each row, m, (M,).
        lines: Of the rows in the file, (M,).
    """

    t: Array | None
    driven: Array
    lines: NDArray[np.intp]

    @classmethod
    def of(cls, table: Table) -> Place:
        """Places in that table."""
        steps = np.hypot(np.diff(table.columns["x"]), np.diff(table.columns["y"]))
        return cls(table.get("t"), np.concatenate([[0.0], np.cumsum(steps)]), table.lines)

    def time(self, row: float) -> float | None:
        """The time at a row, s; ``None`` in tables without."""
        return None if self.t is None else float(np.interp(row, np.arange(self.t.size), self.t))

    def length(self, row: float) -> float:
        """The length driven until a row, m."""
        return float(np.interp(row, np.arange(self.driven.size), self.driven))

    def line(self, row: float) -> int:
        """The line of the last whole row before or at it."""
        return int(self.lines[min(int(row), self.lines.size - 1)])

    def words(self, row: float) -> str:
        """``at t = 3.200 s (line 66)``."""
        time = self.time(row)
        when = f"after {self.length(row):.3f} m" if time is None else f"at t = {time:.3f} s"
        return f"{when} (line {self.line(row)})"

    def to_dict(self, row: float) -> dict[str, Any]:
        """The same as plain data."""
        return {"time": self.time(row), "length": self.length(row), "row": row, "line": self.line(row)}


def not_judged(name: str, group: str, why: str) -> Finding:
    """A check that this table does not allow."""
    return Finding(name, group, None, f"{name}: not judged, {why}")


def finite(value: float | None) -> float | None:
    """``None`` for what is not finite, which JSON cannot say."""
    return value if value is not None and np.isfinite(value) else None
