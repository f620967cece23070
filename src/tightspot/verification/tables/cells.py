"""From cells to columns of numbers: which column is which, and every cell that is no number."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import Problem, TableError
from tightspot.problems import shortened, shown
from tightspot.verification.tables.columns import MEANINGS, Columns, heading_of, understand
from tightspot.verification.tables.text import SEPARATORS, RawTable, number

Array = NDArray[np.float64]

INPUTS = ("a", "omega")
"""Columns whose last cell may be empty: no interval begins there."""

COARSEST = 1e-2
"""Numbers are taken to be written at least to this unit, in SI units; see :func:`half_unit`."""

_SAMPLES = 2000


@dataclass(frozen=True)
class Numbers:
    """Columns as numbers in SI units.

    Attributes:
        values: By meaning, each (M,).
        rounding: Half the unit of the last digit of each column, in SI units.
        lines: Number of each row's line, (M,).
        columns: What the columns are.
        notes: What was done beyond reading, one sentence each.
    """

    values: Mapping[str, Array]
    rounding: Mapping[str, float]
    lines: NDArray[np.intp]
    columns: Columns
    notes: tuple[str, ...]


def numbers_of(raw: RawTable, given: Sequence[str] | None) -> Numbers:
    """The numbers in a table.

    Args:
        raw: Its cells.
        given: Names of the columns if they are not to be taken from the file; ``-`` leaves one out.

    Raises:
        TableError: With all problems.
    """
    names, rows = _named(raw, given)
    units = raw.units if len(raw.units) == len(names) else [""] * len(names)
    columns = understand(
        [heading_of("-", "") if n == "-" else heading_of(n, u) for n, u in zip(names, units, strict=True)]
    )
    problems = list(columns.problems)
    fitting = [i for i, row in enumerate(rows) if len(row) == len(names)]
    for index in sorted(set(range(len(rows))) - set(fitting)):
        sentence = f"holds {len(rows[index])} values, but there are {len(names)} columns"
        problems.append(Problem(f"line {raw.lines[index]}", sentence))
    lines = np.array([raw.lines[i] for i in fitting], dtype=np.intp)
    rows = [rows[i] for i in fitting]
    values, rounding, notes = {}, {}, []
    for meaning, place in columns.place.items():
        cells = [row[place] for row in rows]
        column = _column(cells, comma=raw.decimal_comma)
        if meaning in INPUTS and len(column) > 1 and np.isnan(column[-1]) and not np.isnan(column[-2]):
            column[-1] = column[-2]
            notes.append(f"{columns.headings[place].name} of the last row is that of the row before")
        for bad in np.flatnonzero(np.isnan(column)).tolist():
            problems.append(Problem(f"line {lines[bad]}, column {shown(names[place])}", _no_number(cells[bad])))
        scale = columns.headings[place].scale
        values[meaning] = column * scale
        rounding[meaning] = half_unit(cells, column) * scale
        if scale != 1:
            unit = columns.headings[place].unit
            notes.append(f"column {shown(names[place])} was converted from {unit} to SI units")
    if problems:
        raise TableError(shortened(problems))
    notes += [f"column {shown(name)} is not used" for name in columns.ignored if name not in ("", "-")]
    notes += ["decimal commas were read"] if raw.decimal_comma else []
    return Numbers(values, rounding, lines, columns, tuple(notes))


def half_unit(cells: Sequence[str], values: Array) -> float:
    """How far a number may be from what was rounded: half the unit of the last digit.

    With S the largest number of significant digits of any cell and E the decimal exponent of the largest number, the
    unit is ``10^(E + 1 - S)``: right for a fixed number of decimals, for a fixed number of digits, and for doubles
    written in full. Round numbers tell too little, so the unit is at most 0.01.
    """
    step = max(1, len(cells) // _SAMPLES)
    digits = max((_significant(cell) for cell in cells[::step]), default=0)
    largest = float(np.abs(values).max(initial=0.0))
    if not (0 < largest < 1e300 and digits > 0):
        return 0.5 * COARSEST
    exponent = int(np.floor(np.log10(largest)))
    unit = 10.0 ** max(-300, exponent + 1 - digits)
    return 0.5 * min(max(unit, float(np.spacing(largest))), COARSEST)


def _significant(cell: str) -> int:
    mantissa = cell.lower().replace("d", "e").split("e")[0].lstrip("+-")
    return len(mantissa.replace(".", "").replace(",", "").lstrip("0"))


def _column(cells: Sequence[str], *, comma: bool) -> Array:
    """The cells as numbers, NaN where they are none."""
    if not comma and "_" not in "".join(cells):
        try:
            column = np.array(cells, dtype=float)
        except ValueError:
            pass
        else:
            if np.isfinite(column).all():
                return column
    found = (number(cell, decimal_comma=comma) for cell in cells)
    return np.array([np.nan if value is None else value for value in found], dtype=float)


def _no_number(cell: str) -> str:
    if not cell:
        return "is empty; every row needs a number"
    kind = "finite number" if cell.lower().lstrip("+-") in ("nan", "inf", "infinity") else "number"
    return f"{shown(cell)} is not a {kind}"


def _named(raw: RawTable, given: Sequence[str] | None) -> tuple[list[str], list[Sequence[str]]]:
    """Names and rows without what exporters add: an index without a name, separators at the end of the lines."""
    if not raw.rows:
        raise TableError(Problem("rows", "has names but no row of numbers"))
    rows, width = list(raw.rows), _width(raw.rows)
    names = list(given or raw.names or ())
    if not names:
        example = "x,y,theta" if width < 5 else "t,x,y,theta,v"
        sentence = f"have no names: line {raw.lines[0]} holds {width} numbers and no line before it names them"
        advice = f"add a line of names ({', '.join(MEANINGS)}) or give --columns, for example --columns {example}"
        raise TableError(Problem("columns", f"{sentence}; {advice}"))
    full = [row for row in rows if len(row) == width]
    if all(row[-1] == "" for row in full) and (width == len(names) + 1 or names[-1] == ""):
        rows, full = [row[:-1] if len(row) == width else row for row in rows], [row[:-1] for row in full]
        width -= 1
        names = names[:-1] if names[-1] == "" else names
    counting = _is_index([row[0] for row in full if row])
    if given is None and width == len(names) + 1 and counting:
        names.insert(0, "index")
    elif names[0] == "" and counting:
        names[0] = "index"
    return names, rows


def _width(rows: Sequence[Sequence[str]]) -> int:
    """The number of cells that most rows have."""
    counts = np.bincount([len(row) for row in rows]) if rows else np.zeros(1)
    return int(counts.argmax())


def _is_index(cells: Sequence[str]) -> bool:
    """Whether the cells count: whole numbers, each one more than the one before."""
    values = np.array([np.nan if value is None else value for value in map(number, cells)])
    return bool(values.size and (values == np.round(values)).all() and (np.diff(values) == 1).all())


def separator_name(raw: RawTable) -> str:
    """The separator for people."""
    return SEPARATORS[raw.separator]
