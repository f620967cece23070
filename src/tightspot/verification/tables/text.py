"""From a file's bytes to rows of cells: encoding, comments, separator, the line with the names."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tightspot.errors import Problem, SceneError, TableError
from tightspot.scenarios.readers.files import read_bytes
from tightspot.verification.tables.columns import heading_of, is_unit

MAX_BYTES = 50_000_000
MOST_ROWS = 100_000
_LONGEST_LINE = 20_000
_MOST_COLUMNS = 500

SEPARATORS = {"\t": "tab", ";": "semicolon", ",": "comma", " ": "blank"}

_CONTROLS = re.compile(rb"[\x00-\x08\x0e-\x1f]")
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eEdD][-+]?\d+)?")
_DECIMAL_COMMA = re.compile(r"[-+]?\d*,\d+([eEdD][-+]?\d+)?")
_NO_NUMBER = {"", "nan", "na", "n/a", "null", "none", "inf", "-inf", "+inf", "infinity", "-infinity"}


@dataclass(frozen=True)
class RawTable:
    """Cells as text.

    Attributes:
        names: Of the columns, ``None`` if the file has none.
        units: Of the columns, if a line of its own states them, else empty.
        rows: As many cells each as there are columns, unless a problem says otherwise.
        lines: Number of each row's line in the file, from 1.
        separator: A key of :data:`SEPARATORS`.
        decimal_comma: Whether numbers are written with a comma.
    """

    names: Sequence[str] | None
    units: Sequence[str]
    rows: Sequence[Sequence[str]]
    lines: Sequence[int]
    separator: str
    decimal_comma: bool


def read_raw(path: Path) -> RawTable:
    """The cells of a file.

    Raises:
        TableError: It cannot be read, is too large or no text.
    """
    try:
        data = read_bytes(path, MAX_BYTES)
    except SceneError as error:  # the same reader reads scenes
        raise TableError(error.problems) from None
    return split(decoded(data, str(path)), str(path))


def decoded(data: bytes, name: str) -> str:
    """The text of a file in UTF-8, in UTF-16 with its mark, as spreadsheets write it, or in Latin-1."""
    encoding = "utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError as error:
        if encoding == "utf-16" or _CONTROLS.search(data):
            sentence = f"is not text (byte {error.start}); export the table as CSV"
            raise TableError(Problem(name, sentence)) from None
        text = data.decode("latin-1")
    if "\0" in text:
        raise TableError(Problem(name, "is not text; export the table as CSV"))
    if not text.strip():
        raise TableError(Problem(name, "is empty"))
    if text.lstrip().startswith("<"):
        raise TableError(Problem(name, "is XML or HTML, not a table; export the table as CSV"))
    return text


def split(text: str, name: str = "table") -> RawTable:
    """Rows of cells.

    Blank lines and lines that begin with ``#`` or ``%`` are left out; the names may stand in such a line. The separator
    is the first of tab, semicolon, comma and blank that the first other line contains.

    Raises:
        TableError: There is nothing, too much, or a line that no table has.
    """
    lines = re.split(r"\r\n|\n|\r", text)
    if len(lines) > 2 * MOST_ROWS + 1000:
        raise _refuse(name, f"has {len(lines)} lines; at most {MOST_ROWS} rows are read: thin it out")
    comments: list[str] = []
    found: list[tuple[int, str]] = []
    for number, line in enumerate(lines, start=1):
        if len(line) > _LONGEST_LINE:
            raise _refuse(name, f"line {number} has {len(line)} characters; a table has one row a line")
        bare = line.strip()
        if bare.startswith(("#", "%")):
            comments += [] if found else [bare.lstrip("#% ")]
        elif bare:
            found.append((number, line))
    if not found:
        raise _refuse(name, "holds no row; there are only comments")
    if len(found) > MOST_ROWS + 2:
        raise _refuse(name, f"has {len(found)} rows; at most {MOST_ROWS} are read: thin it out")
    return _table(found, comments)


def number(text: str, *, decimal_comma: bool = False) -> float | None:
    """The finite number that a cell holds, ``None`` if it holds none."""
    if decimal_comma and _DECIMAL_COMMA.fullmatch(text):
        text = text.replace(",", ".")
    if not _NUMBER.fullmatch(text):
        return None
    value = float(text.replace("d", "e").replace("D", "e"))
    return value if abs(value) < 1e300 else None


def _table(found: list[tuple[int, str]], comments: Sequence[str]) -> RawTable:
    separator = _separator(found[0][1])
    if separator == "\t" and len(found) > 1 and "\t" not in found[1][1]:
        separator = " "
    cells = _cells([line for _, line in found], separator)
    numbers = [index for index, _ in found]
    named = [row for row in map(_comment_names, comments) if row is not None]
    names: Sequence[str] | None = named[-1] if named else None
    if not all(map(_numeric, cells[0])) and (names is None or len(names) != len(cells[0]) or _are_names(cells[0])):
        names, cells, numbers = cells[0], cells[1:], numbers[1:]
    units: Sequence[str] = ()
    if names is not None and cells and _are_units(cells[0]):
        units, cells, numbers = cells[0], cells[1:], numbers[1:]
    comma = separator != "," and _has_decimal_commas(cells)
    return RawTable(names, units, cells, numbers, separator, comma)


def _separator(line: str) -> str:
    return next((separator for separator in SEPARATORS if separator in line.strip(" ")), " ")


def _cells(lines: Sequence[str], separator: str) -> list[list[str]]:
    if separator == " ":
        return [_joined_units(line.split()) for line in lines]
    rows = (
        next(csv.reader([line], delimiter=separator, skipinitialspace=True)) if '"' in line else line.split(separator)
        for line in lines
    )
    return [[cell.strip() for cell in row] for row in rows]


def _joined_units(words: list[str]) -> list[str]:
    """``time [s] x [m]`` split at blanks, with the units put back to their names."""
    joined: list[str] = []
    for word in words:
        if word[:1] in "[(" and joined:
            joined[-1] += f" {word}"
        else:
            joined.append(word.strip("\"'"))
    return joined


def _numeric(cell: str) -> bool:
    return cell.lower() in _NO_NUMBER or number(cell, decimal_comma=True) is not None


def _are_units(cells: Sequence[str]) -> bool:
    written = [cell for cell in cells if cell]
    return bool(written) and all(is_unit(cell) and number(cell) is None for cell in written)


def _comment_names(comment: str) -> list[str] | None:
    """The names in a comment, if x and y are among them."""
    names = next(iter(_cells([comment], _separator(comment))), [])
    return names if len(names) <= _MOST_COLUMNS and _are_names(names) else None


def _are_names(cells: Sequence[str]) -> bool:
    return {"x", "y"} <= {heading_of(cell).meaning for cell in cells}


def _has_decimal_commas(rows: Sequence[Sequence[str]]) -> bool:
    """Whether cells of the first rows hold a comma that makes them numbers, and none has a point."""
    cells = [cell for row in rows[:50] for cell in row]
    return any(_DECIMAL_COMMA.fullmatch(cell) for cell in cells) and not any("." in cell for cell in cells)


def _refuse(name: str, sentence: str) -> TableError:
    return TableError(Problem(name, sentence))
