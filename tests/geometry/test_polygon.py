"""ConvexPolygon: representations, conventions, refusals."""

import dataclasses
import doctest

import numpy as np
import pytest

import tightspot.geometry.polygon
from tightspot.errors import GeometryError
from tightspot.geometry import ConvexPolygon

SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
HEXAGON = np.stack([np.cos(np.arange(6) * np.pi / 3), np.sin(np.arange(6) * np.pi / 3)], axis=1)


@pytest.mark.parametrize("points", [SQUARE, HEXAGON, [(0, 0), (4, 1), (0, 3)], np.array(SQUARE) * 1e-3 + 70])
def test_vertex_i_is_where_edges_i_and_i_plus_1_meet(points):
    polygon = ConvexPolygon.from_vertices(points)
    V, A, b = polygon.vertices, polygon.A, polygon.b
    np.testing.assert_allclose((A * V).sum(axis=1), b, atol=1e-13)
    np.testing.assert_allclose((np.roll(A, -1, axis=0) * V).sum(axis=1), np.roll(b, -1), atol=1e-13)
    np.testing.assert_allclose(np.hypot(*A.T), 1.0, rtol=1e-15)
    assert np.less_equal(V @ A.T, b).all()
    edge = V - np.roll(V, 1, axis=0)
    np.testing.assert_allclose((A * edge).sum(axis=1), 0.0, atol=1e-13)
    assert (A @ polygon.centroid < b).all()


def test_rectangle_has_the_sides_it_was_given():
    polygon = ConvexPolygon.rectangle(-1, 3, 2, 4)
    np.testing.assert_array_equal(polygon.vertices, [(-1, 2), (3, 2), (3, 4), (-1, 4)])
    np.testing.assert_array_equal(polygon.A, [(-1, 0), (0, -1), (1, 0), (0, 1)])
    np.testing.assert_array_equal(polygon.b, [1, -2, 3, 4])
    assert polygon.area == 8
    np.testing.assert_allclose(polygon.centroid, [1, 3])
    assert polygon.radius == 5.0


@pytest.mark.parametrize(
    ("sides", "path"), [((1, 1, 0, 1), "x_min"), ((0, 1, 3, 2), "y_min"), ((0, float("nan"), 0, 1), "x_min")]
)
def test_rectangle_refuses_exchanged_sides(sides, path):
    with pytest.raises(GeometryError, match="must be less than") as caught:
        ConvexPolygon.rectangle(*sides)
    assert caught.value.problems[0].path == path


def test_it_is_an_immutable_value():
    polygon = ConvexPolygon.from_vertices(SQUARE)
    same = ConvexPolygon.from_vertices([(0.0, -0.0), *SQUARE[1:]])
    assert polygon == same
    assert hash(polygon) == hash(same)
    assert polygon != ConvexPolygon.rectangle(0, 1, 0, 2)
    assert polygon != SQUARE
    for array in (polygon.vertices, polygon.A, polygon.b, polygon.centroid):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 3.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        polygon.b = polygon.b


def test_the_input_array_is_copied():
    points = np.array(SQUARE, dtype=float)
    polygon = ConvexPolygon.from_vertices(points)
    points[0] = 9.0
    np.testing.assert_array_equal(polygon.vertices, SQUARE)


def test_the_constructor_validates_too():
    assert ConvexPolygon(np.array(SQUARE)[::-1]).area == 1.0
    with pytest.raises(GeometryError, match="not convex"):
        ConvexPolygon(np.array([(0, 0), (2, 0), (0.5, 0.5), (0, 2)]))


@pytest.mark.parametrize(
    ("points", "path", "words"),
    [
        (
            [(0, 0), (2, 0), (0.5, 0.5), (0, 2)],
            "o[2]",
            "not convex at (0.5, 0.5); split it with tightspot.geometry.decompose",
        ),
        ([(0, 2), (0.5, 0.5), (2, 0), (0, 0)], "o[1]", "not convex at (0.5, 0.5)"),
        ([(0, 0), (1, 1), (1, 0), (0, 1)], "o", "crosses itself"),
        (HEXAGON[[0, 2, 4, 1, 3, 5]], "o", "crosses itself"),
        ([(np.cos(0.8 * np.pi * k), np.sin(0.8 * np.pi * k)) for k in range(5)], "o", "crosses itself"),
        ([(0, 0), (1, 0), (2, 0)], "o", "zero area"),
        ([(0, 0), (1, 0), (1, float("nan"))], "o[2]", "finite"),
    ],
    ids=["dent", "clockwise dent", "bow-tie", "shuffled", "pentagram", "line", "nan"],
)
def test_what_is_not_convex_is_refused_with_its_place(points, path, words):
    with pytest.raises(GeometryError) as caught:
        ConvexPolygon.from_vertices(points, "o")
    assert caught.value.problems[0].path == path
    assert words in caught.value.problems[0].message


