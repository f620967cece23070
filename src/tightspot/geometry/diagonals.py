"""Which diagonals cut a polygon with holes into few convex parts.

A diagonal joins two vertices through the interior. Parts are convex exactly if at every reflex corner (interior
angle above pi) the chosen diagonals leave no angle above pi. Any set of diagonals that do not cross extends to a
triangulation, where that holds, so choosing one after the other never gets stuck. The number of parts grows with
the number of diagonals; one that settles the reflex corners at both its ends counts twice. The search is depth first
with the bound that a diagonal settles at most two corners: for small polygons it ends with the best choice among the
branches it takes, for large ones it stops at its budget with the best found so far.

Reference:
    B. Chazelle and D. Dobkin, Optimal convex decompositions, 1985; S. Hertel and K. Mehlhorn, Fast triangulation of
    simple polygons, FCT 1983, for the fact that two diagonals always settle a corner.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

FLAT = np.pi + 1e-12
_ALL_VISIBLE = (
    6_000  # more pairs of vertices than that: only the diagonals of a Delaunay triangulation are tried
)
_WORK = 60_000  # corners looked at, over all nodes of the search, after the first solution
_THROUGH_THE_INTERIOR = "1FFF0F***"  # DE-9IM of a segment with its ends on the boundary and nothing else


class Outline(NamedTuple):
    """A polygon as indices into its distinct points.

    Attributes:
        points: m, shape (n, 2). A point where two rings touch is listed once.
        rings: Indices of each ring, the interior on the left: the exterior first, counter-clockwise, then holes.
        polygon: The same for shapely.
    """

    points: Array
    rings: list[Indices]
    polygon: shapely.Polygon


class Corner(NamedTuple):
    """A reflex corner: interior directions at ``point`` are ``start`` turned by angles in [0, width], width > pi."""

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


def few_diagonals(outline: Outline) -> Indices:
    """Diagonals, shape (m, 2) indices of points, that cut the outline into few convex parts."""
    corners = reflex_corners(outline)
    if not corners:
        return np.empty((0, 2), dtype=np.intp)
    diagonals, lines = _candidates(outline, corners)
    tree = shapely.STRtree(lines)
    crossing = np.zeros((len(lines), len(lines)), dtype=bool)
    crossing[tuple(tree.query(lines, predicate="crosses"))] = True
    choices = [_choice(corner, outline.points, diagonals) for corner in corners]
    return diagonals[_fewest(corners, choices, crossing, shapely.length(lines))]


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


def _candidates(outline: Outline, corners: list[Corner]) -> tuple[Indices, NDArray[np.object_]]:
    """Diagonals with at least one end at a reflex corner: all, or those of a Delaunay triangulation if too many."""
    reflex = np.unique([corner.point for corner in corners])
    if len(reflex) * len(outline.points) <= _ALL_VISIBLE:
        pairs = np.stack(np.meshgrid(reflex, np.arange(len(outline.points)), indexing="ij"), axis=-1).reshape(
            -1, 2
        )
    else:
        pairs = _delaunay_edges(outline)
        pairs = pairs[np.isin(pairs, reflex).any(axis=1)]
    pairs = np.unique(np.sort(pairs, axis=1), axis=0)
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    lines = shapely.linestrings(outline.points[pairs])
    shapely.prepare(outline.polygon)
    inside = shapely.contains_properly(
        outline.polygon, shapely.line_interpolate_point(lines, 0.5, normalized=True)
    )
    pairs, lines = pairs[inside], lines[inside]
    inside = shapely.relate_pattern(lines, outline.polygon, _THROUGH_THE_INTERIOR)
    return pairs[inside], lines[inside]


def _delaunay_edges(outline: Outline) -> Indices:
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(outline.polygon))
    corners = shapely.get_coordinates(triangles).reshape(-1, 4, 2)
    index = {tuple(point): i for i, point in enumerate(outline.points.tolist())}
    ids = np.array([index[tuple(point)] for point in corners.reshape(-1, 2).tolist()], dtype=np.intp).reshape(
        -1, 4
    )
    return np.concatenate([ids[:, i : i + 2] for i in range(3)])


def _choice(corner: Corner, points: Array, diagonals: Indices) -> _Choice:
    here = np.flatnonzero((diagonals == corner.point).any(axis=1))
    other = diagonals[here].sum(axis=1) - corner.point
    angle = _angles(corner.start, points[other] - points[corner.point])
    within = angle < corner.width
    return _Choice(here[within], angle[within])


def _fewest(
    corners: list[Corner], choices: list[_Choice], crossing: NDArray[np.bool_], length: Array
) -> Indices:
    """Ids of few diagonals that do not cross and settle all corners; short ones first where it does not matter."""
    at: list[list[tuple[int, float]]] = [[] for _ in length]
    for i, choice in enumerate(choices):
        for diagonal, angle in zip(choice.diagonal, choice.angle, strict=True):
            at[diagonal].append((i, float(angle)))
    whole = tuple(_Gap(0.0, corner.width) for corner in corners)
    best: tuple[int, ...] | None = None
    work = 0
    stack: list[tuple[int, ...]] = [()]
    while stack and (best is None or work < _WORK):
        kept = stack.pop()
        gaps = _open_gaps(whole, kept, at)
        work += len(gaps)
        if best is not None and len(kept) + (len(gaps) + 1) // 2 >= len(best):
            continue
        if not gaps:
            best = kept
            continue
        free = ~crossing[list(kept)].any(axis=0)
        stack.extend((*kept, diagonal) for diagonal in _branches(gaps, choices, free, at, length))
    return np.array(best, dtype=np.intp)


def _open_gaps(
    whole: tuple[_Gap, ...], kept: tuple[int, ...], at: list[list[tuple[int, float]]]
) -> dict[int, _Gap]:
    """The corners not yet settled by the kept diagonals, with the angles that are left above pi."""
    gaps = dict(enumerate(whole))
    for diagonal in kept:
        for corner, angle in at[diagonal]:
            gap = gaps.get(corner)
            if gap is None or not gap.low < angle < gap.high:
                continue
            gaps.pop(corner)
            for piece in (_Gap(gap.low, angle), _Gap(angle, gap.high)):
                if piece.high - piece.low > FLAT:
                    gaps[corner] = piece
    return gaps


def _settles(angle: float, gap: _Gap) -> bool:
    return gap.low < angle < gap.high and angle - gap.low <= FLAT and gap.high - angle <= FLAT


def _branches(
    gaps: dict[int, _Gap],
    choices: list[_Choice],
    free: NDArray[np.bool_],
    at: list[list[tuple[int, float]]],
    length: Array,
) -> list[int]:
    """Diagonals to try next, at the corner with the fewest that settle anything; the most promising last."""
    fewest: list[tuple[int, float, int]] = []
    for corner, gap in gaps.items():
        choice = choices[corner]
        open_here = free[choice.diagonal] & (gap.low < choice.angle) & (choice.angle < gap.high)
        options = []
        for diagonal in choice.diagonal[open_here].tolist():
            settled = sum(c in gaps and _settles(angle, gaps[c]) for c, angle in at[diagonal])
            options.append((settled, -float(length[diagonal]), diagonal))
        settling = [option for option in options if option[0]] or options
        if not fewest or len(settling) < len(fewest):
            fewest = settling
    return [diagonal for _, _, diagonal in sorted(fewest)]
