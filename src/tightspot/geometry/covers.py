"""Covers of polygons by few convex parts that may overlap, and reach out a little but never fall short.

A decomposition keeps the parts inside; a cover may be coarser. Two parts are replaced by their convex hull if
that reaches out of the covered region by no more than a tolerance. A hull has no corner that its points had not,
so nothing is uncovered by rounding, and many touching or overlapping polygons (the panels of a wall, the cells of
a map) become few parts.
"""

from __future__ import annotations

import heapq
from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from tightspot.geometry.polygon import ConvexPolygon

Array = NDArray[np.float64]


def hull(points: Array) -> ConvexPolygon:
    """The convex hull of points (n, 2) m that are not all on one line; no point lies outside but by rounding."""
    ring = shapely.get_coordinates(shapely.MultiPoint(points).convex_hull)
    return containing(ConvexPolygon.from_vertices(ring), points)


def containing(polygon: ConvexPolygon, points: Array) -> ConvexPolygon:
    """The polygon with its edges moved outward until no point (n, 2) m lies outside; itself if none does."""
    rounding = 16 * np.finfo(float).eps * float(np.abs(points).max())
    excess = (points @ polygon.A.T).max(axis=0) - polygon.b
    if (excess <= rounding).all():
        return polygon
    return ConvexPolygon.from_halfplanes(polygon.A, polygon.b + np.maximum(excess, 0.0) + rounding)


def reaching(parts: Sequence[ConvexPolygon], points: Array) -> list[ConvexPolygon]:
    """The parts, widened where need be so that each of the points (n, 2) m lies in one of them.

    A decomposition leaves out vertices that are on a line with their neighbours but for rounding; this takes
    them in again. The part to which a point is nearest is widened.
    """
    beyond = np.stack([(points @ part.A.T - part.b).max(axis=1) for part in parts])
    nearest = beyond.argmin(axis=0)
    return [containing(part, points[nearest == i]) if (nearest == i).any() else part for i, part in enumerate(parts)]


def simplified(polygon: ConvexPolygon, tolerance: float) -> ConvexPolygon:
    """The polygon without edges that can be left out by extending their neighbours by at most ``tolerance`` m.

    The result contains the polygon and reaches out of it by no more than that.
    """
    V = polygon.vertices
    shape = polygon.to_shapely()
    while len(V) > 3:
        corner, height = _corners(V)
        near = np.flatnonzero(height <= tolerance)
        for i in near[np.argsort(height[near], kind="stable")]:
            if shape.distance(shapely.Point(corner[i])) <= tolerance:
                V = np.insert(np.delete(V, [i - 1, i], axis=0), i - 1 if i else len(V) - 2, corner[i], axis=0)
                break
        else:
            break
    return polygon if V is polygon.vertices else hull(np.concatenate([V, polygon.vertices]))


def _corners(V: Array) -> tuple[Array, Array]:
    """Where the edges before and after edge i (from V[i-1] to V[i]) meet, and how far outside edge i that is."""
    start, end = np.roll(V, 1, axis=0), V
    before, along, after = start - np.roll(V, 2, axis=0), end - start, np.roll(V, -1, axis=0) - end
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (along[:, 0] * after[:, 1] - along[:, 1] * after[:, 0]) / turn
        corner = start + s[:, None] * before
        height = np.abs(before[:, 0] * along[:, 1] - before[:, 1] * along[:, 0]) * s / np.hypot(*along.T)
    return corner, np.where((turn > 0) & (s > 0), height, np.inf)


def merged(parts: Sequence[ConvexPolygon], region: shapely.Geometry, tolerance: float) -> list[ConvexPolygon]:
    """Fewer convex parts that cover the same parts.

    Args:
        parts: What must stay covered.
        region: What they cover together, or more.
        tolerance: How far the result may reach out of the region, m.
    """
    allowed = region.buffer(tolerance, quad_segs=4)
    shapely.prepare(allowed)
    alive = {i: part.to_shapely() for i, part in enumerate(parts)}
    beside: dict[int, set[int]] = {i: set() for i in alive}
    tree = shapely.STRtree(list(alive.values()))
    for i, j in tree.query(list(alive.values()), predicate="dwithin", distance=2 * tolerance).T.tolist():
        if i != j:
            beside[i].add(j)
    heap = [entry for i in alive for j in beside[i] if i < j for entry in _candidate(alive, i, j, allowed)]
    heapq.heapify(heap)
    union = dict(enumerate(parts))
    while heap:
        _, i, j = heapq.heappop(heap)
        if i not in alive or j not in alive:
            continue
        new = len(beside)
        union[new] = hull(np.concatenate([union.pop(i).vertices, union.pop(j).vertices]))
        del alive[i], alive[j]
        alive[new] = union[new].to_shapely()
        beside[new] = {k for k in beside[i] | beside[j] if k in alive}
        for k in beside[new]:
            beside[k].add(new)
            for entry in _candidate(alive, k, new, allowed):
                heapq.heappush(heap, entry)
    return list(union.values())


def _candidate(
    alive: dict[int, shapely.Polygon], i: int, j: int, allowed: shapely.Geometry
) -> list[tuple[float, int, int]]:
    """The pair with the area that its hull adds, as a list; empty if the hull reaches out too far."""
    both = shapely.GeometryCollection([alive[i], alive[j]]).convex_hull
    if not allowed.covers(both):
        return []
    return [(both.area - alive[i].area - alive[j].area, i, j)]
