"""Convex polygons in both representations: vertices, and half-planes ``A q <= b``."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from tightspot.errors import GeometryError, Problem
from tightspot.geometry.rings import Ring, clean_convex_ring, clean_ring, signed_area
from tightspot.geometry.transforms import rotation

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class ConvexPolygon:
    """A convex polygon with at least three corners, a value: immutable, compared by its vertices.

    The paper's index convention: edge i goes from vertex i-1 to vertex i, so vertex i is where edges i and
    i+1
    meet: ``A[i] @ vertices[i] == b[i]`` and ``A[i+1] @ vertices[i] == b[i+1]``, indices modulo n.

    Attributes:
        vertices: Counter-clockwise, m, shape (n, 2), read-only.

    Raises:
        GeometryError: See :meth:`from_vertices`.

    >>> ConvexPolygon.rectangle(0, 2, 0, 1).b
    array([0., 0., 2., 1.])
    """

    vertices: Array

    def __post_init__(self) -> None:
        self._set(_convex_ring(self.vertices, "vertices"))

    @classmethod
    def from_vertices(cls, points: ArrayLike, name: str | None = None) -> ConvexPolygon:
        """The polygon with these corners, in order.

        Any winding; the ring may be closed; repeated and collinear vertices are dropped within the tolerance
        of :mod:`tightspot.geometry.rings`. The first vertex stays first unless it is dropped.

        Args:
            points: Shape (n, 2), m.
            name: What the points are called in messages, for example ``obstacles[2].vertices``.

        Raises:
            GeometryError: Not finite, fewer than three distinct points, zero area, self-intersecting, or not
                convex (the message points at :func:`tightspot.geometry.decompose`).
        """
        return cls._trusted(_convex_ring(points, "vertices" if name is None else name))

    @classmethod
    def if_obvious(cls, points: ArrayLike) -> ConvexPolygon | None:
        """What :meth:`from_vertices` makes of the points, if they need no cleaning and no second look; in a hurry."""
        vertices = clean_convex_ring(points)
        return None if vertices is None else cls._trusted(vertices)

    @classmethod
    def from_halfplanes(cls, A: ArrayLike, b: ArrayLike) -> ConvexPolygon:
        """The polygon ``{q: A q <= b}``: rows in any order and scaling, redundant rows are dropped.

        On the boundary line of each row the other rows leave an interval; its ends are corners if it is not
        empty.

        Args:
            A: Shape (m, 2), need not be unit.
            b: Shape (m,).

        Raises:
            GeometryError: The set is empty, has no interior or is unbounded, or a row has no direction.
        """
        A, b = _normalised_rows(A, b)
        foot, along = A * b[:, None], np.stack([-A[:, 1], A[:, 0]], axis=1)
        low, high = _edge_intervals(A, b, foot, along)
        kept = high > low
        foot, along, low, high = foot[kept], along[kept], low[kept], high[kept]
        if not np.isfinite([low, high]).all():
            raise GeometryError(Problem("A", "A q <= b is unbounded; add half-planes until all sides are closed"))
        ends = foot[:, None, :] + np.stack([low, high], axis=1)[:, :, None] * along[:, None, :]
        hull = shapely.MultiPoint(ends.reshape(-1, 2)).convex_hull
        if hull.geom_type != "Polygon":
            message = "the half-planes A q <= b have no area in common; check their signs"
            raise GeometryError(Problem("b", message))
        return cls.from_vertices(shapely.get_coordinates(hull), "A q <= b")

    @classmethod
    def rectangle(cls, x_min: float, x_max: float, y_min: float, y_max: float) -> ConvexPolygon:
        """The rectangle ``x_min <= x <= x_max``, ``y_min <= y <= y_max``, m; starts at (x_min, y_min)."""
        for axis, low, high in (("x", x_min, x_max), ("y", y_min, y_max)):
            if not low < high:
                raise GeometryError(
                    Problem(
                        f"{axis}_min",
                        f"{low:g} m must be less than {axis}_max = {high:g} m; exchange the two",
                    )
                )
        return cls.from_vertices([(x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max)])

    @cached_property
    def A(self) -> Array:
        """Unit outward normals of the edges, shape (n, 2), read-only."""
        edges = self.vertices - np.roll(self.vertices, 1, axis=0)
        return _read_only(np.stack([edges[:, 1], -edges[:, 0]], axis=1) / np.hypot(*edges.T)[:, None] + 0.0)

    @cached_property
    def b(self) -> Array:
        """The polygon is ``{q: A q <= b}``, m, shape (n,), read-only."""
        return _read_only((self.A @ self.vertices.T).max(axis=1))  # the support: rounding leaves no vertex outside

    @property
    def area(self) -> float:
        """Area, m^2."""
        return signed_area(self.vertices)

    @cached_property
    def centroid(self) -> Array:
        """Centre of mass, m, shape (2,)."""
        origin = self.vertices[0]
        x, y = (self.vertices - origin).T
        cross = x * np.roll(y, -1) - np.roll(x, -1) * y
        sums = np.array([np.sum((x + np.roll(x, -1)) * cross), np.sum((y + np.roll(y, -1)) * cross)])
        return _read_only(origin + sums / (3 * np.sum(cross)))

    @cached_property
    def radius(self) -> float:
        """Largest distance of a vertex from the origin, m: the reach when the polygon turns about it."""
        return float(np.hypot(*self.vertices.T).max())

    def contains(self, points: ArrayLike, tol: float = 0.0) -> NDArray[np.bool_]:
        """Whether ``A q <= b + tol`` for points q of shape (..., 2), m; the boundary belongs to the polygon.

        Returns:
            Shape (...).
        """
        return np.asarray((np.asarray(points, dtype=float) @ self.A.T <= self.b + tol).all(axis=-1))

    def transformed(self, x: float, y: float, theta: float) -> ConvexPolygon:
        """The polygon moved with its frame: ``V = R V0 + T``, ``C = C0 R^T``, ``d = d0 + C0 R^T T``.

        Vertices and edges keep their order. Exact up to rounding: nothing is cleaned again.
        """
        R, T = rotation(theta), np.array([x, y], dtype=float)
        if not np.isfinite([x, y, theta]).all():
            raise GeometryError(Problem("pose", f"({x:g}, {y:g}, {theta:g}) must be three finite numbers"))
        return self._trusted(self.vertices @ R.T + T)

    def to_shapely(self) -> shapely.Polygon:
        """The same polygon for shapely."""
        return shapely.Polygon(self.vertices)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ConvexPolygon) and np.array_equal(self.vertices, other.vertices)

    def __hash__(self) -> int:
        return hash(self.vertices.tobytes())

    def __repr__(self) -> str:
        return f"ConvexPolygon({self.vertices.tolist()})"

    @classmethod
    def _trusted(cls, vertices: Array) -> ConvexPolygon:
        polygon = object.__new__(cls)
        polygon._set(vertices)
        return polygon

    def _set(self, vertices: Array) -> None:
        object.__setattr__(self, "vertices", _read_only(vertices))


def _read_only(array: Array) -> Array:
    array = np.array(array, dtype=float)
    array.setflags(write=False)
    return array


def is_convex(vertices: Array) -> bool:
    """Whether a cleaned ring (n, 2), see :func:`tightspot.geometry.clean_ring`, is a convex polygon's."""
    turns = _turns(vertices)
    return bool((turns > 0).all() and turns.sum() < 3 * np.pi)


