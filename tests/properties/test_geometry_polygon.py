"""ConvexPolygon against shapely, for hulls of random points on a grid (often degenerate) and off it."""

import numpy as np
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from tightspot.geometry import ConvexPolygon

grid = st.integers(-16, 16).map(lambda k: k / 4)
anywhere = st.floats(-10, 10).map(lambda x: round(x, 9))
points = st.one_of(*(st.lists(st.tuples(c, c), min_size=3, max_size=12) for c in (grid, anywhere)))
angles = st.floats(-10, 10)


@st.composite
def hulls(draw):
    hull = shapely.MultiPoint(draw(points)).convex_hull
    assume(hull.geom_type == "Polygon" and hull.area > 1e-3)
    return hull


@given(hulls(), st.integers(0, 11), st.booleans(), st.booleans())
def test_any_start_winding_and_repetition_gives_the_hull(hull, start, reverse, twice):
    ring = np.roll(shapely.get_coordinates(hull)[:-1], start, axis=0)
    ring = np.repeat(ring[::-1] if reverse else ring, 1 + twice, axis=0)
    polygon = ConvexPolygon.from_vertices(ring)
    shape = polygon.to_shapely()
    assert shape.exterior.is_ccw
    assert shape.hausdorff_distance(hull) <= 1e-7
    np.testing.assert_allclose(polygon.area, hull.area, rtol=1e-8)
    np.testing.assert_allclose(polygon.centroid, shapely.get_coordinates(hull.centroid)[0], atol=1e-6)
    np.testing.assert_allclose(polygon.radius, np.hypot(*ring.T).max(), atol=1e-7)


@given(hulls(), st.lists(st.tuples(grid, grid), min_size=1, max_size=30))
def test_contains_agrees_with_shapely_away_from_the_boundary(hull, samples):
    polygon = ConvexPolygon.from_vertices(shapely.get_coordinates(hull))
    away = shapely.distance(hull.boundary, shapely.points(samples)) > 1e-7
    expected = shapely.contains_xy(hull, *np.transpose(samples))
    np.testing.assert_array_equal(polygon.contains(samples)[away], expected[away])
    assert polygon.contains(polygon.vertices, tol=1e-12).all()


@given(hulls(), st.randoms(use_true_random=False))
def test_halfplanes_give_the_polygon_back(hull, random):
    polygon = ConvexPolygon.from_vertices(shapely.get_coordinates(hull))
    order = random.sample(range(len(polygon.b)), len(polygon.b))
    scale = np.array([random.uniform(0.01, 100) for _ in order])
    slack = np.array([random.uniform(0.0, 3.0) for _ in order])
    A = np.concatenate([polygon.A[order] * scale[:, None], polygon.A])
    b = np.concatenate([polygon.b[order] * scale, polygon.b + slack])
    back = ConvexPolygon.from_halfplanes(A, b)
    assert back.to_shapely().hausdorff_distance(polygon.to_shapely()) <= 1e-6
    np.testing.assert_allclose(back.area, polygon.area, rtol=1e-7)


@given(hulls(), grid, grid, angles)
def test_a_moved_polygon_is_the_polygon_moved(hull, x, y, theta):
    polygon = ConvexPolygon.from_vertices(shapely.get_coordinates(hull))
    moved = polygon.transformed(x, y, theta)
    expected = shapely.affinity.translate(
        shapely.affinity.rotate(polygon.to_shapely(), theta, origin=(0, 0), use_radians=True), x, y
    )
    np.testing.assert_allclose(moved.vertices, shapely.get_coordinates(expected)[:-1], atol=1e-12)
    np.testing.assert_allclose(moved.area, polygon.area, rtol=1e-9)
    np.testing.assert_allclose((moved.A * moved.vertices).sum(axis=1), moved.b, atol=1e-12)