def test_a_square_walked_twice_is_refused():
    with pytest.raises(GeometryError):
        ConvexPolygon.from_vertices(SQUARE + SQUARE)


def test_halfplanes_in_any_order_and_scale_with_redundant_rows():
    A = np.array([(0, 5), (-1, 0), (1, 0), (1, 1), (0, -1e-3), (2, 0), (1, 1)])
    b = np.array([5, 0, 1, 7, 0, 2, 2])
    polygon = ConvexPolygon.from_halfplanes(A, b)
    assert polygon.area == pytest.approx(1.0)
    assert sorted(map(tuple, polygon.vertices.round(12).tolist())) == sorted(
        map(tuple, np.array(SQUARE, float).tolist())
    )


@pytest.mark.parametrize(
    ("A", "b", "words"),
    [
        ([(1, 0), (-1, 0), (0, 1)], [1, 1, 1], "unbounded"),
        ([(1, 0), (-1, 0)], [1, 1], "unbounded"),
        ([(1, 0)], [1], "unbounded"),
        ([(1, 0), (0, 1), (1, 1)], [1, 1, 1], "unbounded"),
        ([(1, 0), (-1, 0), (0, 1), (0, -1)], [1, -2, 1, 1], "no area in common"),
        ([(1, 0), (-1, 0), (0, 1), (0, -1)], [1, -1, 1, 1], "no area in common"),
        ([(1, 0), (0, 1), (-1, -1)], [0, 0, -1], "no area in common"),
        ([(1, 0), (0, 0), (-1, -1)], [0, 0, 1], "nonzero normal"),
        ([(1, 0), (0, float("nan")), (-1, -1)], [0, 0, 1], "finite"),
        ([(1, 0), (0, 1)], [1], "shapes"),
        (np.empty((0, 2)), [], "no area in common"),
        ("abc", [1], "numbers"),
    ],
)
def test_halfplanes_without_a_polygon_are_refused(A, b, words):
    with pytest.raises(GeometryError, match=words):
        ConvexPolygon.from_halfplanes(A, b)


def test_contains_is_batched_and_closed():
    polygon = ConvexPolygon.from_vertices(SQUARE)
    points = np.array([[(0.5, 0.5), (1.0, 0.5)], [(1.0 + 1e-9, 0.5), (-3, 0)]])
    np.testing.assert_array_equal(polygon.contains(points), [[True, True], [False, False]])
    np.testing.assert_array_equal(polygon.contains(points, tol=1e-8), [[True, True], [True, False]])
    assert polygon.contains((0, 0)).shape == ()


def test_transformed_moves_halfplanes_with_the_frame():
    polygon = ConvexPolygon.from_vertices(HEXAGON)
    x, y, theta = 3.0, -2.0, 0.7
    moved = polygon.transformed(x, y, theta)
    R = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
    np.testing.assert_allclose(moved.vertices, polygon.vertices @ R.T + [x, y], atol=1e-14)
    np.testing.assert_allclose(moved.A, polygon.A @ R.T, atol=1e-14)
    np.testing.assert_allclose(moved.b, polygon.b + polygon.A @ R.T @ [x, y], atol=1e-14)
    with pytest.raises(GeometryError, match="finite"):
        polygon.transformed(float("nan"), 0, 0)


def test_to_shapely_and_docstring():
    assert ConvexPolygon.from_vertices(HEXAGON).to_shapely().area == pytest.approx(1.5 * np.sqrt(3))
    assert repr(ConvexPolygon.rectangle(0, 1, 0, 1)).startswith("ConvexPolygon([[0.0, 0.0]")
    assert doctest.testmod(tightspot.geometry.polygon).failed == 0
