"""tightspot's own files: scenes (``tightspot-scene/1``) in YAML or JSON, and the scene inside a plan file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import yaml

from tightspot.errors import Problem, SceneError
from tightspot.problems import join, shown
from tightspot.scenarios.readers.files import refuse
from tightspot.scenarios.readers.given import Given
from tightspot.scenarios.readers.json_text import json_lines
from tightspot.scenarios.readers.source import Source
from tightspot.scenarios.scenario import Scenario

PLAN_FORMAT = "tightspot-plan/1"

_Dumper: Any = getattr(yaml, "CSafeDumper", yaml.SafeDumper)


def read_yaml(source: Source, given: Given) -> Scenario:
    """The scene in a YAML file; raises :class:`SceneError`."""
    return _scenario(source, source.yaml, given)


def read_json(source: Source, given: Given) -> Scenario:
    """The scene in a JSON file or in a plan file; raises :class:`SceneError`."""
    return _scenario(source, source.json, given)


def to_yaml(scenario: Scenario) -> str:
    """The scene file's text; points and states stand in one line each."""
    text: str = yaml.dump(
        scenario.to_dict(), Dumper=_Dumper, sort_keys=False, default_flow_style=None, allow_unicode=True, width=1000
    )
    return text


def to_json(scenario: Scenario) -> str:
    """The scene file's text."""
    return json_lines(scenario.to_dict())


def _scenario(source: Source, data: Any, given: Given) -> Scenario:
    if data is None:
        raise refuse(source.path, "is empty")
    if not isinstance(data, Mapping):
        sentence = f"holds {shown(data)}, not a scene; `tightspot schema` prints what a scene file holds"
        raise refuse(source.path, sentence)
    if not (isinstance(data.get("format"), str) and data["format"].startswith("tightspot-plan/")):
        return Scenario.from_dict(given.over(data), name=source.name)
    if data["format"] != PLAN_FORMAT:
        raise SceneError(
            Problem("format", f"{shown(data['format'])} is not known to this version; it must be {PLAN_FORMAT!r}")
        )
    if "scenario" not in data:
        raise SceneError(Problem("scenario", "is missing: this plan file has no scene in it"))
    scene = data["scenario"]
    try:
        return Scenario.from_dict(given.over(scene) if isinstance(scene, Mapping) else scene, name=source.name)
    except SceneError as error:
        raise SceneError([Problem(join("scenario", p.path), p.message) for p in error.problems]) from None
