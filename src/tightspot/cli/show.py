"""``tightspot show``: a plan as a picture or an animation."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tightspot.cli.console import answers, print_json, print_line


def show_command(
    plan_file: Annotated[Path, typer.Argument(metavar="PLAN.json", help="A plan file.")],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="Picture (.png, .svg, .pdf) or animation (.gif); default: PLAN.png.",
        ),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")] = False,
) -> None:
    """Draw a plan: scene, swept area, path, states and inputs against their limits, clearance over time."""
    from tightspot import plotting
    from tightspot.verification import load_plan

    picture = output or plan_file.with_suffix(".png")
    plan = load_plan(plan_file)
    plotting.show_plan(plan, picture)
    if json:
        print_json({"status": "drawn", "files": {"picture": str(picture)}})
    else:
        print_line(answers(), f"picture: {picture}")
