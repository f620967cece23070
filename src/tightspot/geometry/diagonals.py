"""Which diagonals cut a polygon with holes into few convex parts.

A diagonal joins two vertices through the interior. Parts are convex exactly if at every reflex corner
(interior angle above pi) the chosen diagonals leave no angle above pi. Diagonals that do not cross always
extend to a triangulation, where that holds, so choosing one after the other does not get stuck. The number of
parts grows with the number of diagonals; one that settles the reflex corners at both its ends counts twice.
So: a greedy choice, then a bounded number of attempts to do better by choosing a neighbourhood anew. Measured
against the optimum (an integer program over the same diagonals) on two dozen shapes: equal up to 70 reflex
corners, within 2 % at 250. Beyond :data:`MANY` reflex corners the diagonals of a triangulation are dropped one
after the other as long as no angle above pi is left, which takes seconds for ten thousand vertices and gives
at most four times the fewest parts.

Reference:
    S. Hertel and K. Mehlhorn, Fast triangulation of simple polygons, FCT 1983: two diagonals settle any
    corner.
"""

from __future__ import annotations

import bisect
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from tightspot.geometry.rings import tolerance

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Lines = NDArray[np.object_]

FLAT = np.pi + 1e-12
MANY = 400
"""Reflex corners beyond which no search is made."""
_ALL_VISIBLE = 2_000  # pairs of vertices, beyond which only Delaunay diagonals are tried
_EFFORT = 3000  # rounds of improvement times reflex corners: a round's cost grows faster than the corners
_THROUGH_THE_INTERIOR = "1FFF0F***"  # DE-9IM of a segment with its ends on the boundary and nothing else


class Outline(NamedTuple):
    """A polygon as indices into its distinct points.

    Attributes:
        points: m, shape (n, 2). A point where two rings touch is listed once.
        rings: Indices of each ring, the interior on the left: the exterior first, counter-clockwise, then
            holes.
        polygon: The same for shapely.
    """

    points: Array
    rings: list[Indices]
    polygon: shapely.Polygon


class Corner(NamedTuple):
    """A reflex corner: at ``point`` the interior spans the angle ``width`` > pi, leftward from ``start``."""

    point: int
    start: Array
    width: float


class _Choice(NamedTuple):
    """The diagonals (ids) at a corner with the angles in which they leave it, from the corner's start."""

    diagonal: Indices
    angle: Array


class _Gap(NamedTuple):
    """The angles between which a corner is still reflex."""

    low: float
    high: float


def few_diagonals(outline: Outline) -> Indices | None:
    """Diagonals, shape (m, 2) indices of points, that cut the outline into few convex parts.

    ``None`` if no choice was found, which takes a polygon with necks or steps as small as the rounding.
    """
    corners = reflex_corners(outline)
    if not corners:
        return np.empty((0, 2), dtype=np.intp)
    if len(corners) > MANY:
        return _essential(corners, outline)
    small = len(corners) * len(outline.points) <= _ALL_VISIBLE
    for candidates in (visible_diagonals, delaunay_diagonals) if small else (delaunay_diagonals,):
        pairs = candidates(outline, np.array([corner.point for corner in corners]))
        lines = shapely.linestrings(outline.points[pairs])
        chosen = _fewest(_Puzzle(corners, outline.points, pairs, lines), lines)
        if chosen is not None:
            return pairs[chosen]
    return None


def reflex_corners(outline: Outline) -> list[Corner]:
    """The corners with an interior angle above pi; a point where rings touch has several corners."""
    starts: dict[int, list[Array]] = {}
    ends: dict[int, list[Array]] = {}
    for ring in outline.rings:
        leaving = outline.points[np.roll(ring, -1)] - outline.points[ring]
        arriving = np.roll(leaving, 1, axis=0)
        for at, out, back in zip(ring, leaving, -arriving, strict=True):
            starts.setdefault(int(at), []).append(out)
            ends.setdefault(int(at), []).append(back)
    corners = [
        Corner(at, start, float(_angles(start, np.array(ends[at])).min()))
        for at, out in starts.items()
        for start in out
    ]
    return [corner for corner in corners if corner.width > FLAT]


def _angles(start: Array, directions: Array) -> Array:
    """Angles in [0, 2 pi) by which ``start`` (2,) turns left into the directions (m, 2)."""
    cross = start[0] * directions[:, 1] - start[1] * directions[:, 0]
    return np.asarray(np.arctan2(cross, directions @ start) % (2 * np.pi))


