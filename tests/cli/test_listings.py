"""``scenes``, ``vehicles``, ``schema``, ``--version``, ``--help``."""

from __future__ import annotations

import pytest

import tightspot
from tightspot import scenarios, vehicles


def test_scenes_as_json_is_a_list_of_objects_with_name(cli):
    result = cli("scenes", "--json")
    assert (result.code, result.err) == (0, "")
    assert [scene["name"] for scene in result.json] == list(scenarios.names())
    assert all(scene["description"] and scene["margin"] >= 0.05 for scene in result.json)


def test_scenes_for_people(cli):
    result = cli("scenes")
    assert result.code == 0
    assert all(name in result.out for name in scenarios.names())


def test_vehicles_as_json_are_vehicle_files(cli):
    result = cli("vehicles", "--json")
    assert [vehicle["name"] for vehicle in result.json] == list(vehicles.CATALOGUE)
    for entry in result.json:
        assert vehicles.from_dict(entry).to_dict() == entry


def test_vehicles_for_people(cli):
    result = cli("vehicles")
    assert result.code == 0
    assert all(name in result.out for name in vehicles.CATALOGUE)


def test_schema_names_every_key_of_a_scene(cli):
    schema = cli("schema").json
    assert schema["$schema"].startswith("https://json-schema.org/")
    assert set(scenarios.builtin("vertical").to_dict()) <= set(schema["properties"])
    assert set(schema["required"]) == {"start", "goal"}


def test_vehicle_schema(cli):
    schema = cli("schema", "--vehicle").json
    assert set(vehicles.vehicle("paper").to_dict()) <= set(schema["properties"])


def test_version(cli):
    result = cli("--version")
    assert (result.code, result.out) == (0, f"tightspot {tightspot.__version__}\n")


@pytest.mark.parametrize("command", ["plan", "verify", "show", "scenes", "vehicles", "schema"])
def test_help(command, cli):
    result = cli(command, "--help")
    assert result.code == 0
    assert f"tightspot {command}" in result.out
