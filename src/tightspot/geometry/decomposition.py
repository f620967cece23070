"""Decomposition of polygons into few convex parts, with or without holes."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from tightspot.errors import GeometryError, Problem
from tightspot.geometry.diagonals import Outline, few_diagonals
from tightspot.geometry.polygon import ConvexPolygon
from tightspot.geometry.rings import Ring, clean_ring, tolerance

Array = NDArray[np.float64]


def decompose(exterior: ArrayLike, holes: Sequence[ArrayLike] = (), name: str = "") -> tuple[ConvexPolygon, ...]:
    """Convex parts whose union is the polygon and whose interiors are disjoint.

    No vertex is invented: the parts' corners are the polygon's, so the cover is exact. A convex polygon comes
    back as one part. The number of parts is the smallest found by a bounded search (see
    :mod:`tightspot.geometry.diagonals`), at most ``2 r + 1`` for r reflex vertices.

    Args:
        exterior: Shape (n, 2), m. Any winding, open or closed, repeated and collinear vertices are dropped.
        holes: The same for each hole. Holes may touch each other or the exterior in single points.
        name: What the polygon is called in messages, for example ``obstacles[2].vertices``. Paths in the
            messages are ``name[i]`` and ``name.holes[j][i]``; without a name ``[i]`` and ``holes[j][i]``.

    Raises:
        GeometryError: Not finite, fewer than three distinct vertices or zero area, a boundary that crosses or
            touches itself, a hole that reaches outside, holes that overlap or cut the polygon into pieces.

    >>> len(decompose([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]))
    2
    """
    hole_names = [f"{name}.holes[{j}]".lstrip(".") for j in range(len(holes))]
    shell, inner = _clean_rings(exterior, holes, name, hole_names)
    _check(shell, inner, name, hole_names)
    rings = [shell.vertices, *(ring.vertices[::-1] for ring in inner)]
    parts = _parts(_outline(rings))
    if not parts:
        raise GeometryError(
            Problem(
                name,
                "parts of the boundary are apart by no more than rounding; "
                "let them touch in a vertex or move them apart",
            )
        )
    return parts


def _clean_rings(
    exterior: ArrayLike, holes: Sequence[ArrayLike], name: str, hole_names: list[str]
) -> tuple[Ring, list[Ring]]:
    rings: list[Ring] = []
    problems: list[Problem] = []
    for points, path in zip((exterior, *holes), (name, *hole_names), strict=True):
        try:
            rings.append(clean_ring(points, path))
        except GeometryError as error:
            problems += error.problems
    if problems:
        raise GeometryError(problems)
    return rings[0], rings[1:]


def _check(shell: Ring, holes: list[Ring], name: str, hole_names: list[str]) -> None:
    """Refuse what is no polygon, naming the ring and the place."""
    problems = [
        Problem(
            path,
            f"the boundary crosses or touches itself{_place(ring)}; list the corners once around, in order",
        )
        for ring, path in zip((shell, *holes), (name, *hole_names), strict=True)
        if not shapely.LinearRing(ring.vertices).is_simple
    ]
    if problems:
        raise GeometryError(problems)
    outside, filled = shapely.Polygon(shell.vertices), [shapely.Polygon(ring.vertices) for ring in holes]
    for j, hole in enumerate(filled):
        if not outside.covers(hole):
            problems.append(Problem(hole_names[j], "the hole reaches outside the exterior; move it inside"))
        for k in range(j):
            if hole.intersection(filled[k]).area > 0:
                problems.append(Problem(hole_names[j], f"the hole overlaps {hole_names[k]}; make one hole of the two"))
    if problems:
        raise GeometryError(problems)
    polygon = shapely.Polygon(shell.vertices, [ring.vertices for ring in holes])
    if not polygon.is_valid:
        raise GeometryError(
            Problem(
                name,
                f"holes share an edge or cut the polygon into pieces{_where(polygon)}; "
                "holes may touch only in single points and must leave the rest connected",
            )
        )


def _place(ring: Ring) -> str:
    return _where(shapely.Polygon(ring.vertices))


def _where(polygon: shapely.Polygon) -> str:
    """The place that shapely names in its reason for an invalid polygon."""
    match = re.search(r"\[(\S+) (\S+)\]", shapely.is_valid_reason(polygon))
    return f" at ({float(match[1]):g}, {float(match[2]):g})" if match else ""


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


def _parts(outline: Outline) -> tuple[ConvexPolygon, ...]:
    """The convex parts in a reproducible order, none if rounding keeps them from covering the outline."""
    diagonals = few_diagonals(outline)
    if diagonals is None:
        return ()
    faces = _faces(outline, diagonals) if len(diagonals) else [outline.points[outline.rings[0]]]
    try:
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
    inside = shapely.contains_properly(outline.polygon, shapely.point_on_surface(faces))
    solid = shapely.area(faces) > tolerance(outline.points) ** 2
    rings = [shapely.get_coordinates(face)[:-1] for face in faces[inside & solid]]
    return sorted(rings, key=lambda ring: (*ring.min(axis=0).tolist(), *ring.max(axis=0).tolist()))
