"""Rows of a campaign in a JSONL file: each is kept as it comes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any


def read_rows(path: Path) -> dict[int, dict[str, Any]]:
    """The rows in the file by index; a last line that was cut off is left out."""
    rows = {}
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else []:
        try:
            row = json.loads(line)
        except json.JSONDecodeError:
            continue
        rows[int(row["index"])] = row
    return rows


def append_row(path: Path, row: dict[str, Any]) -> None:
    """Add a row as a line of its own, whatever the file ends with."""
    with path.open("a+b") as file:
        file.seek(0, 2)
        if file.tell():
            file.seek(-1, 2)
            cut = file.read(1) != b"\n"
        else:
            cut = False
        file.write((b"\n" if cut else b"") + json.dumps(row, allow_nan=False).encode() + b"\n")
