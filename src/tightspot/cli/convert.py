"""``tightspot convert``: a scene from one file format to another."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tightspot.cli.console import answers, notes, print_json, print_line
from tightspot.errors import InputError, Problem

if TYPE_CHECKING:
    from tightspot.scenarios import Scenario


def convert_command(
    scene: Annotated[str, typer.Argument(metavar="IN", help="A built-in scene or a file of any format that is read.")],
    output: Annotated[Path, typer.Argument(metavar="OUT", help="The file to write; its ending chooses the format.")],
    format: Annotated[  # noqa: A002
        str | None, typer.Option(metavar="NAME", help="Of OUT, instead of its ending; a wrong name lists all.")
    ] = None,
    input_format: Annotated[
        str | None, typer.Option(metavar="NAME", help="Of IN, instead of guessing; a wrong name lists all.")
    ] = None,
    start: Annotated[
        str | None, typer.Option(metavar="X,Y,THETA", help="Metres and radians, then v, delta; default: the scene's.")
    ] = None,
    goal: Annotated[str | None, typer.Option(metavar="X,Y,THETA", help="The same for the goal.")] = None,
    vehicle: Annotated[
        str | None, typer.Option(metavar="NAME|FILE", help="From the catalogue or a file; default: the scene's.")
    ] = None,
    margin: Annotated[
        float | None, typer.Option(metavar="METRES", help="Clearance to keep at all times; default: the scene's.")
    ] = None,
    unknown: Annotated[
        str | None, typer.Option(metavar="POLICY", help="Unknown cells of a map: occupied (default) or free.")
    ] = None,
    problem: Annotated[
        int | None, typer.Option(metavar="ID", help="CommonRoad: the planning problem; default: the first.")
    ] = None,
    reference: Annotated[
        str | None,
        typer.Option(metavar="POINT", help="CommonRoad: positions are of the centre (default) or rear-axle."),
    ] = None,
    moving: Annotated[
        str | None, typer.Option(metavar="POLICY", help="CommonRoad: refuse (default), initial or ignore what moves.")
    ] = None,
    lanelets: Annotated[
        str | None, typer.Option(metavar="POLICY", help="CommonRoad: ignore (default), or the road as boundary.")
    ] = None,
    recentred: Annotated[
        bool, typer.Option("--recentred", help="Far from the origin: write coordinates near it instead.")
    ] = False,
    lossy: Annotated[
        bool, typer.Option("--lossy", help="Leave out what the format cannot hold, and say what.")
    ] = False,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")] = False,
) -> None:
    """Write a scene in another format. Reading it again gives the same scene, bit for bit, or it is refused."""
    from tightspot.scenarios import load, save

    options = {"problem": problem, "reference": reference, "moving": moving, "lanelets": lanelets}
    chosen = {key: value for key, value in options.items() if value is not None}
    if chosen:
        scenario = _commonroad(Path(scene), chosen, start=start, goal=goal, vehicle=vehicle, margin=margin)
    else:
        scenario = load(
            scene, start=start, goal=goal, vehicle=vehicle, margin=margin, unknown=unknown, format=input_format
        )
    if recentred:
        scenario = scenario.with_(offset=(0.0, 0.0), originals={})
    lost = save(scenario, output, format=format, lossy=lossy)
    if json:
        print_json({"status": "converted", "files": {"scene": str(output)}, "left_out": lost})
        return
    for words in lost:
        print_line(notes(), f"left out: {words}", "yellow")
    print_line(answers(), f"scene: {output}")


def _commonroad(path: Path, options: dict[str, Any], **given: str | float | None) -> Scenario:
    """The scene in a CommonRoad file, read with options that other formats have not."""
    from tightspot.scenarios.readers.commonroad import read_commonroad
    from tightspot.scenarios.readers.given import Given

    if path.suffix.lower() != ".xml":
        flags = ", ".join(f"--{key}" for key in options)
        raise InputError(Problem(flags, f"{path} is no CommonRoad file (.xml), and only these have such options"))
    wanted: Any = given
    scenario = read_commonroad(path, vehicle=wanted.pop("vehicle"), **options)
    return Given.of(**wanted).over_scenario(scenario)
