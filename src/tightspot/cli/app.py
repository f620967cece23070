"""The application: its commands, ``--version``, and the one place where exceptions become exit codes."""

from __future__ import annotations

from typing import Annotated

import typer

import tightspot
from tightspot.cli.bench import bench
from tightspot.cli.cache import cache
from tightspot.cli.convert import convert_command
from tightspot.cli.export import export_command
from tightspot.cli.failures import DONE, INTERRUPTED, failure_of
from tightspot.cli.plan import plan_command
from tightspot.cli.scenes import scenes_command
from tightspot.cli.schema import schema_command
from tightspot.cli.show import show_command
from tightspot.cli.vehicles import vehicles_command
from tightspot.cli.verify import verify_command

app = typer.Typer(name="tightspot", add_completion=False, rich_markup_mode=None)
app.command("plan")(plan_command)
app.command("verify")(verify_command)
app.command("show")(show_command)
app.command("export")(export_command)
app.command("convert")(convert_command)
app.command("scenes")(scenes_command)
app.command("vehicles")(vehicles_command)
app.command("schema")(schema_command)
app.add_typer(bench)
app.add_typer(cache)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"tightspot {tightspot.__version__}")
        raise typer.Exit


@app.callback(invoke_without_command=True)
def _root(
    context: typer.Context,
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    """Plan collision-free manoeuvres for vehicles among polygons, certified for all times.

    Exit codes: 0 done; 1 no plan found, or a plan that is not upheld; 2 bad input; 3 a defect of tightspot;
    130 interrupted.
    """
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


def run(arguments: list[str]) -> int:
    """Run one command; every exception becomes a sentence and an exit code."""
    as_json = "--json" in arguments
    try:
        command = typer.main.get_command(app)
        code = command.main(arguments, prog_name="tightspot", standalone_mode=False)
        if code == INTERRUPTED:  # typer answers an interrupt with this code instead of passing it on
            raise KeyboardInterrupt
    except (Exception, KeyboardInterrupt) as error:
        return failure_of(error).report(as_json=as_json)
    return code if isinstance(code, int) else DONE
