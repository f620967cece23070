"""``tightspot export``: a plan as files that other programs read."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tightspot.cli.console import answers, notes, print_json, print_line
from tightspot.errors import InputError, Problem, TightspotError

if TYPE_CHECKING:
    from tightspot.exports import Format
    from tightspot.verification import Plan

PICTURES = ("svg", "png", "pdf", "gif", "mp4")
_FLAGS = {"scenario_file": "--scenario"}


def export_command(
    plan_file: Annotated[Path, typer.Argument(metavar="PLAN.json", help="A plan file.")],
    outputs: Annotated[
        list[Path], typer.Argument(metavar="OUT...", help="One file or several; the endings choose the formats.")
    ],
    format: Annotated[  # noqa: A002
        str | None, typer.Option(metavar="NAME", help="Instead of the ending; a wrong name lists all.")
    ] = None,
    dt: Annotated[
        float | None,
        typer.Option(metavar="SECONDS", help="Time step; default: 0.05 (csv), 0.1 (ros), the scenario's (commonroad)."),
    ] = None,
    frame_id: Annotated[
        str | None, typer.Option(metavar="NAME", help="ROS: the coordinate frame; default: map.")
    ] = None,
    scenario: Annotated[
        Path | None, typer.Option(metavar="FILE", help="CommonRoad: the scenario that the plan solves.")
    ] = None,
    problem: Annotated[
        int | None, typer.Option(metavar="ID", help="CommonRoad: the planning problem; default: the first.")
    ] = None,
    vehicle_type: Annotated[
        int | None, typer.Option(metavar="1..4", help="CommonRoad: its vehicle, if the plan's is none of them.")
    ] = None,
    cost: Annotated[str | None, typer.Option(metavar="NAME", help="CommonRoad: cost function; default: JB1.")] = None,
    reference: Annotated[
        str | None, typer.Option(metavar="POINT", help="CommonRoad: centre (default) or rear-axle.")
    ] = None,
    fps: Annotated[float | None, typer.Option(metavar="N", help="Animations: frames a second; default: 20.")] = None,
    speedup: Annotated[
        float | None, typer.Option(metavar="N", help="Animations: times faster than reality; default: at most 12 s.")
    ] = None,
    anyway: Annotated[bool, typer.Option("--anyway", help="Write even what is not upheld.")] = False,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")] = False,
) -> None:
    """Write a plan as .csv, ROS (.path.json, .trajectory.json), CommonRoad solution (.xml), picture or animation.

    The plan is judged first: what is not upheld is written as a picture only, unless --anyway is given.
    """
    from tightspot.exports import format_of
    from tightspot.verification import load_plan

    options = {
        "dt": dt,
        "frame_id": frame_id,
        "scenario_file": scenario,
        "problem": problem,
        "vehicle_type": vehicle_type,
        "cost": cost,
        "reference": reference,
        "fps": fps,
        "speedup": speedup,
    }
    given = {key: value for key, value in options.items() if value is not None}
    targets = [(path, format_of(path, format)) for path in outputs]
    _check(given, targets)
    plan, upheld = _judged(load_plan(plan_file), targets, anyway=anyway)
    written = [_write(plan, path, kind, given) for path, kind in targets]
    if json:
        print_json({"status": "written", "upheld": upheld, "files": written})
    else:
        for entry in written:
            print_line(answers(), f"{entry['format']}: {entry['path']}")


def _check(given: dict[str, Any], targets: list[tuple[Path, Format]]) -> None:
    """Refuse what cannot be written before anything is; every option must be of use to one of the files."""
    problems = []
    for path, _ in targets:
        if path.is_dir():
            problems.append(Problem(str(path), "is a directory; give a file's name"))
        elif not path.absolute().parent.is_dir():
            problems.append(Problem(str(path), f"there is no directory {path.parent}"))
    known = {option for _, kind in targets for option in kind.options}
    formats = ", ".join(sorted({kind.name for _, kind in targets}))
    useless = [_FLAGS.get(key, f"--{key.replace('_', '-')}") for key in given if key not in known]
    problems += [Problem(flag, f"means nothing to {formats}") for flag in useless]
    if problems:
        raise InputError(problems)


def _judged(plan: Plan, targets: list[tuple[Path, Format]], *, anyway: bool) -> tuple[Plan, bool]:
    from tightspot.verification import verify_plan

    verdict = verify_plan(plan)
    if verdict.upheld:
        return plan, True
    reason = "the plan is not upheld; `tightspot verify` says why"
    if not anyway and any(kind.name not in PICTURES for _, kind in targets):
        raise TightspotError(f"{reason}; --anyway writes it all the same")
    print_line(notes(), f"warning: {reason}", "yellow")
    return replace(plan, certificate=verdict.certificate), False


def _write(plan: Plan, path: Path, kind: Format, given: dict[str, Any]) -> dict[str, Any]:
    from tightspot.exports import export_plan

    said = export_plan(plan, path, kind.name, **{key: value for key, value in given.items() if key in kind.options})
    for sentence in said:
        print_line(notes(), f"note: {path}: {sentence}", "yellow")
    return {"path": str(path), "format": kind.name, "notes": said}
