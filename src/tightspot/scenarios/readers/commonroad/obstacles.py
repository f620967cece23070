"""CommonRoad's obstacles as polygons that stand still, and what to do about those that do not."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem, SceneError
from tightspot.scenarios.readers.commonroad.shapes import placements, point, rings
from tightspot.scenarios.readers.commonroad.xml_tree import Node

Array = NDArray[np.float64]

Moving = Literal["refuse", "initial", "ignore"]
"""Obstacles that move: refuse the file, let them stand where they are at the beginning, or leave them out."""
MOVING: tuple[Moving, ...] = get_args(Moving)

_TAGS = ("staticObstacle", "dynamicObstacle", "phantomObstacle", "environmentObstacle", "obstacle")
_IN_PLACE = ("environmentObstacle", "phantomObstacle")
"""Their shapes are in the scenario's coordinates."""


@dataclass(frozen=True)
class Block:
    """A polygon that must not be touched.

    Attributes:
        name: For people, for example ``parkedVehicle-12``.
        number: CommonRoad's id of the obstacle; several blocks may have the same.
        ring: Its corners in the file's coordinates, m, (n, 2).
        path: Its obstacle's place in the file.
    """

    name: str
    number: int
    ring: Array
    path: str


def checked_moving(moving: str) -> Moving:
    """The policy if there is such a one; raises :class:`InputError` with those there are."""
    for known in MOVING:
        if moving == known:
            return known
    raise InputError(Problem("moving", f"{moving!r} is not known; it is one of {', '.join(MOVING)}"))


def read_obstacles(root: Node, moving: Moving) -> tuple[list[Block], list[str], list[Problem]]:
    """All obstacles of a scenario, in the file's order.

    Returns:
        Their polygons; sentences on what was changed; and what is wrong with the others.
    """
    blocks: list[Block] = []
    movers: list[str] = []
    doubled: list[str] = []
    problems: list[Problem] = []
    for node in root.children(*_TAGS):
        try:
            if _moves(node):
                movers.append(node.attribute("id") or "without id")
                if moving != "initial":
                    continue
            found, twice = _blocks(node)
            blocks += found
            doubled += [node.attribute("id")] * twice
        except SceneError as error:
            problems += error.problems
    if movers and moving == "refuse":
        problems.insert(0, Problem("dynamicObstacle", _refusal(movers)))
    return blocks, _notes(movers, moving, doubled), problems


def pose_of(state: Node) -> Array:
    """(x m, y m, theta rad) of a state whose position and orientation are exact.

    Raises:
        SceneError: One of them is missing, a region or an interval.
    """
    position, orientation = state.child("position"), state.child("orientation")
    if position.find("point") is None:
        raise position.refuse("is a region; only a single point is read here")
    return np.array([*point(position.child("point")), _exact(orientation).angle()])


def exact(node: Node) -> float:
    """The ``exact`` value in an element; raises :class:`SceneError` if it is an interval."""
    return _exact(node).number()


def _exact(node: Node) -> Node:
    if node.find("exact") is None and node.find("intervalStart") is not None:
        raise node.refuse("is an interval; only an exact value is read here")
    return node.child("exact")


def _blocks(node: Node) -> tuple[list[Block], bool]:
    """The obstacle's polygons, and whether one of them is in two places."""
    number = _number(node)
    first = node.child("occupancySet").child("occupancy") if node.tag == "phantomObstacle" else node
    found = rings(first.child("shape"))
    count = len(found)
    if node.tag not in _IN_PLACE:
        pose = pose_of(node.child("initialState"))
        found = [place for ring in found for place in placements(ring, pose)]
    name = f"{_kind(node)}-{number}"
    names = [name] if len(found) == 1 else [f"{name}/{index}" for index in range(len(found))]
    blocks = [Block(name, number, ring, node.path) for name, ring in zip(names, found, strict=True)]
    return blocks, len(found) > count


def _number(node: Node) -> int:
    text = node.attribute("id")
    if not re.fullmatch(r"\d{1,18}", text):
        raise node.refuse(f"has the id {text[:40]!r}; it must be a whole number above 0")
    return int(text)


def _kind(node: Node) -> str:
    kind = node.find("type")
    return kind.text if kind and re.fullmatch(r"\w{1,40}", kind.text, re.ASCII) else "obstacle"


def _moves(node: Node) -> bool:
    """True unless the obstacle stands where its initial state is for all times that the file knows of."""
    role = node.find("role")
    if node.tag in ("staticObstacle", "environmentObstacle") or (role and role.text == "static"):
        return False
    trajectory = node.find("trajectory")
    if node.tag == "phantomObstacle" or trajectory is None:
        return True
    standing = pose_of(node.child("initialState"))
    return not all(pose is not None and np.array_equal(pose, standing) for pose in _poses(trajectory))


def _poses(trajectory: Node) -> Iterator[Array | None]:
    for state in trajectory.children("state"):
        try:
            yield pose_of(state)
        except SceneError:  # a region or an interval: not known to stand
            yield None


def _refusal(movers: list[str]) -> str:
    return (
        f"{_these(movers)} moving; tightspot plans among obstacles that stand still. Read them as standing where they "
        'begin (moving="initial"; on the command line: tightspot convert IN OUT --moving initial) or leave them out '
        '(moving="ignore"); a plan is then certified for that only'
    )


def _notes(movers: list[str], moving: Moving, doubled: list[str]) -> list[str]:
    notes = []
    if movers and moving != "refuse":
        done = "read as standing where they begin" if moving == "initial" else "left out"
        notes.append(f"{_these(movers)} moving in the file and {done}: a plan is certified for that only.")
    if doubled:
        why = "turned with a shape off its centre, which CommonRoad's programs place differently: both places are taken"
        notes.append(f"{_these(doubled)} {why}.")
    return notes


def _these(numbers: list[str]) -> str:
    some = ", ".join(numbers[:5]) + (", …" if len(numbers) > 5 else "")
    return f"{len(numbers)} obstacle{'s are' if len(numbers) > 1 else ' is'} ({some})"
