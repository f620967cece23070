"""Many convex polygons with all their vertices in one array, so that what looks at all of them needs no loop."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property
from itertools import accumulate
from typing import overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tightspot.geometry.polygon import ConvexPolygon

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


class PolygonStack(Sequence[ConvexPolygon]):
    """Convex polygons, immutable, one after the other.

    Attributes:
        vertices: Of all polygons, m, shape (n, 2), read-only.
        first: Polygon i has the vertices from ``first[i]`` to ``first[i + 1]``; shape (len + 1,), read-only.

    >>> stack = PolygonStack([ConvexPolygon.rectangle(0, 2, 0, 1), ConvexPolygon.rectangle(3, 4, 0, 1)])
    >>> stack.first, stack.box_distances([(0, 0)])
    (array([0, 4, 8]), array([0., 3.]))
    """

    def __init__(self, polygons: Iterable[ConvexPolygon]) -> None:
        self._polygons = tuple(polygons)
        corners = [polygon.vertices for polygon in self._polygons]
        self.vertices: Array = np.concatenate(corners) if corners else np.zeros((0, 2))
        self.first: Integers = np.array([0, *accumulate(map(len, corners))], dtype=np.int64)
        self.vertices.setflags(write=False)
        self.first.setflags(write=False)

    @classmethod
    def of(cls, polygons: Sequence[ConvexPolygon]) -> PolygonStack:
        """The polygons as a stack; the same object if they are one already."""
        return polygons if isinstance(polygons, PolygonStack) else cls(polygons)

    def __len__(self) -> int:
        return len(self._polygons)

    @overload
    def __getitem__(self, index: int) -> ConvexPolygon: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[ConvexPolygon, ...]: ...
    def __getitem__(self, index: int | slice) -> ConvexPolygon | tuple[ConvexPolygon, ...]:
        return self._polygons[index]

    def __repr__(self) -> str:
        return f"PolygonStack({list(self._polygons)!r})"

    @cached_property
    def low(self) -> Array:
        """Smallest x and y of each polygon, m, shape (len, 2)."""
        return np.minimum.reduceat(self.vertices, self.first[:-1]) if len(self) else np.zeros((0, 2))

    @cached_property
    def high(self) -> Array:
        """Largest x and y of each polygon, m, shape (len, 2)."""
        return np.maximum.reduceat(self.vertices, self.first[:-1]) if len(self) else np.zeros((0, 2))

    def box_distances(self, points: ArrayLike) -> Array:
        """From each polygon's bounding box to that of the points (k, 2), m, shape (len,).

        No polygon is nearer than that to the points' convex hull. 0 where the boxes touch, infinite without points.
        """
        points = np.asarray(points, dtype=float)
        x, y = points.T  # far quicker than to reduce along the first axis
        low = x.min(initial=np.inf), y.min(initial=np.inf)
        high = x.max(initial=-np.inf), y.max(initial=-np.inf)
        above, below = self.low - high, low - self.high
        gaps = np.maximum(np.maximum(above, below), 0.0)
        return np.asarray(np.hypot(gaps[:, 0], gaps[:, 1]))

    def chosen(self, indices: NDArray[np.intp]) -> PolygonStack:
        """Those of the polygons."""
        return PolygonStack(self._polygons[i] for i in indices.tolist())
