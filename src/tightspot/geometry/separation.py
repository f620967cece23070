"""Closed-form best separating line, signed distance and penetration depth of convex polygons, batched.

The clearance of convex polygons V and O is ``max over unit n of  min(n.V) - max(n.O)``: the Euclidean
distance if they are disjoint, minus the penetration depth (the shortest translation that parts them) if they
overlap. The maximum is attained at an outward edge normal of O, at minus one of V, or, if they are disjoint,
along the line through the closest two vertices. So it is enough to try those finitely many n. Every n tried
gives a lower bound, so that rounding cannot make the clearance larger than it is, and near contact, where the
closest vertices give no direction, the edge normals remain: the normal is always a unit vector.

References:
    S. Cameron and R. K. Culley, Determining the minimum translational distance between two convex polyhedra,
    ICRA 1986.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tightspot.errors import GeometryError, Problem

Array = NDArray[np.float64]

# Numbers in one temporary array (512 KiB): small enough for the cache, large enough to hide the interpreter.
_BLOCK = 65_536


class Separation(NamedTuple):
    """Best separating lines ``{q: normal . q = offset}``.

    Attributes:
        normal: Unit vector that points from O to V, shape (..., 2).
        offset: Midway between the two, ``(min(n.V) + max(n.O)) / 2``, m, shape (...).
        clearance: ``min(n.V) - max(n.O)``: distance if positive, minus the penetration depth if negative, m,
            (...).
    """

    normal: Array
    offset: Array
    clearance: Array


def best_line(V: ArrayLike, O: ArrayLike) -> Separation:
    """The line that separates V from O best, in closed form, for a whole batch.

    If they are disjoint, the normal is the direction of shortest distance; if they overlap, moving V along it
    by the penetration depth is the shortest translation that parts them. Among equally good lines one is
    returned.

    Args:
        V: Convex, counter-clockwise vertices, m, shape (..., nV, 2). Vertices may be repeated (as padding).
        O: The same for the obstacle, shape (..., nO, 2); leading dimensions broadcast against those of V.

    Raises:
        GeometryError: The shapes do not fit or a number is not finite. Winding and convexity are *not*
            checked.
    """
    V, O = _checked(V, "V"), _checked(O, "O")
    try:
        batch = np.broadcast_shapes(V.shape[:-2], O.shape[:-2])
    except ValueError:
        raise GeometryError(
            Problem("O", f"leading dimensions {O.shape[:-2]} do not broadcast against those of V, {V.shape[:-2]}")
        ) from None
    size = int(np.prod(batch, dtype=int))
    normal, offset, gap = np.empty((size, 2)), np.empty(size), np.empty(size)
    V_rows, O_rows = _batch_last(V, batch), _batch_last(O, batch)
    for block in _blocks(size, V.shape[-2] * O.shape[-2]):
        n, low, high = _best_lines(_take(V_rows, block), _take(O_rows, block))
        normal[block], offset[block], gap[block] = n.T, 0.5 * (low + high), high - low
    return Separation(normal.reshape(*batch, 2), offset.reshape(batch), gap.reshape(batch))


def clearance(V: ArrayLike, O: ArrayLike) -> Array:
    """Signed distance in m, shape (...): see :func:`best_line`."""
    return best_line(V, O).clearance


def penetration_depth(V: ArrayLike, O: ArrayLike) -> Array:
    """How deep V and O overlap, ``max(0, -clearance)`` in m, shape (...): see :func:`best_line`."""
    return np.asarray(np.maximum(0.0, -best_line(V, O).clearance))


def _checked(points: ArrayLike, name: str) -> Array:
    array = np.asarray(points, dtype=float)
    if array.ndim < 2 or array.shape[-1] != 2 or array.shape[-2] < 2:
        raise GeometryError(
            Problem(name, f"vertices of shape {array.shape} need shape (..., n, 2) with n of at least 2")
        )
    if not np.isfinite(array).all():
        raise GeometryError(Problem(name, "vertices must be finite; an entry is infinite or not a number"))
    return array


def _batch_last(points: Array, batch: tuple[int, ...]) -> Array:
    """Vertices as (2, n, size), or (2, n, 1) if they are the same throughout the batch."""
    n = points.shape[-2]
    if points.size != n * 2:
        points = np.broadcast_to(points, (*batch, n, 2))
    return points.reshape(-1, n, 2).transpose(2, 1, 0)


def _blocks(size: int, pairs: int) -> Iterator[slice]:
    step = max(1, _BLOCK // pairs)
    return (slice(start, start + step) for start in range(0, size, step))


def _take(points: Array, block: slice) -> Array:
    return np.ascontiguousarray(points if points.shape[2] == 1 else points[:, :, block])


def _best_lines(V: Array, O: Array) -> tuple[Array, Array, Array]:
    """For V (2, nV, B) and O (2, nO, B or 1): normals (2, B), ``max(n.O)`` (B,), ``min(n.V)`` (B,)."""
    origin = O[:, :1]  # differences first: coordinates may be large
    V, O = V - origin, O - origin
    n_O, gap_O = _edge_gaps(O, V)
    n_V, gap_V = _edge_gaps(V, O)
    gaps = np.concatenate([gap_O, gap_V])
    count = gaps.shape[1]
    normals = np.concatenate([_widen(n_O, count), -_widen(n_V, count)], axis=1)
    best = gaps.argmax(axis=0)
    columns = np.arange(count)
    n, gap = normals[:, best, columns], gaps[best, columns]
    disjoint = np.flatnonzero(gap > 0)
    if disjoint.size:
        n_vertices, gap_vertices = _vertex_gaps(_columns(V, disjoint), _columns(O, disjoint))
        better = gap_vertices > gap[disjoint]
        n[:, disjoint[better]] = n_vertices[:, better]
    low = _dot(n[:, None], O).max(axis=0)
    high = _dot(n[:, None], V).min(axis=0)
    shift = _dot(n, origin[:, 0])
    return n, low + shift, high + shift


def _dot(p: Array, q: Array) -> Array:
    product: Array = p[0] * q[0]
    product += p[1] * q[1]
    return product


def _widen(normals: Array, count: int) -> Array:
    return np.broadcast_to(normals, (*normals.shape[:2], count))


def _columns(points: Array, index: NDArray[np.intp]) -> Array:
    return points if points.shape[2] == 1 else points[:, :, index]


def _edge_gaps(P: Array, Q: Array) -> tuple[Array, Array]:
    """Outward unit edge normals of P, (2, nP, B or 1), and how far Q lies beyond each edge, (nP, B)."""
    edges = P - np.roll(P, 1, axis=1)
    length = np.hypot(edges[0], edges[1])
    real = length > 0
    length = np.where(real, length, 1.0)
    normal = np.stack([edges[1] / length, -edges[0] / length])
    beyond = _dot(normal[:, :, None], Q[:, None]).min(axis=1)
    gap = np.where(real, beyond - _dot(normal, P), -np.inf)
    return normal, gap


def _vertex_gaps(V: Array, O: Array) -> tuple[Array, Array]:
    """Unit directions between the closest vertices, (2, B), and the gap along them, (B,)."""
    difference = V[:, :, None] - O[:, None]
    squared = _dot(difference, difference)
    count = squared.shape[2]
    closest = squared.reshape(-1, count).argmin(axis=0)
    n = difference.reshape(2, -1, count)[:, closest, np.arange(count)]
    length = np.hypot(n[0], n[1])
    n = n / np.where(length > 0, length, 1.0)
    return n, _dot(n[:, None], V).min(axis=0) - _dot(n[:, None], O).max(axis=0)
