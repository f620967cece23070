"""``tightspot bench speed``: against the paper's method, on this machine, with a report."""

from __future__ import annotations

import importlib.util
import json as json_text
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from tightspot.cli.console import answers, notes, print_json, print_line
from tightspot.cli.interrupts import InterruptWatch
from tightspot.errors import InputError, Problem

REPORT, FIGURES = "speed.md", "speed.json"


def speed_command(
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="For speed.md, speed.json and the pictures.")
    ] = Path("speed-bench"),
    quick: Annotated[bool, typer.Option("--quick", help="A few starts: less than a minute, all figures.")] = False,
    starts: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, help="Starts a scene, for solves and plans; default 100, quick 3 and 2."),
    ] = None,
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Of the starts.")] = 0,
    picture: Annotated[bool, typer.Option("--picture/--no-picture", help="Draw the figures as SVG.")] = True,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Say nothing but errors.")] = False,
) -> None:
    """Solves, plans, scaling and throughput as ratios to the paper's method (formulation (17), CasADi, IPOPT).

    The full run takes about a quarter of an hour. Files are written when it is finished.
    """
    from tightspot.campaigns.speed import FULL, QUICK, run_speed, speed_report

    plan = QUICK if quick else FULL
    if starts is not None:
        plan = replace(plan, starts=starts, plans=starts, straight=min(plan.straight, starts))
    plan = replace(plan, seed=seed)
    _made(output)
    console = notes()
    with InterruptWatch() as watch:

        def progress(news: str) -> None:
            watch.check()
            if not quiet and console.is_terminal:
                console.print(news.ljust(60), end="\r", markup=False, highlight=False)

        result = run_speed(plan, progress=progress)
    pictures = draw(result, output) if picture and importlib.util.find_spec("matplotlib") else {}
    files = _write(result, output, speed_report(result, pictures), pictures)
    if json:
        print_json({**result, "files": files})
    elif not quiet:
        for name, value in _scalars(result).items():
            print_line(answers(), f"{name}: {'-' if value is None else f'{value:.4g}'}")
        print_line(answers(), f"report: {files['report']}")


def _made(output: Path) -> None:
    """The directory, made at once: a quarter of an hour later would be a bad time to find that it cannot be."""
    if output.exists() and not output.is_dir():
        raise InputError(Problem("--output", f"{output} is a file; give a directory"))
    try:
        output.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=output):
            pass
    except OSError as error:
        sentence = f"{output} cannot be written ({error.strerror}); give another directory"
        raise InputError(Problem("--output", sentence)) from None


def _scalars(result: dict[str, Any]) -> dict[str, float | None]:
    from tightspot.campaigns.speed.headline import ASKED, ASKED_OF_SCENES

    several = {f"{name}, {scene}": value for name in ASKED_OF_SCENES for scene, value in result[name].items()}
    return {name: result[name] for name in ASKED} | several


def draw(result: dict[str, Any], directory: Path) -> dict[str, str]:
    """Caption to file name of each figure."""
    from tightspot.plotting import save
    from tightspot.plotting.speed_figures import figure_distribution, figure_plan_times, figure_scaling

    directory.mkdir(parents=True, exist_ok=True)
    figures = {
        "speed-scaling.svg": ("Time against steps, obstacles and vertices.", figure_scaling(result["scaling"])),
        "speed-starts.svg": (
            "How much faster each start is solved, and planned, than by the paper's method.",
            figure_distribution(_ratios(result["cases"])),
        ),
        "speed-plans.svg": ("Where a plan's time goes.", figure_plan_times(result["plans"])),
    }
    for name, (_, figure) in figures.items():
        save(figure, directory / name)
    return {caption: name for name, (caption, _) in figures.items()}


def _ratios(cases: dict[str, Any]) -> dict[str, dict[str, list[float]]]:
    """What the distribution's panels draw: by title, then by scene."""
    solves = {f"solve, {name}": scenes for name, scenes in cases["solves"].items()}
    solves["solve, straight-line guesses"] = cases["straight_lines"]
    panels = {
        title: {
            scene: [
                theirs / ours
                for ours, theirs, solved, too in zip(
                    *(some[name] for name in ("seconds", "ipopt_seconds", "success", "ipopt_success")), strict=True
                )
                if solved and too
            ]
            for scene, some in scenes.items()
        }
        for title, scenes in solves.items()
    }
    return panels | {"whole plan": {scene: some["ratio"] for scene, some in cases["plans"].items()}}


def _write(result: dict[str, Any], directory: Path, report: str, pictures: dict[str, str]) -> dict[str, str]:
    from tightspot.files import atomic_write

    directory.mkdir(parents=True, exist_ok=True)
    atomic_write(directory / REPORT, report)
    atomic_write(directory / FIGURES, json_text.dumps(result, indent=2, allow_nan=False) + "\n")
    files = {"report": REPORT, "figures": FIGURES} | {Path(name).stem: name for name in pictures.values()}
    return {kind: str(directory / name) for kind, name in files.items()}
