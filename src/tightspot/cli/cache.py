"""``tightspot cache``: functions that were compiled for the Ipopt and fatrop back ends."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.table import Table

from tightspot.cli.console import answers, print_json, print_line

if TYPE_CHECKING:
    from tightspot.solvers.compiled import Entry

cache = typer.Typer(name="cache", help="Compiled functions: what is kept, how large, clear.", rich_markup_mode=None)

AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")]


@cache.callback()
def _cache() -> None:
    """Compiled functions: what is kept, how large, clear."""


@cache.command("list")
def list_command(json: AsJson = False) -> None:
    """What is kept, the newest first."""
    from tightspot.solvers.compiled import cache_directory, entries

    found = entries()
    if json:
        print_json({**_sizes(found), "entries": [_facts(entry) for entry in found]})
        return
    if found:
        table = Table(box=None, pad_edge=False)
        for heading in ("key", "backend", "variables", "rows", "size", "made"):
            table.add_column(heading)
        for entry in found:
            about = [str(entry.about.get(name, "damaged")) for name in ("backend", "variables", "rows")]
            made = datetime.fromtimestamp(entry.made, UTC).isoformat(sep=" ", timespec="seconds")
            table.add_row(entry.key[:12], *about, _readable(entry.size), made)
        answers().print(table)
    print_line(answers(), f"{len(found)} kept in {cache_directory()}, {_readable(sum(e.size for e in found))}")


@cache.command("size")
def size_command(json: AsJson = False) -> None:
    """How many are kept and how large they are together."""
    from tightspot.solvers.compiled import entries

    found = entries()
    if json:
        print_json(_sizes(found))
    else:
        print_line(answers(), f"{len(found)} kept, {_readable(sum(entry.size for entry in found))}")


@cache.command("clear")
def clear_command(json: AsJson = False) -> None:
    """Remove all of them; they are compiled again when they are needed."""
    from tightspot.solvers.compiled import clear

    removed = clear()
    if json:
        print_json({"removed": len(removed), "bytes": sum(entry.size for entry in removed)})
    else:
        print_line(answers(), f"{len(removed)} removed, {_readable(sum(entry.size for entry in removed))}")


def _sizes(found: list[Entry]) -> dict[str, Any]:
    from tightspot.solvers.compiled import cache_directory

    return {
        "directory": str(cache_directory()),
        "count": len(found),
        "bytes": sum(entry.size for entry in found),
    }


def _facts(entry: Entry) -> dict[str, Any]:
    return {
        "key": entry.key,
        "path": str(entry.directory),
        "bytes": entry.size,
        "made": datetime.fromtimestamp(entry.made, UTC).isoformat(timespec="seconds"),
        "whole": bool(entry.about),
        "about": entry.about,
    }


def _readable(size: int) -> str:
    return f"{size / 1e6:.1f} MB"
