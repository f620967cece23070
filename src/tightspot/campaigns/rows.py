"""Rows of a campaign and the file that keeps them: one JSON object a line, so that an interruption loses nothing."""

from __future__ import annotations

import csv
import io
import json
import os
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from tightspot.errors import InputError, Problem
from tightspot.files import atomic_write
from tightspot.trajectory import Trajectory


@dataclass(frozen=True)
class Row:
    """What one scenario, method and guess gave. ``None`` where there is no such number.

    Attributes:
        key: Unique in its campaign.
        scene: Built-in scene.
        method: Key of :data:`tightspot.campaigns.methods.METHODS`.
        guess: Name, or ``start 12`` of a multi-start.
        status: Of the solve, or ``NO_GUESS``.
        VN: Variables.
        CN: The paper's number of constraints.
        objective: J.
        final_time: t_f, s.
        effort: TS = sum of a^2 + omega^2.
        iterations: Of the solver.
        seconds: Median of the solver's time, s, without building.
        runs: How many times it was solved.
        certified: The judge's word at margin 0.
        penetration: Deepest overlap with an obstacle at any time, m.
        verdict: The judge's sentence.
        paper_objective: J in Table II.
        paper_seconds: ctime in Table II, s, on the paper's machine.
        paper_effort: TS in Table II.
        paper_final_time: t_f in Table II, s.
        trajectory: Plain data; not in the CSV.
    """

    key: str
    scene: str
    method: str
    guess: str
    status: str
    VN: int | None = None
    CN: int | None = None
    objective: float | None = None
    final_time: float | None = None
    effort: float | None = None
    iterations: int | None = None
    seconds: float | None = None
    runs: int = 0
    certified: bool | None = None
    penetration: float | None = None
    verdict: str = ""
    paper_objective: float | None = None
    paper_seconds: float | None = None
    paper_effort: float | None = None
    paper_final_time: float | None = None
    trajectory: dict[str, Any] | None = None

    @property
    def solved(self) -> bool:
        """Whether the solver found a solution."""
        return self.status in ("SOLVED", "ACCEPTABLE")

    def motion(self) -> Trajectory:
        """The solution; only if ``solved``."""
        return Trajectory.from_dict(self.trajectory or {})


COLUMNS = tuple(field.name for field in fields(Row) if field.name != "trajectory")


class RowFile:
    """Rows in a file that is only appended to.

    Args:
        path: A line that was cut off by an interruption is removed when the file is opened.
        settings: What all rows have in common; a file of other settings is refused.

    Raises:
        InputError: The file holds something else, or rows made with other settings.
    """

    def __init__(self, path: Path, settings: dict[str, Any]) -> None:
        self.path = path
        self.rows: dict[str, Row] = {}
        if path.exists():
            self._read(settings)
        else:
            atomic_write(path, json.dumps({"settings": settings}) + "\n")

    def _read(self, settings: dict[str, Any]) -> None:
        data = self.path.read_bytes()
        whole = data[: data.rfind(b"\n") + 1]
        try:
            header, *lines = [json.loads(line) for line in whole.splitlines()]
            found = header["settings"]
            self.rows = {row.key: row for row in (Row(**line) for line in lines)}
        except (ValueError, TypeError, KeyError):
            raise InputError(Problem("--output", f"{self.path} is not a file of this campaign; move it away")) from None
        wanted = json.loads(json.dumps(settings))
        if found != wanted:
            different = ", ".join(key for key in wanted if found.get(key) != wanted[key]) or "settings"
            sentence = f"{self.path} was made with other {different}; choose another directory or remove it"
            raise InputError(Problem("--output", sentence))
        if whole != data:
            atomic_write(self.path, whole)

    def append(self, row: Row) -> None:
        """Add a row; it is on the disk when this returns."""
        line = (json.dumps(asdict(row)) + "\n").encode()
        with self.path.open("ab") as file:
            file.write(line)
            file.flush()
            os.fsync(file.fileno())
        self.rows[row.key] = row

    def write_csv(self, path: Path) -> None:
        """All rows without their trajectories."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(COLUMNS)
        for row in self.rows.values():
            writer.writerow([getattr(row, column) for column in COLUMNS])
        atomic_write(path, text.getvalue())
