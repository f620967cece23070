"""``tightspot vehicles``: the catalogue."""

from __future__ import annotations

from typing import Annotated

import typer
from rich.table import Table

from tightspot import vehicles
from tightspot.cli.console import answers, print_json


def vehicles_command(
    json: Annotated[bool, typer.Option("--json", help="Print a list of vehicle files' objects.")] = False,
) -> None:
    """List the vehicles of the catalogue."""
    catalogue = [vehicles.vehicle(name) for name in vehicles.CATALOGUE]
    if json:
        print_json([vehicle.to_dict() for vehicle in catalogue])
        return
    table = Table(box=None, pad_edge=False)
    table.add_column("vehicle", no_wrap=True)
    for heading in ("wheelbase", "length", "width", "turning radius", "parts"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("source")
    for vehicle in catalogue:
        corners = [vertex for part in vehicle.parts for vertex in part.polygon.vertices.tolist()]
        length, width = (max(c[i] for c in corners) - min(c[i] for c in corners) for i in range(2))
        lengths = (vehicle.wheelbase, length, width, vehicle.min_turning_radius)
        cells = [f"{value:.2f} m" for value in lengths]
        table.add_row(vehicle.name, *cells, str(len(vehicle.parts)), vehicle.source)
    answers().print(table)
