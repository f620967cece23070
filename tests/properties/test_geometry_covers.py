"""Covers of random heaps of convex polygons, judged by shapely."""

import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from tightspot.geometry import ConvexPolygon, covers

grid = st.integers(0, 24).map(lambda k: k / 8)
points = st.lists(st.tuples(grid, grid), min_size=3, max_size=8)


@st.composite
def polygons(draw):
    hull = shapely.MultiPoint(draw(points)).convex_hull
    assume(hull.geom_type == "Polygon" and hull.area > 1e-3)
    shift = draw(st.tuples(st.floats(-1e-3, 1e-3), st.floats(-1e-3, 1e-3)))
    return ConvexPolygon.from_vertices(shapely.get_coordinates(hull) + shift)


def union(parts):
    return shapely.union_all([part.to_shapely() for part in parts])


@settings(max_examples=60)
@given(st.lists(polygons(), min_size=1, max_size=12), st.sampled_from([1e-4, 1e-3, 0.1]))
def test_a_merged_cover_is_smaller_in_number_and_never_in_area(parts, tolerance):
    found = covers.merged(parts, union(parts), tolerance)
    assert sorted(i for item in found for i in item.indices) == list(range(len(parts)))
    result = [item.polygon for item in found]
    assert len(result) <= len(parts)
    assert union(parts).difference(union(result)).area <= 1e-13
    assert union(parts).buffer(tolerance + 1e-9, quad_segs=64).covers(union(result))


@given(polygons(), st.floats(1e-6, 0.5))
def test_a_simplified_polygon_contains_the_polygon_and_stays_near(polygon, tolerance):
    simple = covers.simplified(polygon, tolerance)
    assert len(simple.vertices) <= len(polygon.vertices)
    assert simple.contains(polygon.vertices, tol=1e-12).all()
    assert polygon.to_shapely().hausdorff_distance(simple.to_shapely()) <= tolerance * (1 + 1e-9)