def _turns(vertices: Array) -> Array:
    """Angles in rad by which the boundary turns left at its vertices, shape (n,)."""
    arriving = vertices - np.roll(vertices, 1, axis=0)
    leaving = np.roll(arriving, -1, axis=0)
    cross = arriving[:, 0] * leaving[:, 1] - arriving[:, 1] * leaving[:, 0]
    return np.asarray(np.arctan2(cross, (arriving * leaving).sum(axis=1)))


def _convex_ring(points: ArrayLike, path: str) -> Array:
    obvious = clean_convex_ring(points)
    if obvious is not None:
        return obvious
    ring = clean_ring(points, path)
    if is_convex(ring.vertices):
        return ring.vertices
    raise GeometryError(_why_not_convex(ring, _turns(ring.vertices), path))


def _why_not_convex(ring: Ring, turns: Array, path: str) -> Problem:
    if not shapely.LinearRing(ring.vertices).is_simple:
        return Problem(path, "the boundary crosses itself; list the corners once around, in order")
    at = int(np.argmin(turns))
    x, y = ring.vertices[at]
    return Problem(
        f"{path}[{ring.indices[at]}]",
        f"the polygon is not convex at ({x:g}, {y:g}); split it with tightspot.geometry.decompose",
    )


def _normalised_rows(A: ArrayLike, b: ArrayLike) -> tuple[Array, Array]:
    try:
        A, b = np.array(A, dtype=float), np.array(b, dtype=float)
    except (TypeError, ValueError):
        raise GeometryError(Problem("A", "A and b must be numbers, A a list of rows with two each")) from None
    if A.ndim != 2 or A.shape[1] != 2 or b.shape != A.shape[:1]:
        raise GeometryError(Problem("A", f"A q <= b needs shapes (m, 2) and (m,), given {A.shape} and {b.shape}"))
    problems = [
        Problem(f"A[{i}]", f"{A[i].tolist()} q <= {b[i]:g} must be finite numbers with a nonzero normal")
        for i in range(len(b))
        if not (np.isfinite(A[i]).all() and np.isfinite(b[i]) and A[i].any())
    ]
    if problems:
        raise GeometryError(problems)
    A_scale = np.abs(A).max(axis=1, keepdims=True)
    norm = np.hypot(*(A / A_scale).T)
    return A / A_scale / norm[:, None], b / A_scale[:, 0] / norm


def _edge_intervals(A: Array, b: Array, foot: Array, along: Array) -> tuple[Array, Array]:
    """For each row i the interval [low, high] of s with ``A (foot_i + s along_i) <= b`` for all rows."""
    slope = along @ A.T
    room = b[None, :] - foot @ A.T
    parallel = np.abs(slope) < 1e-12
    slack = 1e-12 * (1 + float(np.abs(b).max(initial=0.0)))
    with np.errstate(divide="ignore", invalid="ignore"):
        s = room / slope
    high = np.where(~parallel & (slope > 0), s, np.inf).min(axis=1, initial=np.inf)
    low = np.where(~parallel & (slope < 0), s, -np.inf).max(axis=1, initial=-np.inf)
    excluded = (parallel & (room < -slack)).any(axis=1)
    return np.where(excluded, np.inf, low), np.where(excluded, -np.inf, high)
