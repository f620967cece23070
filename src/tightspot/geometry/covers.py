"""Covers of polygons by few convex parts that may overlap, and reach out a little but never fall short.

A decomposition keeps the parts inside; a cover may be coarser. Two parts are replaced by their convex hull if
that reaches out of the covered region by no more than a tolerance. A hull has no corner that its points had not,
so nothing is uncovered by rounding, and many touching or overlapping polygons (the panels of a wall, the cells of
a map) become few parts.
"""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from tightspot.errors import GeometryError
from tightspot.geometry.polygon import ConvexPolygon
from tightspot.geometry.stack import PolygonStack

Array = NDArray[np.float64]

_FARTHEST_STEP = 10.0
_QUARTER_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])


class Merged(NamedTuple):
    """A convex part in the place of others.

    Attributes:
        polygon: Contains the others.
        indices: Which ones, by their place in the list that was merged.
    """

    polygon: ConvexPolygon
    indices: tuple[int, ...]


def hull(points: Array) -> ConvexPolygon:
    """The convex hull of points (n, 2) m; no point lies outside but by rounding.

    Raises:
        GeometryError: It is no wider than rounding.
    """
    ring = shapely.get_coordinates(shapely.MultiPoint(points).convex_hull)
    return containing(ConvexPolygon.from_vertices(ring), points)


def containing(polygon: ConvexPolygon, points: Array) -> ConvexPolygon:
    """The polygon with its edges moved outward until no point (n, 2) m lies outside; itself if none does."""
    rounding = 16 * np.finfo(float).eps * float(np.abs(points).max())
    excess = (points @ polygon.A.T).max(axis=0) - polygon.b
    if (excess <= rounding).all():
        return polygon
    return ConvexPolygon.from_halfplanes(polygon.A, polygon.b + np.maximum(excess, 0.0) + rounding)


def grown(polygon: ConvexPolygon, distance: float) -> ConvexPolygon:
    """The polygon with all its edges moved outward by ``distance`` m.

    Corners of less than 11 degrees are cut off so that none moves by more than ten times the distance: a sliver's tip
    would run away.
    """
    normal, following = polygon.A, np.roll(polygon.A, -1, axis=0)
    step = (normal + following) / (1.0 + (normal * following).sum(axis=1, keepdims=True))
    sharp = np.hypot(*step.T) > _FARTHEST_STEP
    if not sharp.any():
        return ConvexPolygon.from_vertices(polygon.vertices + distance * step)
    ahead, back = normal @ _QUARTER_TURN.T, following @ _QUARTER_TURN.T
    caps = [polygon.vertices[sharp] + distance * way[sharp] for way in (normal + ahead, following - back)]
    return hull(np.concatenate([polygon.vertices[~sharp] + distance * step[~sharp], *caps]))


def reaching(parts: Sequence[ConvexPolygon], points: Array) -> list[ConvexPolygon]:
    """The parts, widened where need be so that each of the points (n, 2) m lies in one of them.

    A decomposition leaves out vertices that are on a line with their neighbours but for rounding; this takes
    them in again. The part to which a point is nearest is widened.
    """
    corners = {corner for part in parts for corner in map(tuple, part.vertices.tolist())}
    missing = np.array([point for point in points.tolist() if tuple(point) not in corners]).reshape(-1, 2)
    nearest = np.array([_nearest(parts, point) for point in missing], dtype=np.intp)
    widened = list(parts)
    for i in np.unique(nearest):
        widened[i] = containing(parts[i], missing[nearest == i])
    return widened


def _nearest(parts: Sequence[ConvexPolygon], point: Array) -> int:
    """The part outside of which the point lies least."""
    return int(np.argmin([(part.A @ point - part.b).max() for part in parts]))


def simplified(polygon: ConvexPolygon, tolerance: float) -> ConvexPolygon:
    """The polygon without edges that can be left out by extending their neighbours by at most ``tolerance`` m.

    The result contains the polygon and reaches out of it by no more than that; it is the polygon itself if none is
    left out.
    """
    V = polygon.vertices
    shape = polygon.to_shapely()
    while len(V) > 3:
        corner, height = _corners(V, np.roll(V, 1, axis=0), np.roll(V, 2, axis=0), np.roll(V, -1, axis=0))
        near = np.flatnonzero(height <= tolerance)
        for i in near[np.argsort(height[near], kind="stable")]:
            if shape.distance(shapely.Point(corner[i])) <= tolerance:
                V = np.insert(np.delete(V, [i - 1, i], axis=0), i - 1 if i else len(V) - 2, corner[i], axis=0)
                break
        else:
            break
    if V is polygon.vertices:
        return polygon
    try:
        return hull(np.concatenate([V, polygon.vertices]))
    except GeometryError:
        return polygon


