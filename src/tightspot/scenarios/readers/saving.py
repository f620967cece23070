"""Scenes to files. What a format cannot hold is refused, or left out on demand and named: never lost in silence."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tightspot.errors import InputError, Problem
from tightspot.files import atomic_write
from tightspot.geometry import wrap_angle
from tightspot.scenarios.readers.formats import Format, for_writing
from tightspot.scenarios.readers.given import Given
from tightspot.scenarios.readers.source import Source
from tightspot.scenarios.scenario import Scenario

MINOR = {
    "name": "the name: it is read as the file's name",
    "description": "the description",
    "source": "where the geometry comes from",
    "obstacle names": "the obstacles' names",
    "headings": "whole turns of the headings: they are read within (-pi, pi]",
}
"""What may be left out without being asked, since the problem to be solved stays the same."""
_SAME_HEADING = 1e-12  # rad


def save(
    scenario: Scenario,
    path: str | Path,
    *,
    format: str | None = None,  # noqa: A002
    lossy: bool = False,
) -> list[str]:
    """Write the scene to a file from which :func:`tightspot.load` reads the same scene, bit for bit.

    The text is read again before the file is written, so this holds, or the file is refused.

    Args:
        scenario: The scene.
        path: Where to; a file of that name is replaced, completely or not at all.
        format: A key of :data:`tightspot.scenarios.FORMATS`; default: by the extension.
        lossy: Whether what the format cannot hold may be left out.

    Returns:
        What was left out, in words. Without ``lossy`` that is at most a name, a description and the like.

    Raises:
        InputError: The format is not known or cannot hold the scene, or the file cannot be written.
    """
    path = Path(path)
    chosen, write = for_writing(path, format)
    text = write(scenario)
    lost = _differences(scenario.to_dict(), _read_again(text, chosen, path).to_dict())
    problems = [
        Problem(field, f"{chosen.title} files cannot hold it: {what}; add --lossy (lossy=True in Python) to do without")
        for field, what in lost.items()
        if field not in MINOR
    ]
    if problems and not lossy:
        raise InputError(problems)
    try:
        atomic_write(path, text)
    except OSError as error:
        raise InputError(Problem(str(path), f"cannot be written: {(error.strerror or str(error)).lower()}")) from None
    return [what if field in MINOR else f"{field}: {what}" for field, what in lost.items()]


def _read_again(text: str, format_: Format, path: Path) -> Scenario:
    with tempfile.TemporaryDirectory() as directory:
        copy = Path(directory) / (path.name or "scene")
        copy.write_text(text, encoding="utf-8")
        return format_.read(Source(copy), Given())


def _differences(before: Mapping[str, Any], after: Mapping[str, Any]) -> dict[str, str]:
    """What of a scene object is different after reading it again: fields, and in words what becomes of them."""
    lost = {key: MINOR[key] for key in ("name", "description", "source") if before[key] != after[key]}
    for key in ("vehicle", "margin", "tolerance", "workspace"):
        if before[key] != after[key]:
            lost[key] = f"it is read as {_short(after[key])}"
    for key in ("start", "goal"):
        turned = abs(float(wrap_angle(before[key]["theta"] - after[key]["theta"])))
        if turned <= _SAME_HEADING and before[key]["theta"] != after[key]["theta"]:
            lost["headings"] = MINOR["headings"]
        changed = {
            k: v for k, v in after[key].items() if v != before[key][k] and (k != "theta" or turned > _SAME_HEADING)
        }
        if changed:
            lost[key] = "it is read with " + ", ".join(f"{name} {_short(value)}" for name, value in changed.items())
    rings = [[(o["vertices"], o.get("holes", [])) for o in scene["obstacles"]] for scene in (before, after)]
    if rings[0] != rings[1]:
        filled = [(a[0], []) for a in rings[0]] == rings[1]
        lost["obstacles"] = "their holes are read as filled" if filled else "their corners are read as others"
    if [o["name"] for o in before["obstacles"]] != [o["name"] for o in after["obstacles"]]:
        lost["obstacle names"] = MINOR["obstacle names"]
    return lost


def _short(value: Any) -> str:
    if isinstance(value, list):
        corners = [f"({x:g}, {y:g})" for x, y in value[:4]]
        return " ".join(corners) + (" ..." if len(value) > 4 else "")
    if isinstance(value, Mapping):
        return "the default" if "position" in value else "another"
    return repr(value) if isinstance(value, str) else f"{value:g}" if isinstance(value, float) else str(value)