def visible_diagonals(outline: Outline, ends: Indices) -> Indices:
    """All diagonals with at least one of these ends that keep clear of every other vertex."""
    pairs = np.stack(np.meshgrid(ends, np.arange(len(outline.points)), indexing="ij"), axis=-1).reshape(-1, 2)
    pairs = np.unique(np.sort(pairs[pairs[:, 0] != pairs[:, 1]], axis=1), axis=0)
    lines = shapely.linestrings(outline.points[pairs])
    shapely.prepare(outline.polygon)
    middles = shapely.line_interpolate_point(lines, 0.5, normalized=True)
    inside = shapely.contains_properly(outline.polygon, middles)
    pairs, lines = pairs[inside], lines[inside]
    inside = shapely.relate_pattern(lines, outline.polygon, _THROUGH_THE_INTERIOR)
    pairs, lines = pairs[inside], lines[inside]
    near = shapely.STRtree(shapely.points(outline.points)).query(
        lines, predicate="dwithin", distance=tolerance(outline.points)
    )[0]
    clear: Indices = pairs[np.bincount(near, minlength=len(pairs)) == 2]
    return clear


def delaunay_diagonals(outline: Outline, ends: Indices) -> Indices:
    """The diagonals of a constrained Delaunay triangulation with at least one of these ends.

    None if there is no triangulation of these vertices, which takes a boundary that almost touches itself.
    """
    index = {point: i for i, point in enumerate(map(tuple, outline.points.tolist()))}
    try:
        triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(outline.polygon))
        vertices = map(tuple, shapely.get_coordinates(triangles).tolist())
        closed = np.array([index[point] for point in vertices], dtype=np.intp).reshape(-1, 4)
    except (shapely.errors.GEOSException, KeyError):
        return np.empty((0, 2), dtype=np.intp)
    sides = np.unique(np.sort(np.concatenate([closed[:, i : i + 2] for i in range(3)]), axis=1), axis=0)
    boundary = {
        (min(pair), max(pair))
        for ring in outline.rings
        for pair in zip(ring.tolist(), np.roll(ring, -1).tolist(), strict=True)
    }
    diagonal = [tuple(side) not in boundary for side in sides.tolist()]
    return sides[np.isin(sides, ends).any(axis=1) & np.array(diagonal, dtype=bool)]


def _essential(corners: list[Corner], outline: Outline) -> Indices:
    """What is left of a triangulation's diagonals after each, longest first, was dropped if that leaves no angle
    above pi (Hertel and Mehlhorn).
    """
    pairs = delaunay_diagonals(outline, np.array([corner.point for corner in corners]))
    at: list[list[tuple[int, float]]] = [[] for _ in pairs]
    angles: list[list[float]] = []
    for i, corner in enumerate(corners):
        choice = _choice(corner, outline.points, pairs)
        angles.append([0.0, *sorted(choice.angle.tolist()), corner.width])
        for diagonal, angle in zip(choice.diagonal.tolist(), choice.angle.tolist(), strict=True):
            at[diagonal].append((i, angle))
    length = np.hypot(*(outline.points[pairs[:, 0]] - outline.points[pairs[:, 1]]).T)
    kept = np.ones(len(pairs), dtype=bool)
    for diagonal in np.argsort(-length, kind="stable").tolist():
        places = [(angles[i], bisect.bisect_left(angles[i], angle)) for i, angle in at[diagonal]]
        if all(around[j + 1] - around[j - 1] <= FLAT for around, j in places):
            kept[diagonal] = False
            for around, j in places:
                del around[j]
    return pairs[kept]


def _choice(corner: Corner, points: Array, diagonals: Indices) -> _Choice:
    here = np.flatnonzero((diagonals == corner.point).any(axis=1))
    other = diagonals[here].sum(axis=1) - corner.point
    angle = _angles(corner.start, points[other] - points[corner.point])
    within = angle < corner.width
    return _Choice(here[within], angle[within])


