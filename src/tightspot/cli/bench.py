"""``tightspot bench``: the paper's Table II on this machine, with a report; speed is in :mod:`.bench_speed`."""

from __future__ import annotations

import importlib.util
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tightspot.cli.bench_speed import speed_command
from tightspot.cli.console import answers, notes, print_json, print_line
from tightspot.cli.interrupts import InterruptWatch
from tightspot.errors import InputError, Problem

if TYPE_CHECKING:
    from rich.console import Console

    from tightspot.campaigns import News, Outcome

bench = typer.Typer(name="bench", help="Benchmarks that anyone can run again.", rich_markup_mode=None)

QUICK_LIMIT, LIMIT = 20.0, 60.0


bench.command("speed")(speed_command)


@bench.callback()
def _bench() -> None:
    """Benchmarks that anyone can run again."""


@bench.command("paper")
def paper_command(
    output: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="DIR", help="For rows and report; an interrupted run goes on there."),
    ] = Path("paper-bench"),
    quick: Annotated[bool, typer.Option("--quick", help="Each program is solved once.")] = False,
    settings: Annotated[
        str, typer.Option(metavar="NAME", help="recovered (from the paper's table, default) or printed.")
    ] = "recovered",
    scene: Annotated[list[str] | None, typer.Option(metavar="NAME", help="Only this scene; may be repeated.")] = None,
    method: Annotated[
        list[str] | None, typer.Option(metavar="KEY", help="Only this formulation, e.g. 17 or 19-single; repeatable.")
    ] = None,
    guess: Annotated[list[str] | None, typer.Option(metavar="NAME", help="Only this guess; may be repeated.")] = None,
    starts: Annotated[int, typer.Option(metavar="N", help="Random starts a scene that look for better optima.")] = 0,
    runs: Annotated[int | None, typer.Option(metavar="N", help="Solves a program; default 5, with --quick 1.")] = None,
    time_limit: Annotated[
        float | None, typer.Option(metavar="SECONDS", help="For one solve; default 60, with --quick 20.")
    ] = None,
    picture: Annotated[bool, typer.Option("--picture/--no-picture", help="Draw figures 1 and 2.")] = True,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Say nothing but errors.")] = False,
) -> None:
    """Solve the paper's Table II again: every scene, formulation and guess, judged at all times.

    Rows are kept as they come: call it again with the same directory to go on after an interruption.
    """
    from tightspot.campaigns import METHODS, Plan, run
    from tightspot.campaigns.settings import GUESS_NAMES, SCENES

    plan = Plan(
        settings,
        tuple(scene or SCENES),
        tuple(method or METHODS),
        tuple(guess or GUESS_NAMES),
        runs=runs if runs is not None else 1 if quick else 5,
        time_limit=time_limit if time_limit is not None else QUICK_LIMIT if quick else LIMIT,
        starts=starts,
    )
    if output.exists() and not output.is_dir():
        raise InputError(Problem("--output", f"{output} is a file; give a directory"))
    console = notes()
    with InterruptWatch() as watch:

        def progress(news: News) -> None:
            watch.check()
            if not quiet:
                _tell(console, news)

        outcome = run(plan, output, progress=progress)
    files = _write(outcome, output, picture=picture)
    if json:
        print_json(_facts(outcome, files))
    elif not quiet:
        for claim in outcome.claims:
            word = {True: "holds", False: "DOES NOT HOLD", None: "not told"}[claim.holds]
            print_line(answers(), f"{word}: {claim.paper} -- {claim.here}")
        print_line(answers(), f"report: {files['report']}")


def _tell(console: Console, news: News) -> None:
    if news.row is None:
        return
    row = news.row
    values = f"J = {row.objective:.4f}, {row.iterations} iterations, {row.seconds:.2f} s" if row.solved else row.status
    left = "" if news.seconds_left is None else f", about {_duration(news.seconds_left)} left"
    print_line(console, f"[{news.done}/{news.total}{left}] {news.case.key}: {values}")


def _duration(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"


def _write(outcome: Outcome, directory: Path, *, picture: bool) -> dict[str, str]:
    from tightspot.campaigns import Machine, report_markdown
    from tightspot.campaigns.paper import REPORT, ROWS, TABLE
    from tightspot.files import atomic_write

    pictures = _draw(outcome, directory) if picture and importlib.util.find_spec("matplotlib") else {}
    atomic_write(directory / REPORT, report_markdown(outcome, Machine.here(), pictures))
    files = {"report": directory / REPORT, "table": directory / TABLE, "rows": directory / ROWS}
    return {kind: str(path) for kind, path in files.items()} | {
        Path(name).stem: str(directory / name) for name in pictures.values()
    }


def _draw(outcome: Outcome, directory: Path) -> dict[str, str]:
    """The paper's figures 1 (guesses) and 2 (best solutions)."""
    from tightspot.plotting import Panel, figure_panels, save

    settings = outcome.settings
    car = settings.car()
    guesses, solutions = [], []
    for name in outcome.plan.scenes:
        scenario = settings.scenario(name)
        made = {guess: settings.guess(guess).make(scenario, car, margin=settings.gap) for guess in outcome.plan.guesses}
        paths = {guess: found.trajectory for guess, found in made.items() if found.trajectory is not None}
        guesses.append(Panel(scenario, car, name, paths))
        solved = [row for row in outcome.rows if row.scene == name and row.solved and row.objective is not None]
        if solved:
            best = min(solved, key=lambda row: row.objective or 0.0)
            verdict = "certified" if best.certified else f"overlap {best.penetration or 0.0:.2f} m between samples"
            solutions.append(Panel(scenario, car, f"{name}: J = {best.objective:.3f}, {verdict}", {}, best.motion()))
    pictures = {"Figure 1: the initial guesses, rear-axle midpoint at their knots.": "figure1.png"}
    save(figure_panels(guesses), directory / "figure1.png")
    if solutions:
        pictures["Figure 2: the best solutions found in this run, replayed."] = "figure2.png"
        save(figure_panels(solutions), directory / "figure2.png")
    return pictures


def _facts(outcome: Outcome, files: dict[str, str]) -> dict[str, Any]:
    rows = [{key: value for key, value in asdict(row).items() if key != "trajectory"} for row in outcome.rows]
    return {
        "settings": outcome.settings.name,
        "seconds": outcome.seconds,
        "files": files,
        "claims": [claim._asdict() for claim in outcome.claims],
        "rows": rows,
    }
