"""Decomposition of polygons into few convex parts, with or without holes."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from tightspot.errors import GeometryError, Problem
from tightspot.geometry.diagonals import Outline, few_diagonals
from tightspot.geometry.polygon import ConvexPolygon, is_convex
from tightspot.geometry.rings import clean_ring, tolerance
from tightspot.geometry.solids import solid_polygons

Array = NDArray[np.float64]

MOST_GROWTH = 2e-4
"""A polygon whose boundary almost touches itself is grown by no more than this, m."""


def decompose(exterior: ArrayLike, holes: Sequence[ArrayLike] = (), name: str = "") -> tuple[ConvexPolygon, ...]:
    """Convex parts whose union is the polygon and whose interiors are disjoint.

    No vertex is invented: the parts' corners are the polygon's, so the cover is exact. (Only if parts of the
    boundary are apart by no more than rounding, the polygon is grown by what it takes to close the gap, at most
    1e-5 of its extent and 0.2 mm: the cover is never too small.) A convex polygon comes back as one part. The number
    of parts is the smallest found by a bounded search (see :mod:`tightspot.geometry.diagonals`), at most ``2 r + 1``
    for r reflex vertices.

    Args:
        exterior: Shape (n, 2), m. Any winding, open or closed, repeated and collinear vertices are dropped. It may
            touch itself (see :mod:`tightspot.geometry.solids`).
        holes: The same for each hole. Holes may touch each other or the exterior in single points.
        name: What the polygon is called in messages, for example ``obstacles[2].vertices``. Paths in the
            messages are ``name[i]`` and ``name.holes[j][i]``; without a name ``[i]`` and ``holes[j][i]``.

    Raises:
        GeometryError: Not finite, fewer than three distinct vertices or zero area, a boundary that crosses
            itself, a hole that reaches outside, holes that overlap or cut the polygon into pieces.

    >>> len(decompose([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]))
    2
    """
    return convex_parts(solid_polygons(exterior, holes, name), name)


def convex_parts(polygons: Sequence[shapely.Polygon], name: str = "") -> tuple[ConvexPolygon, ...]:
    """What :func:`decompose` says, for valid polygons, one after the other.

    Args:
        polygons: With holes or without, their interiors disjoint.
        name: What they are called in messages.

    Raises:
        GeometryError: A polygon has no area, or is thinner than the rounding of its coordinates.
    """
    for solid in itertools.chain([list(polygons)], _grown(polygons)):
        found = [_parts(piece) for piece in solid]
        if all(found):
            return tuple(part for parts in found for part in parts)
    raise GeometryError(
        Problem(
            name,
            "parts of the boundary are apart by no more than rounding; let them touch in a vertex or move them apart",
        )
    )


def _grown(polygons: Sequence[shapely.Polygon]) -> Iterator[list[shapely.Polygon]]:
    """The polygons grown by less and less little, at most 0.2 mm, so that what almost touches runs together."""
    extent = np.ptp(np.concatenate([shapely.get_coordinates(piece) for piece in polygons]), axis=0).max()
    for growth in extent * np.array([1e-8, 1e-7, 1e-6, 1e-5]):
        if growth <= MOST_GROWTH:
            solid = shapely.union_all([piece.buffer(growth, join_style="mitre", mitre_limit=2) for piece in polygons])
            yield list(shapely.get_parts(solid))


def _rings(polygon: shapely.Polygon) -> list[Array]:
    """The cleaned rings of a valid polygon, the exterior counter-clockwise and the holes clockwise."""
    exterior, *holes = (clean_ring(shapely.get_coordinates(r)).vertices for r in (polygon.exterior, *polygon.interiors))
    return [exterior, *(hole[::-1] for hole in holes)]


def _outline(rings: list[Array]) -> Outline:
    """The rings joined where they touch: there they get a common point."""
    joined = [_with_touching_points(i, rings) for i in range(len(rings))]
    points, inverse = np.unique(np.concatenate(joined), axis=0, return_inverse=True)
    splits = np.cumsum([len(ring) for ring in joined])[:-1]
    return Outline(points, np.split(inverse.reshape(-1), splits), shapely.Polygon(joined[0], joined[1:]))


def _with_touching_points(i: int, rings: list[Array]) -> Array:
    """Ring i with the vertices of other rings that lie on its edges inserted: rings then meet in vertices."""
    if len(rings) == 1:
        return rings[i]
    others = np.concatenate([ring for j, ring in enumerate(rings) if j != i])
    following = np.roll(rings[i], -1, axis=0)
    edges = shapely.linestrings(np.stack([rings[i], following], axis=1))
    edge, touching = shapely.STRtree(shapely.points(others)).query(edges, predicate="intersects")
    pieces = []
    for k, start in enumerate(rings[i]):
        inserted = np.unique(others[touching[edge == k]], axis=0)
        inserted = inserted[(inserted != start).any(axis=1) & (inserted != following[k]).any(axis=1)]
        pieces += [start[None], inserted[np.argsort(np.hypot(*(inserted - start).T))]]
    return np.concatenate(pieces)


def _parts(polygon: shapely.Polygon) -> tuple[ConvexPolygon, ...]:
    """The convex parts in a reproducible order, none if rounding keeps them from covering the polygon."""
    try:
        rings = _rings(polygon)
        if len(rings) == 1 and is_convex(rings[0]):
            return (ConvexPolygon.from_vertices(rings[0]),)
        outline = _outline(rings)
        diagonals = few_diagonals(outline)
        if diagonals is None:
            return ()
        faces = _faces(outline, diagonals) if len(diagonals) else [outline.points[outline.rings[0]]]
        parts = tuple(ConvexPolygon.from_vertices(face) for face in faces)
    except GeometryError:
        return ()
    area = outline.polygon.area
    return parts if abs(sum(part.area for part in parts) - area) <= 1e-9 * area else ()


def _faces(outline: Outline, diagonals: NDArray[np.intp]) -> list[Array]:
    """Vertices of the faces into which the diagonals cut the outline, slivers left out."""
    sides = (np.stack([ring, np.roll(ring, -1)], axis=1) for ring in outline.rings)
    lines = shapely.linestrings(outline.points[np.concatenate([*sides, diagonals])])
    faces = shapely.get_parts(shapely.polygonize(lines))
    shapely.prepare(outline.polygon)
    inside = shapely.contains_properly(outline.polygon, shapely.point_on_surface(faces))
    solid = shapely.area(faces) > tolerance(outline.points) ** 2
    rings = [shapely.get_coordinates(face)[:-1] for face in faces[inside & solid]]
    return sorted(rings, key=lambda ring: (*ring.min(axis=0).tolist(), *ring.max(axis=0).tolist()))
