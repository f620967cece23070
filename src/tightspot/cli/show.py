"""``tightspot show``: a plan as a picture or an animation."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from tightspot.cli.console import answers, notes, print_json, print_line


def show_command(
    plan_file: Annotated[Path, typer.Argument(metavar="PLAN.json", help="A plan file.")],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="Picture (.png, .svg, .pdf) or animation (.gif, .mp4); default: PLAN.png.",
        ),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")] = False,
) -> None:
    """Draw a plan: scene, swept area, path, states and inputs against their limits, clearance over time.

    The plan is judged first: what is not upheld is not drawn as certified.
    """
    from tightspot import plotting
    from tightspot.verification import load_plan, verify_plan

    picture = output or plan_file.with_suffix(".png")
    plan = load_plan(plan_file)
    verdict = verify_plan(plan)
    if not verdict.upheld:
        print_line(notes(), "warning: the plan is not upheld; `tightspot verify` says why", "yellow")
        plan = replace(plan, certificate=verdict.certificate)
    plotting.show_plan(plan, picture)
    if json:
        print_json({"status": "drawn", "upheld": verdict.upheld, "files": {"picture": str(picture)}})
    else:
        print_line(answers(), f"picture: {picture}")
