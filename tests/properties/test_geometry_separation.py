"""The closed-form separation against three oracles that share nothing with it.

- shapely: distance of disjoint polygons.
- The Minkowski difference V - O, built as a convex hull by shapely: the signed distance of the origin to it.
- Coal (GJK and EPA) on prisms so tall that the shortest way apart lies in the plane.
"""

import coal
import numpy as np
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from tightspot.geometry import ConvexPolygon, best_line, transform

HALF_HEIGHT = 100.0

grid = st.integers(-16, 16).map(lambda k: k / 4)
anywhere = st.floats(-4, 4).map(lambda x: round(x, 9))
points = st.one_of(*(st.lists(st.tuples(c, c), min_size=3, max_size=10) for c in (grid, anywhere)))
# Poses on the grid with quarter turns produce contact, shared edges and equal polygons; the others do not.
poses = st.one_of(
    st.tuples(grid, grid, st.integers(0, 3).map(lambda k: k * np.pi / 2)),
    st.tuples(st.floats(-8, 8), st.floats(-8, 8), st.floats(-4, 4)),
)


@st.composite
def polygons(draw):
    hull = shapely.MultiPoint(draw(points)).convex_hull
    assume(hull.geom_type == "Polygon" and hull.area > 1e-2)
    return ConvexPolygon.from_vertices(shapely.get_coordinates(hull))


@st.composite
def pairs(draw):
    """Vertices V, O of two polygons in any relation."""
    return transform(draw(polygons()).vertices, draw(poses)), draw(polygons()).vertices


def minkowski_clearance(V, O):
    """Signed distance of the origin to the boundary of {v - o}, negative inside."""
    hull = shapely.MultiPoint((V[:, None] - O[None]).reshape(-1, 2)).convex_hull
    distance = hull.exterior.distance(shapely.Point(0, 0))
    return -distance if hull.covers(shapely.Point(0, 0)) else distance


def prism(vertices):
    """Coal's convex body over a polygon."""
    corners = coal.StdVec_Vec3s()
    for z in (-HALF_HEIGHT, HALF_HEIGHT):
        for x, y in vertices:
            corners.append(np.array([x, y, z]))
    return coal.Convex.convexHull(corners, False, "")


@given(pairs())
def test_distance_of_disjoint_polygons_is_shapelys(pair):
    V, O = pair
    clearance = float(best_line(V, O).clearance)
    distance = shapely.Polygon(V).distance(shapely.Polygon(O))
    np.testing.assert_allclose(max(clearance, 0.0), distance, atol=1e-12)


@given(pairs())
def test_clearance_is_the_minkowski_differences_signed_distance(pair):
    V, O = pair
    np.testing.assert_allclose(best_line(V, O).clearance, minkowski_clearance(V, O), atol=1e-12)


@given(pairs())
def test_clearance_is_coals_signed_distance(pair):
    V, O = pair
    request = coal.DistanceRequest()
    request.enable_signed_distance = True
    here = coal.Transform3s()
    expected = coal.distance(prism(V), here, prism(O), here, request, coal.DistanceResult())
    np.testing.assert_allclose(best_line(V, O).clearance, expected, atol=1e-5)


@given(pairs())
def test_the_line_says_what_the_clearance_says(pair):
    V, O = pair
    line = best_line(V, O)
    scale = 1 + np.abs(V).max() + np.abs(O).max()
    np.testing.assert_allclose(np.hypot(*line.normal), 1.0, atol=4e-16)
    low, high = (O @ line.normal).max(), (V @ line.normal).min()
    np.testing.assert_allclose(high - low, line.clearance, atol=1e-14 * scale)
    np.testing.assert_allclose(0.5 * (low + high), line.offset, atol=1e-14 * scale)


@given(pairs(), st.integers(0, 200))
def test_no_other_normal_separates_better(pair, k):
    V, O = pair
    angle = 2 * np.pi * (k + np.arange(400) * 0.61803398875)
    n = np.stack([np.cos(angle), np.sin(angle)])
    assert ((V @ n).min(axis=0) - (O @ n).max(axis=0)).max() <= best_line(V, O).clearance + 1e-12


@given(pairs())
def test_the_penetration_depth_parts_them_and_less_does_not(pair):
    V, O = pair
    line = best_line(V, O)
    assume(line.clearance < -1e-3)
    obstacle = shapely.Polygon(O)
    parted = shapely.Polygon(V - (1 + 1e-9) * line.clearance * line.normal)
    assert not parted.intersects(obstacle)
    assert shapely.Polygon(V - 0.99 * line.clearance * line.normal).intersects(obstacle)


@given(pairs())
def test_exchanging_the_two_turns_the_normal_round(pair):
    V, O = pair
    there, back = best_line(V, O), best_line(O, V)
    np.testing.assert_allclose(there.clearance, back.clearance, atol=1e-13)
    # Of several best lines either may come back, so the turned normal must be as good, not the same.
    n = -back.normal
    np.testing.assert_allclose((V @ n).min() - (O @ n).max(), there.clearance, atol=1e-13)


@given(pairs(), poses)
def test_moving_both_changes_nothing_but_the_frame(pair, pose):
    V, O = pair
    line, moved = best_line(V, O), best_line(transform(V, pose), transform(O, pose))
    np.testing.assert_allclose(moved.clearance, line.clearance, atol=1e-12)
    n = transform(moved.normal[None], (0.0, 0.0, -pose[2]))[0]
    np.testing.assert_allclose((V @ n).min() - (O @ n).max(), line.clearance, atol=1e-12)


@given(polygons(), polygons(), st.lists(poses, min_size=1, max_size=20))
def test_a_batch_is_its_members_one_by_one(body, obstacle, path):
    V = transform(body.vertices, path)
    lines = best_line(V, obstacle.vertices)
    for i, vertices in enumerate(V):
        one = best_line(vertices, obstacle.vertices)
        np.testing.assert_allclose(lines.clearance[i], one.clearance, atol=1e-14)
        np.testing.assert_allclose(lines.normal[i], one.normal, atol=1e-12)
