"""What was measured as a page: told, and written for the documentation to include."""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Iterable, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

import tightspot

RESULTS = Path(__file__).parent / "results"


def machine() -> dict[str, Any]:
    """Where and with what it was measured."""
    names = ("numpy", "shapely", "casadi")
    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "tightspot": tightspot.__version__,
        **{name: version(name) for name in names},
    }


def table(rows: Iterable[Mapping[str, Any]], columns: Iterable[tuple[str, str, str]]) -> list[str]:
    """Lines of a Markdown table.

    Args:
        rows: Each a line; what it lacks, or what is ``None``, is a dash.
        columns: (heading, key, form).
    """
    columns = tuple(columns)
    lines = ["| " + " | ".join(heading for heading, _, _ in columns) + " |", "|" + "---|" * len(columns)]
    for row in rows:
        cells = [form.format(row[key]) if row.get(key) is not None else "-" for _, key, form in columns]
        lines.append("| " + " | ".join(cell.replace("|", "/") for cell in cells) + " |")
    return lines


def page(
    by: str, title: str, notes: Sequence[str], lines: Sequence[str], where: Mapping[str, Any] | None = None
) -> str:
    """A page: title, what wrote it, machine, notes, and the lines below.

    Args:
        by: Command that writes it.
        title: Of the page.
        notes: How it was measured, beside the machine.
        lines: Tables and what else there is.
        where: The machine; by default this one.
    """
    told = ", ".join(f"{key} {value}" for key, value in (machine() if where is None else where).items())
    head = [f"# {title}", "", f"Written by `{by}`.", "", *(f"- {note}" for note in (told, *notes))]
    return "\n".join([*head, "", *lines]) + "\n"


def tell(name: str, title: str, note: str, lines: Sequence[str], *, write: bool, rest: Sequence[str] = ()) -> None:
    """Print the page of ``python -m benchmarks.<name>``; if asked to, write it and the table alone to the results.

    Args:
        name: Of the benchmark's module and of the files.
        title: Of the page.
        note: How it was measured, beside the machine.
        lines: Of the table.
        write: Whether to touch ``benchmarks/results``.
        rest: What follows on the page.
    """
    report = page(f"python -m benchmarks.{name}", title, [note], [*lines, *(["", *rest] if rest else [])])
    sys.stdout.write(report)
    if write:
        keep(f"{name}.md", report)
        keep(f"{name}_table.md", "\n".join(lines) + "\n")


def keep(name: str, text: str) -> None:
    """A file of the results."""
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / name).write_text(text, encoding="utf-8")


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    models = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.processor()