def can_be_simplified(polygons: PolygonStack, tolerance: float) -> NDArray[np.bool_]:
    """Of which polygons :func:`simplified` may leave out an edge; of the others it leaves none out. (len,)."""
    if not len(polygons):
        return np.zeros(0, dtype=bool)
    V, first, sizes = polygons.vertices, polygons.first[:-1], np.diff(polygons.first)
    previous, following = np.arange(len(V)) - 1, np.arange(len(V)) + 1
    previous[first], following[first + sizes - 1] = first + sizes - 1, first
    _, height = _corners(V, V[previous], V[previous[previous]], V[following])
    return np.asarray((sizes > 3) & (np.minimum.reduceat(height, first) <= tolerance))


def _corners(end: Array, start: Array, before_start: Array, after_end: Array) -> tuple[Array, Array]:
    """Where the edges before and after each edge, from ``start`` to ``end``, meet, and how far outside the edge."""
    before, along, after = start - before_start, end - start, after_end - end
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (along[:, 0] * after[:, 1] - along[:, 1] * after[:, 0]) / turn
        corner = start + s[:, None] * before
        height = np.abs(before[:, 0] * along[:, 1] - before[:, 1] * along[:, 0]) * s / np.hypot(*along.T)
    return corner, np.where((turn > 0) & (s > 0), height, np.inf)


def merged(parts: Sequence[ConvexPolygon], region: shapely.Geometry, tolerance: float) -> list[Merged]:
    """Fewer convex parts that cover the same parts; those that stay come first, in their order.

    Args:
        parts: What must stay covered.
        region: What they cover together, or more.
        tolerance: How far the result may reach out of the region, m.
    """
    allowed = region.buffer(tolerance, quad_segs=4)
    shapely.prepare(allowed)
    alive = {i: part.to_shapely() for i, part in enumerate(parts)}
    # A pair that was ruled out stays so when either grows, so only what both had left is tried again.
    hopeful: dict[int, set[int]] = {i: set() for i in alive}
    hopeless: dict[int, set[int]] = {i: set() for i in alive}
    shapes = list(alive.values())
    near = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=2 * tolerance).T
    heap = _candidates(alive, near[near[:, 0] < near[:, 1]].tolist(), allowed)
    heapq.heapify(heap)
    for _, i, j in heap:
        _link(hopeful, i, j)
    for i, j in near.tolist():
        if j not in hopeful[i]:
            _link(hopeless, i, j)
    union = {i: Merged(part, (i,)) for i, part in enumerate(parts)}
    while heap:
        _, i, j = heapq.heappop(heap)
        if i not in alive or j not in alive:
            continue
        try:
            both = hull(np.concatenate([union[i].polygon.vertices, union[j].polygon.vertices]))
        except GeometryError:  # slivers; they stay two
            continue
        new = len(hopeful)
        union[new] = Merged(both, tuple(sorted(union.pop(i).indices + union.pop(j).indices)))
        del alive[i], alive[j]
        alive[new] = both.to_shapely()
        ruled_out = hopeless[i] | hopeless[j]
        again = [k for k in (hopeful[i] | hopeful[j]) - ruled_out if k in alive]
        hopeful[new], hopeless[new] = set(), set()
        found = _candidates(alive, [[k, new] for k in again], allowed)
        for entry in found:
            _link(hopeful, *entry[1:])
            heapq.heappush(heap, entry)
        for k in (ruled_out | set(again)) - hopeful[new] - {i, j}:
            _link(hopeless, k, new)
    return list(union.values())


def _link(pairs: dict[int, set[int]], i: int, j: int) -> None:
    pairs[i].add(j)
    pairs[j].add(i)


def _candidates(
    alive: dict[int, shapely.Polygon], pairs: list[list[int]], allowed: shapely.Geometry
) -> list[tuple[float, int, int]]:
    """Those of the pairs whose hull does not reach out too far, with the area that it adds to theirs."""
    if not pairs:
        return []
    first, second = ([alive[pair[k]] for pair in pairs] for k in (0, 1))
    hulls = shapely.convex_hull(shapely.geometrycollections(np.stack([first, second], axis=1)))
    corners, owner = shapely.get_coordinates(hulls, return_index=True)
    same = owner[1:] == owner[:-1]
    middles = 0.5 * (corners[1:] + corners[:-1])[same]
    beyond = owner[1:][same][~shapely.contains_xy(allowed, *middles.T)]  # most hulls are ruled out by this alone
    left = np.setdiff1d(np.arange(len(pairs)), beyond)
    left = left[shapely.covers(allowed, hulls[left])]
    added = shapely.area(hulls) - shapely.area(first) - shapely.area(second)
    return [(float(added[n]), pairs[n][0], pairs[n][1]) for n in left.tolist()]
