"""What planner and judge see of the obstacles: those that touch made one, in few convex parts, never too small."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from tightspot.errors import GeometryError
from tightspot.geometry import ConvexPolygon, PolygonStack, convex_parts, covers
from tightspot.geometry.solids import polygons_in
from tightspot.scenarios.obstacle import Obstacle, unique_names

TOLERANCE = 1e-3
"""Solids reach out of the obstacles by at most this, m, and never fall short of them."""
HAIR = 1e-8
"""By this, m, parts are grown if rounding left cracks between them."""
MANY_PAIRS = 200_000
"""Pairs of polygons that are looked at; beyond, they are united first."""
MANY_PARTS = 500
"""Parts of one obstacle, which are few as they are; beyond, none are merged."""
_SHARE = 0.4 * TOLERANCE  # for merging, and again for simplifying; the rest is left to decomposition


@dataclass(frozen=True, eq=False)
class Member:
    """Something of which solids are made.

    Attributes:
        name: For people.
        parts: Convex parts that cover its polygons.
        pieces: Its polygons, valid, for shapely; ``None`` if the one part is all of it.
    """

    name: str
    parts: tuple[ConvexPolygon, ...]
    pieces: tuple[shapely.Polygon, ...] | None = None

    @property
    def polygons(self) -> tuple[shapely.Polygon, ...]:
        """Valid, for shapely."""
        return tuple(part.to_shapely() for part in self.parts) if self.pieces is None else self.pieces


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
    if obstacle.is_plain:
        return Member(obstacle.name, obstacle.parts)
    corners = np.concatenate(obstacle.rings)
    return Member(obstacle.name, tuple(covers.reaching(obstacle.parts, corners)), obstacle.polygons)


def solids(members: Sequence[Member]) -> tuple[Solid, ...]:
    """The members, grouped by touching, in the order of each group's first one."""
    groups = _touching(members)
    names = unique_names([_joined([members[i].name for i in group]) for group in groups])
    final = _final(members)
    found = []
    for name, group in zip(names, groups, strict=True):
        first = members[group[0]]
        if len(group) == 1 and final[group[0]]:
            found.append(Solid(name, (first.name,), first.parts, (first.name,)))
        else:
            found.append(_solid(name, [members[i] for i in group]))
    return tuple(found)


def _final(members: Sequence[Member]) -> list[bool]:
    """Which members are one convex part that cannot be simplified."""
    whole = np.flatnonzero([member.pieces is None for member in members])
    final = np.zeros(len(members), dtype=bool)
    final[whole] = ~covers.can_be_simplified(PolygonStack(members[i].parts[0] for i in whole.tolist()), _SHARE)
    return final.tolist()


def _solid(name: str, members: Sequence[Member]) -> Solid:
    region = [polygon for member in members for polygon in member.polygons]
    parts, labels = _heap(name, region) if _is_heap(region) else _cover(members, region)
    closed = _uncracked(parts, region)
    if closed is None:
        closed = tuple(part for member in members for part in member.parts)
        labels = [member.name for member in members for _ in member.parts]
    return Solid(name, tuple(member.name for member in members), closed, tuple(labels))


def _cover(members: Sequence[Member], region: list[shapely.Polygon]) -> tuple[list[ConvexPolygon], list[str]]:
    """The members' parts, as far as possible merged, and the names of the obstacles in each."""
    owners: dict[ConvexPolygon, list[str]] = {}
    for member in members:
        for part in member.parts:
            owners.setdefault(part, []).append(member.name)
    parts = list(owners)
    merged = [covers.Merged(part, (i,)) for i, part in enumerate(parts)]
    if len(parts) > 1 and (len(members) > 1 or len(parts) <= MANY_PARTS):
        merged = covers.merged(parts, shapely.union_all([*region, *(p.to_shapely() for p in parts)]), _SHARE)
    names = ((name for i in item.indices for name in owners[parts[i]]) for item in merged)
    labels = [_joined(list(dict.fromkeys(of_part))) for of_part in names]
    return [covers.simplified(item.polygon, _SHARE) for item in merged], labels


