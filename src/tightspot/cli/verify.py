"""``tightspot verify``: is a trajectory safe? A plan file, or anybody's table. No optimiser is loaded for that."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tightspot.cli.console import answers, notes, print_json, print_line
from tightspot.cli.failures import REFUSED
from tightspot.errors import InputError, Problem

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def verify_command(
    trajectory: Annotated[
        Path, typer.Argument(metavar="TRAJECTORY", help="A plan file, or a table (CSV, TSV) with named columns.")
    ],
    scene: Annotated[
        str | None, typer.Option(metavar="SCENE", help="A built-in scene or a file; for a plan, instead of its own.")
    ] = None,
    vehicle: Annotated[
        str | None, typer.Option(metavar="NAME|FILE", help="From the catalogue or a file; default: the scene's.")
    ] = None,
    margin: Annotated[
        float | None,
        typer.Option(metavar="METRES", help="Clearance to prove; default: 0 for tables, what a plan claims for plans."),
    ] = None,
    columns: Annotated[
        str | None,
        typer.Option(metavar="NAMES", help="Names of a table's columns in order, with commas; - leaves one out."),
    ] = None,
    picture: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Draw the worst moment (.png, .svg, .pdf).")
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")] = False,
) -> None:
    """Judge a trajectory: collisions at all times, kinematics, limits, start and goal, and its scores.

    Exit code 0 if it is upheld, 1 if it is refuted or cannot be certified, 2 if it cannot be read.
    """
    from tightspot.cli.verified import Judgement, judged_plan, judged_table

    if picture is not None:
        _check_picture(picture)
    judgement: Judgement
    if _is_plan(trajectory):
        if columns is not None:
            raise InputError(Problem("--columns", "is for tables; a plan file names its columns itself"))
        judgement = judged_plan(trajectory, scene, vehicle, margin)
    else:
        names = None if columns is None else [name.strip() for name in columns.split(",")]
        judgement = judged_table(trajectory, scene, vehicle, margin, names)
    facts = judgement.facts
    if picture is not None:
        _draw(judgement.figure(), picture)
        facts = {**facts, "files": {"picture": str(picture)}}
    _print(judgement.lines, facts, picture, as_json=json)
    if not judgement.upheld:
        raise typer.Exit(REFUSED)


def _print(lines: list[str], facts: dict[str, Any], picture: Path | None, *, as_json: bool) -> None:
    if as_json:
        print_json(facts)
        return
    console = answers()
    for line in lines:
        print_line(console, line)
    if picture is not None:
        print_line(notes(), f"picture: {picture}")


def _is_plan(path: Path) -> bool:
    """Whether a file is to be read as a plan: by its name or by its first character."""
    if path.suffix.lower() == ".json":
        return True
    try:
        with path.open("rb") as file:
            return file.read(200).removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"{")
    except (OSError, ValueError):
        return False


def _check_picture(path: Path) -> None:
    """Refuse a name that cannot be drawn to before anything is computed."""
    from tightspot.plotting.output import FIGURE_FORMATS, checked_ending

    checked_ending(path, FIGURE_FORMATS)
    if not path.absolute().parent.is_dir():
        raise InputError(Problem("--picture", f"there is no directory {path.absolute().parent}; create it first"))
    if path.is_dir():
        raise InputError(Problem("--picture", f"{path} is a directory; give a file"))


def _draw(figure: Figure, path: Path) -> None:
    from tightspot.plotting import save

    try:
        save(figure, path)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(Problem("--picture", f"{path} cannot be written: {reason}")) from None
