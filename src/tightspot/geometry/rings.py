"""Cleaning of vertex lists: what is repeated or collinear goes, what is no ring is refused.

Tolerance: two points closer than ``tolerance(points)``, 1e-9 of the extent (the larger side of the bounding
    box) but no less than the rounding of the coordinates, are one point, and a vertex closer than that to the
    line through its neighbours lies on it. A car park of 100 m is thus cleaned to 0.1 micrometres.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tightspot.errors import GeometryError, Problem

Array = NDArray[np.float64]

RELATIVE_TOLERANCE = 1e-9
LARGEST_COORDINATE = 1e9
SMALLEST_EXTENT = 1e-9
_SQUARE_UNDERFLOWS = 1e-150


class DoublesBackError(GeometryError):
    """The boundary turns round at a vertex and runs back along itself."""


class Ring(NamedTuple):
    """A cleaned ring.

    Attributes:
        vertices: Counter-clockwise, not closed, no repeated or collinear vertex, m, shape (n, 2).
        indices: Where each vertex stood in the input, shape (n,).
    """

    vertices: Array
    indices: NDArray[np.intp]


def tolerance(points: Array) -> float:
    """Distance in m below which two of the points (n, 2) are one."""
    rounding = 8 * np.finfo(float).eps * float(np.abs(points).max())
    return max(RELATIVE_TOLERANCE * _extent(points), rounding)


def signed_area(vertices: Array) -> float:
    """Shoelace area of a ring (n, 2) in m^2, positive if counter-clockwise; summed about its first vertex."""
    x, y = (vertices - vertices[0]).T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def as_points(points: ArrayLike, path: str) -> Array:
    """The points as a float array (n, 2); raises :class:`GeometryError` naming the first odd entry."""
    try:
        array = np.array(points, dtype=float)
    except (TypeError, ValueError):
        raise GeometryError(
            Problem(path, "a polygon must be a list of points, each two numbers [x, y] in metres")
        ) from None
    if array.size == 0:
        raise GeometryError(Problem(path, "the polygon has no points; it needs at least three"))
    if array.ndim != 2 or array.shape[1] != 2:
        raise GeometryError(
            Problem(
                path,
                f"the points have shape {array.shape}; give a list of points [x, y] in metres",
            )
        )
    odd = ~(np.abs(array) <= LARGEST_COORDINATE).all(axis=1)
    problems = [
        Problem(f"{path}[{i}]", f"{_point(array[i])} must be two finite numbers, at most {LARGEST_COORDINATE:g} m")
        for i in np.flatnonzero(odd)
    ]
    if problems:
        raise GeometryError(problems)
    # Turns -0.0, and what is so small that its square underflows, into 0.0: equal polygons have equal bytes.
    return np.where(np.abs(array) < _SQUARE_UNDERFLOWS, 0.0, array)


def clean_ring(points: ArrayLike, path: str = "vertices") -> Ring:
    """The ring without repeated and collinear vertices, counter-clockwise, starting where the input starts.

    The ring may be closed (last point equal to the first) and of any winding. It may still cross itself: that
    is for the caller to check. Tolerance: see the module.

    Args:
        points: Shape (n, 2), m.
        path: What the points are called in the messages.

    Raises:
        GeometryError: Not finite, fewer than three distinct points, all on one line, or doubling back on
            itself (:class:`DoublesBackError`).
    """
    array = as_points(points, path)
    index = distinct(array, path)
    index = _without_collinear(array, index, tolerance(array), path)
    if signed_area(array[index]) < 0:
        index = np.roll(index[::-1], 1)
    return Ring(array[index], index)


def clean_convex_ring(points: ArrayLike) -> Array | None:
    """The vertices of :func:`clean_ring` if they are obviously those of a convex polygon; ``None``: look closer.

    All points but a repeated last one are vertices then: at each the boundary turns the same way, once around in all,
    by so much that the vertex stands out from the chord of its neighbours by more than twice the tolerance. So none is
    repeated or collinear, and the polygon is convex.

    Args:
        points: Shape (n, 2), m; anything else is nothing obvious.
    """
    try:
        array = np.array(points, dtype=float, order="C")
    except (TypeError, ValueError):
        return None
    if array.ndim != 2 or array.shape[1] != 2 or len(array) < 3:
        return None
    sizes = np.abs(array)
    largest = float(sizes.max())
    if not largest <= LARGEST_COORDINATE:
        return None
    array[sizes < _SQUARE_UNDERFLOWS] = 0.0
    z = array.view(np.complex128).ravel()
    if z[0] == z[-1]:
        z = z[:-1]
    leaving = np.empty_like(z)
    leaving[:-1], leaving[-1] = z[1:] - z[:-1], z[0] - z[-1]
    turn = np.conj(np.concatenate([leaving[-1:], leaving[:-1]])) * leaving
    if turn[0].imag < 0:
        z, turn = np.concatenate([z[:1], z[:0:-1]]), np.conj(turn)
    lengths = np.abs(leaving)
    longest, boundary = float(lengths.max()), float(lengths.sum())
    least = 4 * longest * max(RELATIVE_TOLERANCE * boundary, 8 * np.finfo(float).eps * largest)
    if not (turn.imag.min() > least and longest > 2 * SMALLEST_EXTENT and np.angle(turn).sum() < 3 * np.pi):
        return None
    return z.view(np.float64).reshape(-1, 2)


def distinct(points: Array, path: str = "vertices") -> NDArray[np.intp]:
    """Indices of the points (n, 2) that are not repeated one after the other.

    Raises:
        GeometryError: Fewer than three are distinct, or all lie on one line.
    """
    tol = tolerance(points)
    index = _without_repeated(points, tol)
    if _extent(points) < SMALLEST_EXTENT or index.size < 3:
        raise GeometryError(
            Problem(
                path,
                f"of {len(points)} points fewer than three are distinct; give three corners or more",
            )
        )
    if _on_one_line(points[index], tol):
        raise GeometryError(Problem(path, "the polygon has zero area: all its points lie on one line"))
    return index


def _extent(points: Array) -> float:
    return float(np.ptp(points, axis=0).max())


def _point(point: Array) -> str:
    return f"({point[0]:g}, {point[1]:g})"


def _without_repeated(points: Array, tol: float) -> NDArray[np.intp]:
    if (np.abs(points - np.roll(points, 1, axis=0)).max(axis=1) > tol).all():
        return np.arange(len(points), dtype=np.intp)
    kept: list[int] = []
    for i, point in enumerate(points):
        if not kept or np.abs(point - points[kept[-1]]).max() > tol:
            kept.append(i)
    while len(kept) > 1 and np.abs(points[kept[-1]] - points[kept[0]]).max() <= tol:
        kept.pop()
    return np.array(kept, dtype=np.intp)


def _on_one_line(points: Array, tol: float) -> bool:
    relative = points - points[np.argmax(np.hypot(*(points - points[0]).T))]
    direction = relative[np.argmax(np.hypot(*relative.T))]
    across = relative @ np.array([-direction[1], direction[0]]) / np.hypot(*direction)
    return bool(np.abs(across).max() <= tol)


def _without_collinear(points: Array, index: NDArray[np.intp], tol: float, path: str) -> NDArray[np.intp]:
    """Drop vertices on the line through their neighbours, until none is left to drop."""
    while not _all_stand_out(points[index], tol):
        before = len(index)
        kept: list[int] = []
        for position, i in enumerate(index):
            previous = kept[-1] if kept else index[-1]
            following = index[position + 1] if position + 1 < before else (kept or index)[0]
            if not _is_straight(points[previous], points[i], points[following], tol, f"{path}[{i}]"):
                kept.append(int(i))
        index = np.array(kept, dtype=np.intp)
        if len(index) == before:
            break
    return index


def _all_stand_out(ring: Array, tol: float) -> bool:
    """Whether :func:`_is_straight` is false of all vertices of the ring (n, 2)."""
    arriving = ring - np.roll(ring, 1, axis=0)
    leaving = np.roll(arriving, -1, axis=0)
    chord = arriving + leaving
    longest = np.max([np.hypot(*side.T) for side in (arriving, leaving, chord)], axis=0)
    cross = np.abs(arriving[:, 0] * leaving[:, 1] - arriving[:, 1] * leaving[:, 0])
    return bool((cross > tol * longest).all())


def _is_straight(previous: Array, vertex: Array, following: Array, tol: float, path: str) -> bool:
    arriving, leaving, chord = vertex - previous, following - vertex, following - previous
    lengths = float(np.hypot(*arriving)), float(np.hypot(*leaving)), float(np.hypot(*chord))
    cross = abs(float(arriving[0] * leaving[1] - arriving[1] * leaving[0]))
    if cross > tol * max(lengths):
        return False
    if float(arriving @ leaving) < 0:
        raise DoublesBackError(
            Problem(
                path,
                f"the boundary doubles back on itself at {_point(vertex)}; "
                "remove this vertex or give the wall a thickness",
            )
        )
    return True
