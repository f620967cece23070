"""Discs that cover the body, each kept away from the obstacle. Sufficient, not necessary."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar, Literal, NamedTuple

import casadi as ca
import numpy as np
import shapely

from tightspot.errors import InputError, Problem
from tightspot.formulations.base import Array, Formulation, Pair, Rows, at_least, free
from tightspot.geometry.polygon import ConvexPolygon

MOST_DISCS = 400


class Discs(NamedTuple):
    """Discs in the body's frame.

    Attributes:
        centres: (K, 2), m.
        radii: (K,), m.
        excess: How far the discs reach beyond the body at most, m: what the over-approximation costs.
    """

    centres: Array
    radii: Array
    excess: float


@dataclass(frozen=True)
class DiscCover(Formulation):
    """The body is covered by discs, and every disc keeps its distance from the obstacle.

    Maths, for the discs' centres c_k in the body's frame, moved by R and T, their radii r_k and the demanded clearance
    m::

        sd(R c_k + T, obstacle) >= r_k + m   for all k

    sd is the exact signed distance of a point from a convex polygon: the distance to the nearest edge outside,
    ``max(A q - b)`` inside. The discs are the smallest ones round the cells of a grid laid over the body, so they
    reach beyond it by at most :attr:`Discs.excess`, which is ``(sqrt(2) - 1) / 2 * h`` for a rectangle in square cells
    of side h. So the rows imply "distance >= m" and are implied by "distance >= m + excess": in a slot with less room
    than that there is no feasible point although the body fits. Outside the obstacle the gradient is continuous, inside
    it jumps where another edge becomes the nearest.

    Auxiliary variables: none. Rows: one a disc. Holds at the knots only.

    Attributes:
        cell: Largest side of a grid cell, m; smaller means less excess and more rows.

    Reference: J. Ziegler, C. Stiller, Fast collision checking for intelligent vehicle motion planning, IEEE
    Intelligent Vehicles Symposium 2010.
    """

    name: ClassVar[str] = "disc-cover"
    equation: ClassVar[str] = "covering discs"
    holds: ClassVar[Literal["knots", "interval"]] = "knots"
    is_exact: ClassVar[bool] = False
    expresses_margin: ClassVar[bool] = False
    cell: float = 0.45

    def __post_init__(self) -> None:
        if not (np.isfinite(self.cell) and self.cell > 0):
            raise InputError(Problem("formulation.cell", f"{self.cell} m must be positive and finite"))

    def auxiliary_bounds(self, n_body: int, n_obstacle: int) -> tuple[Array, Array]:
        return free(0)

    def rows(self, auxiliary: Any, pair: Pair) -> Sequence[Rows]:
        discs = covering_discs(ConvexPolygon.from_vertices(pair.V0), self.cell)
        pose = pair.poses[0]
        c, s = ca.cos(pose.theta), ca.sin(pose.theta)
        edges = _edge_ends(pair)
        values = []
        for (x, y), radius in zip(discs.centres, discs.radii, strict=True):
            centre = ca.vertcat(x * c - y * s + pose.x, x * s + y * c + pose.y)
            values.append(_signed_distance(centre, pair, edges) - radius - pair.margins[0])
        return [at_least(ca.vertcat(*values))]

    def start(self, poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> Array:
        return np.zeros((len(poses), 0))


def _edge_ends(pair: Pair) -> tuple[Any, Any, Any]:
    """Unit direction of each obstacle edge, (n_O, 2), and its ends along it, (n_O, 1) each."""
    along = ca.horzcat(-pair.A[:, 1], pair.A[:, 0])
    before = ca.vertcat(pair.O[-1, :], pair.O[:-1, :])
    return along, ca.sum2(along * before), ca.sum2(along * pair.O)


def _signed_distance(point: Any, pair: Pair, edges: tuple[Any, Any, Any]) -> Any:
    """Signed distance of a point (2, 1) from the obstacle, m: to the nearest edge outside, ``max(A q - b)`` inside."""
    along, first, last = edges
    beyond = pair.A @ point - pair.b
    place = along @ point
    past = ca.fmax(0, ca.fmax(first - place, place - last))
    squared = ca.mmin(beyond**2 + past**2)
    inside = ca.mmax(beyond)
    return ca.if_else(inside > 0, ca.sqrt(ca.fmax(squared, 1e-12)), inside)


@lru_cache(maxsize=64)
def covering_discs(body: ConvexPolygon, cell: float) -> Discs:
    """Small discs along the boundary, large ones within: the smallest round the pieces of a fine and a coarse grid.

    Cells of the fine grid that lie deeper in the body than the cells are wide need no small discs; what they cover is
    covered again by the coarsest grid whose discs reach no further out than the small ones.

    Args:
        body: In its own frame.
        cell: Largest side of a fine cell, m.

    Raises:
        InputError: If that would be more than :data:`MOST_DISCS` cells.
    """
    shape = body.to_shapely()
    cells = _cells(body, cell)
    core = shape.buffer(-min(np.hypot(*side) for side in (cells[0][1], cells[0][2])), join_style="mitre")
    pieces = [_clipped(shape, *place) for place in cells]
    if core.area < 1e-6:
        return _round(body, pieces)
    discs = _round(body, [piece for piece in pieces if not core.buffer(1e-9).contains(piece)])
    for coarse in (4 * cell, 3 * cell, 2 * cell, cell):
        inner = _round(body, [_clipped(core, *place) for place in _cells(body, coarse)])
        if inner.excess <= discs.excess or coarse == cell:
            radii = np.concatenate([discs.radii, inner.radii])
            return Discs(np.vstack([discs.centres, inner.centres]), radii, max(discs.excess, inner.excess))
    return discs


def _cells(body: ConvexPolygon, size: float) -> list[tuple[Array, Array, Array]]:
    """Corner and sides of each cell of a grid over the body's bounding rectangle."""
    corner, along, across = _bounding_axes(body)
    m, n = (max(1, int(np.ceil(np.hypot(*side) / size - 1e-9))) for side in (along, across))
    if m * n > MOST_DISCS:
        sentence = f"{size} m makes {m * n} cells of one part, more than {MOST_DISCS}; choose a larger cell"
        raise InputError(Problem("formulation.cell", sentence))
    a, b = along / m, across / n
    return [(corner + i * a + j * b, a, b) for i in range(m) for j in range(n)]


