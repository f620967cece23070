"""Polygons with fewer corners that contain the polygon and reach out of it by no more than a tolerance.

Two steps take corners away, and both only add area: a reflex corner is cut across (its triangle is filled), and an edge
between two convex corners is left out by extending its neighbours until they meet. The step that adds least comes
first. A step is taken only if what it adds lies within the tolerance of the original polygon and meets no other part
of the boundary. Holes shrink by the same steps, and are filled if they are narrow enough to lie within the tolerance.
"""

from __future__ import annotations

import heapq

import numpy as np
import shapely
from numpy.typing import NDArray

Array = NDArray[np.float64]


def outward(polygon: shapely.Polygon, tolerance: float) -> shapely.Polygon:
    """A polygon that contains ``polygon``, reaches out of it by at most ``tolerance`` m, and has few corners."""
    oriented = shapely.orient_polygons(polygon)  # the interior is on the left of every ring
    allowed = oriented.buffer(tolerance, quad_segs=4)
    shapely.prepare(allowed)
    exterior = _simplified(shapely.get_coordinates(oriented.exterior)[:-1], allowed)
    holes = []
    for ring in oriented.interiors:
        if not allowed.covers(shapely.Polygon(ring)):
            holes.append(_simplified(shapely.get_coordinates(ring)[:-1], allowed))
    return shapely.Polygon(exterior, holes)


def _simplified(ring: Array, allowed: shapely.Geometry) -> Array:
    chain = _Chain(ring, allowed)
    while chain.take_a_step():
        pass
    return chain.corners()


class _Chain:
    """A ring (n, 2) as a linked list of corners, with the possible steps in a heap, smallest addition first."""

    def __init__(self, ring: Array, allowed: shapely.Geometry) -> None:
        self.allowed = allowed
        self.points = ring.copy()
        self.tree = shapely.STRtree(shapely.points(ring))
        self.moved = 0.0
        self.alive = np.ones(len(ring), dtype=bool)
        self.before = np.roll(np.arange(len(ring)), 1).tolist()
        self.after = np.roll(np.arange(len(ring)), -1).tolist()
        self.version = [0] * len(ring)
        self.heap: list[tuple[float, int, int, bool]] = []
        for i in range(len(ring)):
            self._push(i)

    def corners(self) -> Array:
        """What is left of the ring."""
        first = int(np.flatnonzero(self.alive)[0])
        order = [first]
        while self.after[order[-1]] != first:
            order.append(self.after[order[-1]])
        return self.points[order]

    def take_a_step(self) -> bool:
        """The cheapest step that is possible; false if there is none."""
        while self.heap:
            _, i, version, cut = heapq.heappop(self.heap)
            if self.alive[i] and version == self.version[i] and (self._cut(i) if cut else self._extend(i)):
                return True
        return False

    def _push(self, i: int) -> None:
        """The step at corner i, or at the edge from i to the next corner."""
        p, q, r, s = (self.points[k] for k in self._around(i))
        if _turn(p, q, r) <= 0:
            heapq.heappush(self.heap, (-_turn(p, q, r), i, self.version[i], True))
        elif _turn(q, r, s) > 0:
            apex = _meeting(p, q, r, s)
            if apex is not None:
                heapq.heappush(self.heap, (abs(_turn(q, apex, r)), i, self.version[i], False))

    def _around(self, i: int) -> tuple[int, int, int, int]:
        after = self.after[i]
        return self.before[i], i, after, self.after[after]

    def _cut(self, i: int) -> bool:
        """Fill the triangle of reflex corner i."""
        before, _, after, _ = self._around(i)
        if before == self.after[after] or not self._free(before, i, after, self.points[[before, i, after]]):
            return False
        self._remove(i)
        self._renew(before, after)
        return True

    def _extend(self, i: int) -> bool:
        """Leave out the edge from convex corner i to the next: the corner moves to where the neighbours meet."""
        p, q, r, s = self._around(i)
        if len({p, q, r, s}) < 4:
            return False
        apex = _meeting(*self.points[[p, q, r, s]])
        if apex is None or not self._free(q, r, s, np.array([self.points[q], apex, self.points[r]])):
            return False
        self.moved = max(self.moved, float(np.abs(apex - self.tree.geometries[q].coords[0]).max()))
        self.points[q] = apex
        self._remove(r)
        self._renew(p, q, s)
        return True

    def _free(self, a: int, b: int, c: int, triangle: Array) -> bool:
        """Whether a triangle lies within the tolerance and holds no corner but the three."""
        shape = shapely.Polygon(triangle)
        if shape.area > 0 and not self.allowed.covers(shape):
            return False
        (x0, y0), (x1, y1) = triangle.min(axis=0) - self.moved, triangle.max(axis=0) + self.moved
        near = self.tree.query(shapely.box(x0, y0, x1, y1))
        near = near[self.alive[near]]
        near = near[(near != a) & (near != b) & (near != c)]
        return not len(near) or not shapely.intersects_xy(shape, *self.points[near].T).any()

    def _remove(self, i: int) -> None:
        before, _, after, _ = self._around(i)
        self.after[before], self.before[after] = after, before
        self.alive[i] = False

    def _renew(self, *corners: int) -> None:
        for i in {self.before[corners[0]], *corners, self.after[corners[-1]]}:
            self.version[i] += 1
            self._push(i)


def _turn(p: Array, q: Array, r: Array) -> float:
    """Twice the area of the triangle, positive if it turns left."""
    return float((q[0] - p[0]) * (r[1] - q[1]) - (q[1] - p[1]) * (r[0] - q[0]))


def _meeting(p: Array, q: Array, r: Array, s: Array) -> Array | None:
    """Where the ray from p through q meets the ray from s through r, beyond q and r; ``None`` if nowhere."""
    d, e = q - p, r - s
    cross = float(d[0] * e[1] - d[1] * e[0])
    if cross == 0:
        return None
    a = float((r[0] - q[0]) * e[1] - (r[1] - q[1]) * e[0]) / cross
    b = float((r[0] - q[0]) * d[1] - (r[1] - q[1]) * d[0]) / cross
    return np.asarray(q + a * d) if a > 0 and b > 0 else None
