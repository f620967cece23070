"""``tightspot schema``: what a scene or vehicle file may hold, as JSON Schema."""

from __future__ import annotations

from typing import Annotated

import typer

from tightspot import scenarios, vehicles
from tightspot.cli.console import print_json


def schema_command(
    vehicle: Annotated[bool, typer.Option("--vehicle", help="Of vehicle files.")] = False,
    json: Annotated[bool, typer.Option("--json", help="Changes nothing: a schema is JSON.")] = False,
) -> None:
    """Print the JSON Schema of scene files, for editors and validators."""
    if vehicle:
        schema = vehicles.VehicleSpec.model_json_schema()
        print_json({"$schema": "https://json-schema.org/draft/2020-12/schema", **schema})
    else:
        print_json(scenarios.json_schema())
