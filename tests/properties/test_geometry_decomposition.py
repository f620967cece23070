"""Decomposition of random nonconvex polygons with holes, made by shapely from unions and differences."""

import numpy as np
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from tightspot.geometry import decompose

whole = st.integers(0, 8)
size = st.integers(1, 5)


@st.composite
def boxes(draw):
    x, y, width, height = draw(whole), draw(whole), draw(size), draw(size)
    return shapely.box(x, y, x + width, y + height)


@st.composite
def tilted(draw):
    return shapely.affinity.rotate(draw(boxes()), draw(st.floats(1, 89)))


@st.composite
def triangles(draw):
    corners = [(draw(whole), draw(whole)) for _ in range(3)]
    shape = shapely.Polygon(corners)
    assume(shape.area > 0)
    return shape


@st.composite
def discs(draw):
    centre = shapely.Point(draw(st.floats(0, 8)), draw(st.floats(0, 8)))
    return centre.buffer(draw(st.floats(0.5, 2.0)), quad_segs=draw(st.integers(1, 3)))


@st.composite
def shapes(draw):
    """The largest piece of a union minus a union: holes, touching holes, thin necks, but no spikes."""
    kind = draw(st.sampled_from([boxes, tilted, triangles, discs]))
    solid = shapely.union_all(
        [shapely.box(1, 1, 7, 7)] * draw(st.booleans()) + draw(st.lists(kind(), min_size=1, max_size=4))
    )
    remainder = solid.difference(shapely.union_all(draw(st.lists(kind(), max_size=4))))
    # On a grid of 1e-6 shapely's own rounding leaves no slivers, which decompose rightly refuses.
    pieces = shapely.get_parts(shapely.set_precision(remainder, 1e-6))
    assume(len(pieces) > 0)
    piece = max(pieces, key=lambda p: p.area)
    assume(piece.area > 0.1 and piece.buffer(-1e-4).geom_type == "Polygon" and sharpest_corner(piece) > 1e-3)
    return piece


def rings(polygon):
    polygon = shapely.orient_polygons(polygon)
    return [shapely.get_coordinates(ring)[:-1] for ring in (polygon.exterior, *polygon.interiors)]


def turns(polygon):
    """Angles in rad by which the boundary turns left at its corners."""
    for ring in rings(polygon):
        arriving = ring - np.roll(ring, 1, axis=0)
        leaving = np.roll(arriving, -1, axis=0)
        cross = arriving[:, 0] * leaving[:, 1] - arriving[:, 1] * leaving[:, 0]
        yield from np.arctan2(cross, (arriving * leaving).sum(axis=1))


def sharpest_corner(polygon):
    return min(np.pi - abs(turn) for turn in turns(polygon))


def reflex_count(polygon):
    return sum(turn < -1e-12 for turn in turns(polygon))


@given(shapes())
def test_parts_cover_exactly_and_do_not_overlap(polygon):
    exterior, *holes = rings(polygon)
    parts = [part.to_shapely() for part in decompose(exterior, holes)]
    assert shapely.union_all(parts).symmetric_difference(polygon).area <= 1e-9 * polygon.area
    np.testing.assert_allclose(sum(part.area for part in parts), polygon.area, rtol=1e-9)
    tree = shapely.STRtree(parts)
    for i, j in tree.query(parts, predicate="intersects").T:
        if i < j:
            assert parts[i].intersection(parts[j]).area <= 1e-9 * polygon.area


@given(shapes())
def test_parts_are_convex_and_use_only_given_vertices(polygon):
    exterior, *holes = rings(polygon)
    given_vertices = {tuple(point) for point in np.concatenate([exterior, *holes]).tolist()}
    for part in decompose(exterior, holes):
        shape = part.to_shapely()
        assert shape.convex_hull.area - shape.area <= 1e-9 * shape.area
        assert {tuple(point) for point in part.vertices.tolist()} <= given_vertices


@given(shapes())
def test_the_number_of_parts_is_bounded_by_the_reflex_corners(polygon):
    exterior, *holes = rings(polygon)
    reflex = reflex_count(polygon)
    count = len(decompose(exterior, holes))
    # Two diagonals settle any reflex corner, and each hole joined to the rest costs a part less than it adds.
    assert count <= 2 * reflex + 1 - len(holes)
    if not holes:  # a diagonal settles two corners at most, so convex comes back as one
        assert (reflex > 0) or count == 1
        assert count >= 1 + (reflex + 1) // 2


@given(shapes(), st.integers(0, 5), st.booleans())
def test_start_and_winding_do_not_matter_for_the_cover(polygon, start, reverse):
    exterior, *holes = (np.roll(ring, start, axis=0)[:: -1 if reverse else 1] for ring in rings(polygon))
    parts = [part.to_shapely() for part in decompose(exterior, holes)]
    assert shapely.union_all(parts).symmetric_difference(polygon).area <= 1e-9 * polygon.area
