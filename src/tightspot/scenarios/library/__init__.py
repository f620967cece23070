"""The built-in scenes, one YAML file each: three of the paper's and four that show what the tool is for."""

from __future__ import annotations

from functools import cache
from importlib import resources
from typing import Any

from tightspot.errors import Problem, SceneError
from tightspot.problems import near, shown
from tightspot.safe_yaml import load_yaml
from tightspot.scenarios.scenario import Scenario

_NAMES = ("vertical", "parallel", "oblique", "garage", "dead-end", "loading-dock", "forklift-pallet")


def names() -> tuple[str, ...]:
    """The built-in scenes' names."""
    return _NAMES


@cache
def builtin(name: str) -> Scenario:
    """The built-in scene of that name; raises :class:`SceneError` with the nearest names if there is none."""
    if name not in _NAMES:
        guesses = near(name, _NAMES) or _NAMES
        raise SceneError(
            Problem("scene", f"{shown(name)} is not a built-in scene; did you mean {' or '.join(guesses)}?")
        )
    text = resources.files(__package__).joinpath(f"{name}.yaml").read_text(encoding="utf-8")
    return Scenario.from_dict(load_yaml(text), name=name)


def summaries() -> list[dict[str, Any]]:
    """One plain object a scene, as ``tightspot scenes --json`` prints them."""
    scenes = [builtin(name) for name in _NAMES]
    return [
        {
            "name": scene.name,
            "description": scene.description,
            "source": scene.source,
            "vehicle": scene.vehicle,
            "obstacles": len(scene.obstacles),
            "parts": len(scene.obstacle_parts),
            "margin": scene.margin,
        }
        for scene in scenes
    ]
