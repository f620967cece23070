"""A measured table as a page: told, and written for the documentation to include."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from benchmarks.plan_scenes import RESULTS, machine


def tell(name: str, title: str, note: str, lines: Sequence[str], *, write: bool) -> None:
    """Print the page of ``python -m benchmarks.<name>``; if asked to, write it and the table alone to the results.

    Args:
        name: Of the benchmark's module and of the files.
        title: Of the page.
        note: How it was measured, beside the machine.
        lines: Of the table.
        write: Whether to touch ``benchmarks/results``.
    """
    where = ", ".join(f"{key} {value}" for key, value in machine().items())
    head = [f"# {title}", "", f"Written by `python -m benchmarks.{name}`.", "", f"- {where}", f"- {note}"]
    report = "\n".join([*head, "", *lines]) + "\n"
    sys.stdout.write(report)
    if write:
        RESULTS.mkdir(exist_ok=True)
        (RESULTS / f"{name}.md").write_text(report, encoding="utf-8")
        (RESULTS / f"{name}_table.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
