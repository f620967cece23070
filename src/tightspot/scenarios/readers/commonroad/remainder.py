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
import shapely.affinity
from numpy.typing import NDArray

from tightspot.errors import GeometryError, SceneError
from tightspot.safe_yaml import UnreadableError, load_json
from tightspot.scenarios.obstacle import Obstacle
from tightspot.scenarios.readers.commonroad import elements
from tightspot.scenarios.readers.commonroad.lanelets import read_lanelet
from tightspot.scenarios.readers.commonroad.obstacles import Block
from tightspot.scenarios.readers.commonroad.xml_tree import Node
from tightspot.scenarios.schema import LARGEST_COORDINATE

Array = NDArray[np.float64]

KEY = "tightspot-commonroad/1"
_SAME_AREA = 1e-9
"""Areas that differ by less than this share of them are the same."""
_UNUSABLE = (KeyError, TypeError, ValueError, IndexError, ArithmeticError, shapely.errors.GEOSException)
"""What a comment that somebody has changed may lead to."""
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
    except _UNUSABLE:
        return None
    return dict(data[key]) if elements.same(written, found.element) else None


def confirmed_workspace(data: Mapping[str, Any], root: Node, blocks: Sequence[Block]) -> tuple[Any | None, list[Block]]:
    """The comment's workspace if the file still says the same, and the obstacles that are not part of it.

    The file says it if the first lanelet without the obstacles that the comment calls walls covers just the same area.
    """
    found, workspace = root.find("lanelet"), data.get("workspace")
    if found is None or workspace is None:
        return None, list(blocks)
    numbers = _numbers(data, "walls")
    walls = [block for block in blocks if block.number in numbers]
    try:
        road = read_lanelet(found)
        origin = road.right[0]
        rings = [workspace["vertices"], *workspace.get("holes", [])] if isinstance(workspace, dict) else [workspace]
        exterior, *holes = (np.array(ring, float) - origin for ring in rings)
        left = shapely.affinity.translate(road.outline, *-origin).difference(_together(walls, origin))
        same = _same_area(shapely.Polygon(exterior, holes), left)
    except (*_UNUSABLE, SceneError):
        return None, list(blocks)
    return (workspace, [block for block in blocks if block not in walls]) if same else (None, list(blocks))


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
        numbers = _numbers(entry, "ids")
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


def _numbers(entry: Any, key: str) -> list[int]:
    numbers = entry.get(key) if isinstance(entry, dict) else None
    return [number for number in numbers if isinstance(number, int)] if isinstance(numbers, list) else []


def _whole(entry: Any, pieces: Sequence[Block]) -> dict[str, Any] | None:
    """The comment's obstacle if it is made of the pieces; otherwise ``None``."""
    if not pieces or not isinstance(entry.get("name"), str):
        return None
    if "vertices" not in entry:
        return {"name": entry["name"], "vertices": pieces[0].ring.tolist()} if len(pieces) == 1 else None
    try:
        origin = pieces[0].ring[0]
        exterior, *holes = (np.array(ring, float) - origin for ring in (entry["vertices"], *entry.get("holes", [])))
        solid = shapely.union_all(Obstacle("", exterior, tuple(holes)).polygons)
        same = _same_area(solid, _together(pieces, origin))
    except (*_UNUSABLE, GeometryError):
        return None
    return {key: entry[key] for key in ("name", "vertices", "holes") if key in entry} if same else None


def _together(blocks: Sequence[Block], origin: Array) -> shapely.Geometry:
    return shapely.union_all([shapely.Polygon(block.ring - origin) for block in blocks])


def _same_area(one: shapely.Geometry, other: shapely.Geometry) -> bool:
    if not (np.abs([one.bounds, other.bounds]) <= LARGEST_COORDINATE).all():  # nor is what is empty: its bounds are NaN
        return False
    return bool(shapely.symmetric_difference(one, other).area <= _SAME_AREA * one.area)
