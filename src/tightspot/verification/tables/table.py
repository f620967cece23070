"""A trajectory as somebody's table: poses in rows, with or without times, speeds, steering angles and inputs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tightspot.errors import Problem, TableError
from tightspot.problems import shortened, shown
from tightspot.verification.tables.cells import Numbers, half_unit, numbers_of, separator_name
from tightspot.verification.tables.columns import MEANINGS, Columns, heading_of, understand
from tightspot.verification.tables.plausible import implausible, since_1970
from tightspot.verification.tables.text import MOST_ROWS, read_raw, split

Array = NDArray[np.float64]
Index = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Table:
    """Rows of a motion, in the coordinates of the scene's file, SI units and radians.

    Attributes:
        columns: Some of ``t``, ``x``, ``y``, ``theta``, ``v``, ``delta``, ``a``, ``omega``, each (M,), read-only; at
            least x and y. ``theta`` has no jumps.
        rounding: Of each column, how far its numbers may be from what was rounded when they were written.
        names: Of each column, the name in the file.
        lines: Number of each row's line in the file, (M,).
        notes: How it was read, one sentence each.
        source: Its file, for people.
    """

    columns: Mapping[str, Array]
    rounding: Mapping[str, float] = field(default_factory=dict)
    names: Mapping[str, str] = field(default_factory=dict)
    lines: Index = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    notes: tuple[str, ...] = ()
    source: str = "table"

    @property
    def rows(self) -> int:
        """Number of rows M."""
        return int(self.columns["x"].size)

    def get(self, name: str) -> Array | None:
        """A column (M,), or ``None`` if the table has none of that name."""
        return self.columns.get(name)

    @classmethod
    def from_columns(cls, columns: Mapping[Any, ArrayLike], *, source: str = "table") -> Table:
        """A table from arrays or lists by name, a pandas ``DataFrame`` for example; names as in files.

        Raises:
            TableError: With all problems.

        >>> Table.from_columns({"X [m]": [0, 1], "Y [m]": [0, 0], "yaw [deg]": [0, 45]}).columns["theta"].round(3)
        array([0.   , 0.785])
        """
        headings = understand([heading_of(str(name)) for name in columns])
        problems = list(headings.problems)
        keys = list(columns)
        arrays = {}
        for meaning, place in headings.place.items():
            try:
                arrays[meaning] = np.array(columns[keys[place]], dtype=float)
            except (TypeError, ValueError, OverflowError):
                problems.append(Problem(f"column {shown(str(keys[place]))}", "must be a list of numbers"))
        problems += _shape_problems(arrays, headings)
        if problems:
            raise TableError(shortened(problems))
        rounding = {}
        for meaning, values in arrays.items():
            texts = [repr(float(value)).removesuffix(".0") for value in values[:: max(1, values.size // 2000)]]
            scale = headings.headings[headings.place[meaning]].scale
            rounding[meaning], arrays[meaning] = half_unit(texts, values) * scale, values * scale
        lines = np.arange(1, arrays["x"].size + 1)
        return _checked(Numbers(arrays, rounding, lines, headings, ()), "row", source, ())


def read_table(path: str | Path, *, columns: Sequence[str] | None = None) -> Table:
    """Read a table of rows separated by commas, tabs, semicolons or blanks.

    Columns are found by their names, in upper or lower case, with units or without; the many names that are known are
    listed in the documentation. Comments (``#``, ``%``), blank lines, quotes, marks of byte order, a column that
    counts the rows and separators at the ends of lines are no matter.

    Args:
        path: The file.
        columns: Names of the columns in order, if the file has none or others; ``-`` leaves a column out.

    Raises:
        TableError: With every problem and its line.
    """
    raw = read_raw(Path(path))
    numbers = numbers_of(raw, columns)
    how = f"{len(numbers.lines)} rows, separated by {separator_name(raw)}s"
    return _checked(numbers, "line", str(path), (how,))


def parse_table(text: str, *, columns: Sequence[str] | None = None) -> Table:
    """:func:`read_table` for text in memory."""
    return _checked(numbers_of(split(text), columns), "line", "table", ())


def _checked(numbers: Numbers, unit: str, source: str, notes: Iterable[str]) -> Table:
    values = dict(numbers.values)
    place, headings = numbers.columns.place, numbers.columns.headings
    names = {meaning: headings[index].name for meaning, index in place.items()}
    notes = [*notes, *numbers.notes]
    if {"qz", "qw"} <= set(values) and "theta" not in values:
        values["theta"], numbers_rounding = _yaw(values), max(numbers.rounding[key] for key in ("qz", "qw"))
        rounding = {**numbers.rounding, "theta": 2 * numbers_rounding}
        names["theta"] = "orientation"
        notes.append("headings are from the quaternions")
    else:
        rounding = dict(numbers.rounding)
    if "t" in values and not headings[place["t"]].unit:
        values["t"], note = since_1970(values["t"])
        notes += note
    if "t" in values and _is_regular(values["t"]):
        rounding["t"] = float(np.spacing(np.abs(values["t"]).max()))
    kept = {key: values[key] for key in MEANINGS if key in values}
    explicit = {key for key in kept if key in place and headings[place[key]].unit}
    problems = implausible(kept, explicit, names, [f"{unit} {number}" for number in numbers.lines.tolist()])
    if numbers.lines.size > MOST_ROWS:
        problems.append(Problem(source, f"has {numbers.lines.size} rows; at most {MOST_ROWS} are read: thin it out"))
    if problems:
        raise TableError(shortened(problems))
    if "theta" in kept:
        kept["theta"] = np.unwrap(kept["theta"])
    for column in kept.values():
        column.setflags(write=False)
    frozen = MappingProxyType(kept)
    return Table(frozen, {key: rounding[key] for key in kept}, names, numbers.lines, tuple(notes), source)


def _shape_problems(arrays: Mapping[str, Array], columns: Columns) -> list[Problem]:
    problems = []
    lengths = {array.size for array in arrays.values() if array.ndim == 1}
    for meaning, array in arrays.items():
        where = f"column {shown(columns.headings[columns.place[meaning]].name)}"
        if array.ndim != 1:
            problems.append(Problem(where, f"has the shape {array.shape}; it must be one list of numbers"))
        elif not (np.abs(array) < 1e300).all():
            bad = int(np.flatnonzero(~(np.abs(array) < 1e300))[0])
            problems.append(Problem(f"row {bad + 1}, {where}", f"{array[bad]} is not a finite number"))
    if len(lengths) > 1:
        problems.append(Problem("columns", f"have different lengths: {', '.join(map(str, sorted(lengths)))}"))
    return problems


def _is_regular(t: Array) -> bool:
    """Whether all steps are the same: then the times are exact, however few digits they have."""
    steps = np.diff(t)
    return bool(steps.size and np.abs(steps - steps.mean()).max() <= 1e-9 + 8 * np.spacing(np.abs(t).max()))


def _yaw(values: Mapping[str, Array]) -> Array:
    """The heading of unit quaternions (x, y, z, w)."""
    z, w = values["qz"], values["qw"]
    x, y = (values.get(key, np.zeros_like(z)) for key in ("qx", "qy"))
    return np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
