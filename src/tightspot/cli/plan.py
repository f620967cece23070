"""``tightspot plan``: from a scene to a certified plan and its files."""

from __future__ import annotations

import importlib.util
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tightspot.cli.console import answers, notes, print_json, print_line
from tightspot.cli.failures import REFUSED, failure_of
from tightspot.cli.interrupts import InterruptWatch
from tightspot.cli.objective import objective_of
from tightspot.cli.output_files import PLAN, check_directory, default_directory, write_failure, write_plan
from tightspot.cli.progress import ProgressView
from tightspot.cli.summary import plan_facts, summary_table
from tightspot.errors import BlockedError, InputError, PlanningError

if TYPE_CHECKING:
    from tightspot.planner import Progress, ProgressCallback
    from tightspot.verification import Plan


def plan_command(
    scene: Annotated[
        str,
        typer.Argument(
            metavar="SCENE",
            help="A built-in scene or a file: .yaml, .json, TPCAP .csv, CommonRoad .xml, .geojson, .wkt, map .yaml.",
        ),
    ],
    vehicle: Annotated[
        str | None,
        typer.Option(metavar="NAME|FILE", help="From the catalogue or a file; default: the scene's."),
    ] = None,
    start: Annotated[
        str | None, typer.Option(metavar="X,Y,THETA", help="Metres and radians, then v, delta; default: the scene's.")
    ] = None,
    goal: Annotated[str | None, typer.Option(metavar="X,Y,THETA", help="The same for the goal.")] = None,
    unknown: Annotated[
        str | None, typer.Option(metavar="POLICY", help="Unknown cells of a map: occupied (default) or free.")
    ] = None,
    formulation: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Default: swept-line; a wrong name lists all."),
    ] = None,
    guess: Annotated[
        str | None, typer.Option(metavar="NAME", help="Default: hybrid-astar; a wrong name lists all.")
    ] = None,
    solver: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Default: stagewise, then fatrop, then ipopt; a wrong name lists all."),
    ] = None,
    steps: Annotated[
        int | None, typer.Option(metavar="N", help="Intervals to begin with; default: from the guess.")
    ] = None,
    margin: Annotated[
        float | None,
        typer.Option(metavar="METRES", help="Clearance to keep at all times; default: the scene's."),
    ] = None,
    time_weight: Annotated[
        float | None,
        typer.Option(metavar="R", help="Weight of the duration against the input energy; default: 1."),
    ] = None,
    energy_weights: Annotated[
        str | None,
        typer.Option(metavar="A,W", help="Weights of acceleration and steering rate squared; default: 1,2."),
    ] = None,
    free_steering: Annotated[
        bool, typer.Option("--free-steering", help="Leave the steering angle free at start and goal.")
    ] = False,
    time_limit: Annotated[
        float | None,
        typer.Option(metavar="SECONDS", help="No new attempt begins after this; default: 60."),
    ] = None,
    effort: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="fast: one guess; balanced (default): until one is certified; best: all."),
    ] = None,
    seed: Annotated[int, typer.Option(metavar="N", help="Of what --effort best draws at random.")] = 0,
    explain: Annotated[
        bool,
        typer.Option(
            "--explain",
            help="If there is no plan, find the largest margin and body width that pass: about a minute more.",
        ),
    ] = False,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="DIR", help="For the files; default: <scene>-plan."),
    ] = None,
    picture: Annotated[bool, typer.Option("--picture/--no-picture", help="Draw plan.png or failure.png.")] = True,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Say nothing but errors.")] = False,
) -> None:
    """Plan a certified manoeuvre and write plan.json, trajectory.csv and plan.png.

    Nothing is written unless the plan is certified for all times, except failure.png, which shows why there is none.
    """
    if output is not None:
        check_directory(output)
    options: dict[str, Any] = {
        "vehicle": vehicle,
        "formulation": formulation,
        "guess": guess,
        "solver": solver,
        "steps": steps,
        "margin": margin,
        **({} if time_limit is None else {"time_limit": time_limit}),
        **({} if effort is None else {"effort": effort}),
        **({"seed": seed} if seed else {}),
        **({"explain": True} if explain else {}),
    }
    try:
        with InterruptWatch() as watch, ProgressView(notes(), quiet=quiet) as view:

            def progress(news: Progress) -> None:
                watch.check()
                view(news)

            given = {"start": start, "goal": goal, "vehicle": vehicle, "unknown": unknown}
            options["objective"] = objective_of(time_weight, energy_weights)
            plan = _plan(scene, given, free_steering, output, progress, options)
    except (PlanningError, BlockedError) as error:
        raise typer.Exit(_explained(error, output, picture=picture, quiet=quiet, as_json=json)) from None
    directory = output or default_directory(plan.scenario.name)
    drawable = importlib.util.find_spec("matplotlib") is not None
    files = write_plan(plan, directory, picture=picture and drawable)
    if picture and not drawable and not quiet:
        print_line(notes(), 'no picture: matplotlib is not installed; pip install "tightspot[plot]"')
    if json:
        print_json({"status": "certified", "files": files, **plan_facts(plan)})
    elif not quiet:
        _print(plan, files)


def _plan(
    scene: str,
    given: dict[str, Any],
    free_steering: bool,
    output: Path | None,
    progress: ProgressCallback,
    options: dict[str, Any],
) -> Plan:
    from tightspot.planner import plan
    from tightspot.scenarios import load

    scenario = load(scene, **given)
    if free_steering:
        scenario = scenario.with_free_steering()
    if output is None:
        check_directory(default_directory(scenario.name))
    return plan(scenario, progress=progress, **options)


def _explained(
    error: PlanningError | BlockedError, output: Path | None, *, picture: bool, quiet: bool, as_json: bool
) -> int:
    """Say why there is no plan and draw it; the answer's exit code, whatever becomes of the picture.

    For bad input nothing is written unless a directory is given.
    """
    failure, explanation = failure_of(error), error.explanation
    advice = list(failure.advice)
    files: dict[str, str] = {}
    drawable = importlib.util.find_spec("matplotlib") is not None
    if picture and drawable and explanation is not None and (output or failure.code == REFUSED):
        directory = output or default_directory(explanation.scenario.name)
        try:
            files = write_failure(explanation, directory)
        except InputError as problem:
            advice.append(f"no picture: {problem}")
        if files and not quiet:
            advice.append(f"picture: {files['picture']}")
        if (directory / PLAN).exists() and not quiet:
            advice.append(f"{directory / PLAN} is an older plan, not of this attempt")
    return replace(failure, advice=advice, details={**failure.details, "files": files}).report(as_json=as_json)


def _print(plan: Plan, files: dict[str, str]) -> None:
    console = answers()
    console.print(summary_table(plan))
    console.print()
    for line in plan.certificate.summary():
        print_line(console, line)
    console.print()
    for kind, path in files.items():
        print_line(console, f"{kind}: {path}")
