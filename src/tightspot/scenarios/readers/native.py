"""tightspot's own files: scenes (``tightspot-scene/1``) in YAML or JSON, and the scene inside a plan file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tightspot.errors import Problem, SceneError
from tightspot.problems import join, shown
from tightspot.safe_yaml import UnreadableError, load_json, load_yaml
from tightspot.scenarios.readers.files import read_text, refuse
from tightspot.scenarios.scenario import Scenario

PLAN_FORMAT = "tightspot-plan/1"


def read_yaml(path: Path) -> Scenario:
    """The scene in a YAML file; raises :class:`SceneError`."""
    return _scenario(path, _parsed(path, load_yaml))


def read_json(path: Path) -> Scenario:
    """The scene in a JSON file or in a plan file; raises :class:`SceneError`."""
    return _scenario(path, _parsed(path, load_json))


def _parsed(path: Path, parse: Any) -> Any:
    text = read_text(path)
    try:
        return parse(text)
    except UnreadableError as error:
        raise refuse(path, str(error)) from None


def _scenario(path: Path, data: Any) -> Scenario:
    if data is None:
        raise refuse(path, "is empty")
    if not isinstance(data, Mapping):
        raise refuse(path, f"holds {shown(data)}, not a scene; `tightspot schema` prints what a scene file holds")
    if not (isinstance(data.get("format"), str) and data["format"].startswith("tightspot-plan/")):
        return Scenario.from_dict(data, name=path.stem)
    if data["format"] != PLAN_FORMAT:
        raise SceneError(
            Problem("format", f"{shown(data['format'])} is not known to this version; it must be {PLAN_FORMAT!r}")
        )
    if "scenario" not in data:
        raise SceneError(Problem("scenario", "is missing: this plan file has no scene in it"))
    try:
        return Scenario.from_dict(data["scenario"], name=path.stem)
    except SceneError as error:
        raise SceneError([Problem(join("scenario", p.path), p.message) for p in error.problems]) from None
