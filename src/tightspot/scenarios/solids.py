"""What planner and judge see of the obstacles: those that touch made one, in few convex parts, never too small."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from tightspot.geometry import ConvexPolygon, covers
from tightspot.scenarios.obstacle import Obstacle, unique_names

TOLERANCE = 1e-3
"""Solids reach out of the obstacles by at most this, m, and never fall short of them."""
HAIR = 1e-8
"""By this, m, parts are grown if rounding left cracks between them."""
_SHARE = 0.4 * TOLERANCE  # for merging, and again for simplifying; the rest is left to decomposition


@dataclass(frozen=True, eq=False)
class Member:
    """Something of which solids are made.

    Attributes:
        name: For people.
        polygons: Valid, for shapely.
        parts: Convex parts that cover them.
    """

    name: str
    polygons: tuple[shapely.Polygon, ...]
    parts: tuple[ConvexPolygon, ...]


@dataclass(frozen=True, eq=False)
class Solid:
    """Obstacles that overlap or touch (within 1 mm), or a single one.

    Attributes:
        name: The obstacle's, or ``a+b``; of more than three ``a+b+2 more``. Unique in its scenario.
        members: Names of the obstacles.
        parts: Convex parts that cover the obstacles and reach out of them by at most 1 mm. They may overlap.
        labels: For each part the names of the obstacles that are in it, shortened like ``name``.
    """

    name: str
    members: tuple[str, ...]
    parts: tuple[ConvexPolygon, ...]
    labels: tuple[str, ...]


def member_of(obstacle: Obstacle) -> Member:
    """The obstacle with parts in which all its corners lie, also those that its own parts leave to rounding."""
    corners = np.concatenate(obstacle.rings)
    return Member(obstacle.name, obstacle.polygons, tuple(covers.reaching(obstacle.parts, corners)))


def solids(members: Sequence[Member]) -> tuple[Solid, ...]:
    """The members, grouped by touching, in the order of each group's first one."""
    groups = _touching(members)
    names = unique_names([_joined([members[i].name for i in group]) for group in groups])
    return tuple(_solid(name, [members[i] for i in group]) for name, group in zip(names, groups, strict=True))


def _solid(name: str, members: Sequence[Member]) -> Solid:
    parts = [part for member in members for part in member.parts]
    owners = [member.name for member in members for _ in member.parts]
    region = [polygon for member in members for polygon in member.polygons]
    merged = [covers.Merged(part, (i,)) for i, part in enumerate(parts)]
    if len(parts) > 1:
        merged = covers.merged(parts, shapely.union_all([*region, *(p.to_shapely() for p in parts)]), _SHARE)
    return Solid(
        name=name,
        members=tuple(member.name for member in members),
        parts=_uncracked([covers.simplified(item.polygon, _SHARE) for item in merged], region),
        labels=tuple(_joined(list(dict.fromkeys(owners[i] for i in item.indices))) for item in merged),
    )


def _uncracked(parts: Sequence[ConvexPolygon], region: Sequence[shapely.Polygon]) -> tuple[ConvexPolygon, ...]:
    """The parts, grown by a hair if they do not cover the polygons to the last bit."""
    cover = shapely.union_all([part.to_shapely() for part in parts])
    shapely.prepare(cover)
    if shapely.covers(cover, region).all():
        return tuple(parts)
    return tuple(ConvexPolygon.from_halfplanes(part.A, part.b + HAIR) for part in parts)


def _touching(members: Sequence[Member]) -> list[list[int]]:
    """Indices of members that are connected by gaps of at most the tolerance."""
    group = list(range(len(members)))

    def root(i: int) -> int:
        while group[i] != i:
            group[i] = group[group[i]]
            i = group[i]
        return i

    polygons = [polygon for member in members for polygon in member.polygons]
    owner = [i for i, member in enumerate(members) for _ in member.polygons]
    pairs = shapely.STRtree(polygons).query(polygons, predicate="dwithin", distance=TOLERANCE) if polygons else ()
    for p, q in np.transpose(pairs).tolist():
        low, high = sorted((root(owner[p]), root(owner[q])))
        group[high] = low
    found: dict[int, list[int]] = {}
    for i in range(len(members)):
        found.setdefault(root(i), []).append(i)
    return list(found.values())


def _joined(names: Sequence[str]) -> str:
    return "+".join(names) if len(names) <= 3 else f"{names[0]}+{names[1]}+{len(names) - 2} more"