def _clipped(shape: Any, corner: Array, a: Array, b: Array) -> Any:
    return shape.intersection(shapely.Polygon([corner, corner + a, corner + a + b, corner + b]))


def _round(body: ConvexPolygon, pieces: list[Any]) -> Discs:
    """The smallest disc round each piece that has an area."""
    found = [_smallest_disc(shapely.get_coordinates(piece)) for piece in pieces if piece.area > 1e-12]
    centres, radii = np.array([centre for centre, _ in found]), np.array([radius for _, radius in found])
    inside = (body.b - centres @ body.A.T).min(axis=1)
    return Discs(centres, radii, max(0.0, float((radii - inside).max())))


def _bounding_axes(body: ConvexPolygon) -> tuple[Array, Array, Array]:
    """A corner and the two sides of the bounding rectangle of least area (one of its sides lies on an edge)."""
    normals, tangents = body.A, np.column_stack([-body.A[:, 1], body.A[:, 0]])
    u, v = body.vertices @ tangents.T, body.vertices @ normals.T
    width, height = np.ptp(u, axis=0), np.ptp(v, axis=0)
    edge = int(np.argmin(np.round(width * height, 9)))
    t, n = tangents[edge], normals[edge]
    return u[:, edge].min() * t + v[:, edge].min() * n, width[edge] * t, height[edge] * n


def _smallest_disc(points: Array) -> tuple[Array, float]:
    """Centre and radius of the smallest disc that contains the points."""
    circle = shapely.minimum_bounding_circle(shapely.MultiPoint(points))
    centre = np.array(circle.centroid.coords[0])
    return centre, float(np.hypot(*(points - centre).T).max())
