"""``tightspot scenes``: what is built in."""

from __future__ import annotations

from typing import Annotated

import typer
from rich.table import Table

from tightspot import scenarios
from tightspot.cli.console import answers, print_json


def scenes_command(
    json: Annotated[bool, typer.Option("--json", help="Print a list of JSON objects.")] = False,
) -> None:
    """List the built-in scenes."""
    summaries = scenarios.summaries()
    if json:
        print_json(summaries)
        return
    table = Table(box=None, pad_edge=False)
    table.add_column("scene", no_wrap=True)
    table.add_column("vehicle", no_wrap=True)
    table.add_column("margin", justify="right", no_wrap=True)
    table.add_column("what it is")
    for scene in summaries:
        vehicle = scene["vehicle"] if isinstance(scene["vehicle"], str) else "its own"
        table.add_row(scene["name"], vehicle, f"{scene['margin']:g} m", scene["description"])
    answers().print(table)
