"""Rings that touch themselves: which side of them is inside.

A keyhole (a hole joined to the outer boundary by a cut that is walked twice), two squares joined in one corner,
a boundary that runs back along itself: there the ring is not simple, but there is no doubt what it encloses. The
edges cut the plane into faces; the ring winds about each face a whole number of times. If it winds about every
face either not at all or once in one and the same direction, then the faces of the second kind are the inside.
A ring that crosses itself also has faces about which it winds twice, or the other way round.
"""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

Array = NDArray[np.float64]


def enclosed(ring: Array, slack: float) -> list[shapely.Polygon]:
    """The valid polygons with holes that a ring encloses; none if it crosses itself.

    Args:
        ring: May touch itself, m, shape (n, 2).
        slack: What is nowhere wider does not count as crossing, m: where two sides of a ring should touch, they
            often overlap a little. Such faces belong to the inside.

    >>> ring = np.array([(0, 0), (1, 1), (2, 0), (2, 2), (1, 1), (0, 2)], dtype=float)
    >>> [p.area for p in enclosed(ring, 1e-3)]
    [1.0, 1.0]
    """
    closed = np.concatenate([ring, ring[:1]])
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(shapely.union_all(edges(ring)))))
    windings = _windings(closed, shapely.get_coordinates(shapely.point_on_surface(faces)))
    wide = ~shapely.is_empty(shapely.buffer(faces, -slack / 2))
    if set(windings[wide & (windings != 0)].tolist()) not in ({1}, {-1}):
        return []
    return list(shapely.get_parts(shapely.union_all(faces[windings != 0])))


def edges(ring: Array) -> NDArray[np.object_]:
    """The ring's edges, shape (n,)."""
    lines: NDArray[np.object_] = shapely.linestrings(np.stack([ring, np.roll(ring, -1, axis=0)], axis=1))
    return lines


def _windings(closed: Array, points: Array) -> NDArray[np.intp]:
    """How often the closed ring (n + 1, 2) winds counter-clockwise about each point (m, 2) off the ring.

    A ray in direction +x counts the edges that cross it upwards, minus those that cross it downwards.
    """
    (x0, y0), (x1, y1) = closed[:-1].T, closed[1:].T
    counts = np.zeros(len(points), dtype=np.intp)
    for i, (px, py) in enumerate(points):
        side = (x1 - x0) * (py - y0) - (px - x0) * (y1 - y0)
        counts[i] = np.count_nonzero((y0 <= py) & (y1 > py) & (side > 0))
        counts[i] -= np.count_nonzero((y0 > py) & (y1 <= py) & (side < 0))
    return counts
