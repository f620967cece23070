"""What CommonRoad cannot hold (vehicle, margin, names, holes, free states, ...), as JSON in a comment.

The comment never overrules the file. A part of it is believed only if writing that part again gives just what the file
says; so a file that was edited by hand or rewritten by another program is read as it is now.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from tightspot.safe_yaml import UnreadableError, load_json
from tightspot.scenarios.readers.commonroad import elements
from tightspot.scenarios.readers.commonroad.obstacles import Block
from tightspot.scenarios.readers.commonroad.xml_tree import Node

Array = NDArray[np.float64]

KEY = "tightspot-commonroad/1"
_SAME_AREA = 1e-9
_PLAIN = ("name", "description", "source", "vehicle", "margin")


def to_comment(data: Mapping[str, Any]) -> str:
    """The text of a comment that holds the data; :func:`from_comments` reads it."""
    text = json.dumps({"format": KEY, **data}, allow_nan=False).replace("--", "-\\u002d")  # "--" would end it
    return f" {text} "


def from_comments(root: Node) -> dict[str, Any]:
    """The data in the first comment that is ours; empty if there is none, or none that can be read."""
    for comment in root.comments():
        if KEY not in comment[:100]:
            continue
        try:
            data = load_json(comment)
        except UnreadableError:
            continue
        if isinstance(data, dict) and data.get("format") == KEY:
            return data
    return {}


def plain_fields(data: Mapping[str, Any]) -> dict[str, Any]:
    """The scene's fields that have no counterpart in CommonRoad."""
    return {key: data[key] for key in _PLAIN if key in data}


def confirmed_state(data: Mapping[str, Any], key: str, found: Node, offset: Array) -> dict[str, Any] | None:
    """The comment's ``start`` or ``goal`` if the file still says the same; otherwise ``None``."""
    try:
        if key == "start":
            written = elements.initial_state(data["start"], offset)
        else:
            written = elements.goal_state(data["goal"], data["tolerance"], offset)
    except (KeyError, TypeError, ValueError, ArithmeticError):
        return None
    return dict(data[key]) if elements.same(written, found.element) else None


def confirmed_workspace(data: Mapping[str, Any], root: Node) -> list[Any] | None:
    """The comment's workspace if the file's first lanelet still is it; otherwise ``None``."""
    found = root.find("lanelet")
    corners = data.get("workspace")
    if found is None or not isinstance(corners, list):
        return None
    try:
        written = elements.road(corners, int(found.attribute("id")))
    except (TypeError, ValueError, IndexError, ArithmeticError):
        return None
    return corners if elements.same(written, found.element) else None


def obstacles(data: Mapping[str, Any], blocks: Sequence[Block]) -> tuple[list[dict[str, Any]], list[str]]:
    """The scene file's obstacles for the file's polygons, and the place in the file of each.

    Those that the comment knows come first, in its order, with their names; where it has their corners and holes
    and the file's polygons cover just the same area, with these.
    """
    by_number: dict[int, list[Block]] = {}
    for block in blocks:
        by_number.setdefault(block.number, []).append(block)
    found: list[dict[str, Any]] = []
    paths: list[str] = []
    entries = data.get("obstacles")
    for entry in entries if isinstance(entries, list) else []:
        numbers = _numbers(entry)
        pieces = [piece for number in numbers for piece in by_number.get(number, [])]
        whole = _whole(entry, pieces)
        if whole is not None:
            found.append(whole)
            paths.append(pieces[0].path)
            for number in numbers:
                by_number.pop(number, None)
    for rest in by_number.values():
        found += [{"name": block.name, "vertices": block.ring.tolist()} for block in rest]
        paths += [block.path for block in rest]
    return found, paths


def _numbers(entry: Any) -> list[int]:
    numbers = entry.get("ids") if isinstance(entry, dict) else None
    return [number for number in numbers if isinstance(number, int)] if isinstance(numbers, list) else []


def _whole(entry: Any, pieces: Sequence[Block]) -> dict[str, Any] | None:
    """The comment's obstacle if it is made of the pieces; otherwise ``None``."""
    if not pieces or not isinstance(entry.get("name"), str):
        return None
    if "vertices" not in entry:
        return {"name": entry["name"], "vertices": pieces[0].ring.tolist()} if len(pieces) == 1 else None
    holes = entry.get("holes", [])
    try:
        origin = pieces[0].ring[0]
        polygon = shapely.Polygon(
            np.array(entry["vertices"], float) - origin, [np.array(hole, float) - origin for hole in holes]
        )
        together = shapely.union_all([shapely.Polygon(piece.ring - origin) for piece in pieces])
        apart = shapely.symmetric_difference(polygon, together).area
    except (TypeError, ValueError, shapely.errors.GEOSException):
        return None
    if not apart <= _SAME_AREA * polygon.area:
        return None
    return {key: entry[key] for key in ("name", "vertices", "holes") if key in entry}
