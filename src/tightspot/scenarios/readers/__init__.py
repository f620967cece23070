"""Scenes from files and to files, one module a format; :func:`load` finds out which one a file is in."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tightspot.errors import Problem, SceneError
from tightspot.problems import near, shown
from tightspot.scenarios import library
from tightspot.scenarios.readers.files import exists
from tightspot.scenarios.readers.formats import FORMATS, Format, guess, named
from tightspot.scenarios.readers.given import Given, State
from tightspot.scenarios.readers.saving import save
from tightspot.scenarios.readers.source import Source
from tightspot.scenarios.scenario import Scenario
from tightspot.vehicles import VehicleModel

__all__ = ["FORMATS", "Format", "load", "save"]


def load(
    name_or_path: str | Path,
    *,
    start: State | None = None,
    goal: State | None = None,
    vehicle: VehicleModel | str | Path | Mapping[str, Any] | None = None,
    margin: float | None = None,
    unknown: str | None = None,
    format: str | None = None,  # noqa: A002
) -> Scenario:
    """A built-in scene by name, or a scene from a file.

    The format is guessed from the file's extension and, where that leaves a choice, its content: scenes in YAML and
    JSON, plan files (which hold their scene), GeoJSON and WKT with roles, TPCAP, CommonRoad, and occupancy maps of
    ROS's map_server. A built-in name goes before a file of that name; write ``./vertical`` for the file.

    Args:
        name_or_path: The name or the file.
        start: (x, y, theta[, v[, delta]]) in the file's coordinates, m, rad, m/s, or an object as in a scene file.
            It goes before the file's; an occupancy map has none of its own.
        goal: The same for the goal.
        vehicle: A vehicle, a catalogue's name or a vehicle file in the place of the scene's.
        margin: Clearance to keep, m, in the place of the scene's.
        unknown: What unknown cells of an occupancy map are, ``"occupied"`` (the default) or ``"free"``.
        format: A key of ``tightspot.scenarios.FORMATS``; default: guessed.

    Raises:
        SceneError: With all problems, each with its path in the file, or the file's name if it is unreadable.
        InputError: The format or the vehicle is not known.
    """
    if not isinstance(name_or_path, str | Path) or not str(name_or_path):
        raise SceneError(f"{shown(name_or_path)} is neither the name of a scene nor a file")
    given = Given.of(start, goal, vehicle, margin, unknown)
    text = str(name_or_path)
    if text in library.names():
        return given.over_scenario(library.builtin(text))
    path = Path(text)
    if not path.suffix and not exists(path):
        raise SceneError(Problem(shown(text).strip("'"), _unknown(text)))
    source = Source(path)
    chosen = guess(source) if format is None else named(format)
    return chosen.read(source, given)


def _unknown(text: str) -> str:
    guesses = near(text, library.names(), count=3)
    advice = f"did you mean {' or '.join(guesses)}? " if guesses else ""
    return f"is neither a built-in scene nor a file; {advice}`tightspot scenes` lists the built-in ones"