def _heap(name: str, region: list[shapely.Polygon]) -> tuple[list[ConvexPolygon], list[str]]:
    """Convex parts of the union, none if rounding forbids it; who is in which of them nobody wants to know."""
    try:
        parts = convex_parts(polygons_in(shapely.union_all(region)), name)
    except GeometryError:
        return [], []
    return [covers.simplified(part, _SHARE) for part in parts], [name] * len(parts)


def _is_heap(polygons: Sequence[shapely.Polygon]) -> bool:
    """Whether so many polygons lie over each other that pairs of them are too many to look at; by a sample."""
    if len(polygons) ** 2 <= MANY_PAIRS:
        return False
    sample = [polygons[i] for i in np.linspace(0, len(polygons) - 1, 100).astype(int)]
    return len(shapely.STRtree(polygons).query(sample)[0]) / len(sample) * len(polygons) > MANY_PAIRS


def _uncracked(parts: Sequence[ConvexPolygon], region: Sequence[shapely.Polygon]) -> tuple[ConvexPolygon, ...] | None:
    """The parts, grown by a hair if they do not cover the polygons to the last bit; ``None`` if that does not help."""
    for hair in (0.0, HAIR):
        grown = tuple(covers.grown(part, hair) if hair else part for part in parts)
        cover = shapely.union_all([part.to_shapely() for part in grown])
        shapely.prepare(cover)
        if shapely.covers(cover, region).all():
            return grown
    return None


def _touching(members: Sequence[Member]) -> list[list[int]]:
    """Indices of members that are connected by gaps of at most the tolerance."""
    group = list(range(len(members)))

    def root(i: int) -> int:
        while group[i] != i:
            group[i] = group[group[i]]
            i = group[i]
        return i

    polygons, owner = _all_polygons(members)
    for p, q in _near(polygons):
        low, high = sorted((root(owner[p]), root(owner[q])))
        group[high] = low
    found: dict[int, list[int]] = {}
    for i in range(len(members)):
        found.setdefault(root(i), []).append(i)
    return list(found.values())


def _all_polygons(members: Sequence[Member]) -> tuple[list[shapely.Polygon], list[int]]:
    """The members' polygons and the index of each one's member; those of one part come last."""
    pieces = [(polygon, i) for i, member in enumerate(members) for polygon in member.pieces or ()]
    whole = [i for i, member in enumerate(members) if member.pieces is None]
    stack = PolygonStack(members[i].parts[0] for i in whole)
    rings = shapely.linearrings(stack.vertices, indices=np.repeat(np.arange(len(stack)), np.diff(stack.first)))
    polygons = [polygon for polygon, _ in pieces] + shapely.polygons(rings).tolist()
    return polygons, [i for _, i in pieces] + whole


def _near(polygons: list[shapely.Polygon]) -> list[list[int]]:
    """Pairs of polygons (indices) no farther apart than the tolerance, or enough of them to connect all such."""
    if not polygons:
        return []
    if not _is_heap(polygons):
        pairs = shapely.STRtree(polygons).query(polygons, predicate="dwithin", distance=TOLERANCE)
        return [[int(p), int(q)] for p, q in pairs.T]
    grown = shapely.buffer(polygons, TOLERANCE / 2, join_style="mitre")
    islands = shapely.get_parts(shapely.union_all(grown))
    places, island = shapely.STRtree(islands).query(shapely.point_on_surface(polygons), predicate="intersects")
    first: dict[int, int] = {}
    return [[first.setdefault(i, p), p] for p, i in zip(places.tolist(), island.tolist(), strict=True)]


def _joined(names: Sequence[str]) -> str:
    return "+".join(names) if len(names) <= 3 else f"{names[0]}+{names[1]}+{len(names) - 2} more"