def _fewest(puzzle: _Puzzle, lines: Lines) -> Indices | None:
    """Greedy choice, then rounds that take some neighbouring diagonals out and complete the rest anew."""
    best = puzzle.complete([], puzzle.length)
    if best is None:
        return None
    random = np.random.default_rng(0)
    middles = shapely.get_coordinates(shapely.line_interpolate_point(lines, 0.5, normalized=True))
    enough = (len(puzzle.corners) + 1) // 2
    for _ in range(min(_EFFORT // len(puzzle.corners), 8 * len(puzzle.corners))):
        if len(best) <= enough:
            break
        centre = middles[random.choice(best)]
        nearest = np.argsort(np.hypot(*(middles[best] - centre).T))
        dropped = set(nearest[: random.integers(2, 8)].tolist())
        kept = [diagonal for i, diagonal in enumerate(best) if i not in dropped]
        other = puzzle.complete(kept, puzzle.length * random.uniform(0.5, 2.0, len(lines)))
        if other is not None and len(other) <= len(best):
            best = other
    return np.array(best, dtype=np.intp)


def _crossings(points: Array, diagonals: Indices) -> NDArray[np.bool_]:
    """Which diagonals cross which, shape (m, m): the ends of each lie on different sides of the other.

    No end lies on another diagonal but at its ends, see :func:`visible_diagonals`, so signs do not depend on rounding.
    """
    start, end = points[diagonals[:, 0]], points[diagonals[:, 1]]
    along = end - start

    def side(of: Array) -> Array:
        """On which side of diagonal i (row) point j (column) lies."""
        x, y = of[None, :, 0] - start[:, None, 0], of[None, :, 1] - start[:, None, 1]
        return np.sign(along[:, None, 0] * y - along[:, None, 1] * x)

    parted: NDArray[np.bool_] = side(start) * side(end) < 0
    parted &= parted.T
    parted &= ~(diagonals[:, None, :, None] == diagonals[None, :, None, :]).any(axis=(2, 3))
    return parted


class _Puzzle:
    """The choice of diagonals (ids) that do not cross and leave no angle above pi at any corner."""

    def __init__(self, corners: list[Corner], points: Array, diagonals: Indices, lines: Lines) -> None:
        self.corners = corners
        self.length: Array = shapely.length(lines)
        self.crossing = _crossings(points, diagonals)
        self.choices = [_choice(corner, points, diagonals) for corner in corners]
        self.at: list[list[tuple[int, float]]] = [[] for _ in lines]
        for i, choice in enumerate(self.choices):
            for diagonal, angle in zip(choice.diagonal.tolist(), choice.angle.tolist(), strict=True):
                self.at[diagonal].append((i, angle))

    def complete(self, kept: list[int], cost: Array) -> list[int] | None:
        """Add diagonals, first those that settle two corners, then those of low cost, until all are settled.

        ``None`` if that gets stuck.
        """
        gaps = {i: _Gap(0.0, corner.width) for i, corner in enumerate(self.corners)}
        for diagonal in kept:
            self._divide(gaps, diagonal)
        free: NDArray[np.bool_] = ~np.logical_or.reduce(self.crossing[kept], axis=0)
        kept = list(kept)
        while gaps:
            following = self._next(gaps, free, cost)
            if following is None:
                return None
            kept.append(following)
            self._divide(gaps, following)
            free &= ~self.crossing[following]
        return kept

    def _divide(self, gaps: dict[int, _Gap], diagonal: int) -> None:
        """Narrow the gaps at the diagonal's ends, and forget those that are settled."""
        for corner, angle in self.at[diagonal]:
            gap = gaps.get(corner)
            if gap is None or not gap.low < angle < gap.high:
                continue
            del gaps[corner]
            for piece in (_Gap(gap.low, angle), _Gap(angle, gap.high)):
                if piece.high - piece.low > FLAT:
                    gaps[corner] = piece

    def _next(self, gaps: dict[int, _Gap], free: NDArray[np.bool_], cost: Array) -> int | None:
        """The best diagonal at the corner with the fewest that settle anything."""
        fewest: list[tuple[int, float, int]] = []
        for corner, gap in gaps.items():
            choice = self.choices[corner]
            usable = free[choice.diagonal] & (gap.low < choice.angle) & (choice.angle < gap.high)
            options = [(-self._settled(d, gaps), cost[d], d) for d in choice.diagonal[usable].tolist()]
            settling = [option for option in options if option[0]] or options
            if not fewest or len(settling) < len(fewest):
                fewest = settling
        return min(fewest)[2] if fewest else None

    def _settled(self, diagonal: int, gaps: dict[int, _Gap]) -> int:
        return sum(
            gaps[corner].low < angle < gaps[corner].high
            and angle - gaps[corner].low <= FLAT
            and gaps[corner].high - angle <= FLAT
            for corner, angle in self.at[diagonal]
            if corner in gaps
        )
