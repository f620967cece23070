"""Decomposition: known optima, degenerate but legal input, refusals that name the place."""

import doctest

import numpy as np
import pytest
import shapely

import tightspot.geometry.decomposition
from tightspot.errors import GeometryError
from tightspot.geometry import ConvexPolygon, decompose, diagonals

SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4)]
HOLE = [(1, 1), (3, 1), (3, 3), (1, 3)]
L = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
T = [(0, 2), (0, 1), (1, 1), (1, 0), (2, 0), (2, 1), (3, 1), (3, 2)]
U = [(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)]
H = [(0, 0), (1, 0), (1, 1), (2, 1), (2, 0), (3, 0), (3, 3), (2, 3), (2, 2), (1, 2), (1, 3), (0, 3)]
PLUS = [(1, 0), (2, 0), (2, 1), (3, 1), (3, 2), (2, 2), (2, 3), (1, 3), (1, 2), (0, 2), (0, 1), (1, 1)]
STAIRS = [(0, 0), (4, 0), *((4 - k // 2, (k + 1) // 2) for k in range(1, 8)), (0, 4)]
COMB = [
    (0, 0),
    (9, 0),
    (9, 5),
    *(p for k in (8, 6, 4, 2) for p in [(k, 5), (k, 1), (k - 1, 1), (k - 1, 5)]),
    (0, 5),
]


def circle(n, radius=1.0, centre=(0.0, 0.0)):
    angle = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return np.stack([np.cos(angle), np.sin(angle)], axis=1) * radius + centre


def check_cover(parts, exterior, holes=()):
    polygon = shapely.Polygon(exterior, holes)
    shapes = [part.to_shapely() for part in parts]
    assert shapely.union_all(shapes).symmetric_difference(polygon).area <= 1e-9 * polygon.area
    assert sum(part.area for part in parts) == pytest.approx(polygon.area, rel=1e-9)


@pytest.mark.parametrize(
    ("exterior", "holes", "count"),
    [
        (SQUARE, (), 1),
        (circle(60), (), 1),
        (L, (), 2),
        (T, (), 2),
        (U, (), 3),
        (H, (), 3),
        (PLUS, (), 3),
        (STAIRS, (), 4),
        (COMB, (), 6),
        (SQUARE, [HOLE], 4),
        (SQUARE, [circle(3, 1, (2, 2))], 4),
        (circle(12, 3), [circle(5)], 5),
    ],
    ids=["square", "disc", "L", "T", "U", "H", "plus", "stairs", "comb", "frame", "triangular hole", "nut"],
)
def test_known_shapes_come_back_in_the_fewest_parts(exterior, holes, count):
    parts = decompose(exterior, holes)
    check_cover(parts, exterior, holes)
    assert len(parts) == count


def test_a_convex_polygon_keeps_its_vertices_in_order():
    (part,) = decompose(circle(7))
    np.testing.assert_array_equal(part.vertices, circle(7))


@pytest.mark.parametrize(
    ("exterior", "holes"),
    [
        ([*L, L[0]], ()),
        (L[::-1], ()),
        ([p for p in L for _ in range(3)], ()),
        ([(0, 0), (1, 0), (2, 0), (2, 0.5), (2, 1), (1.5, 1), (1, 1), (1, 2), (0, 2), (0, 1)], ()),
    ],
    ids=["closed", "clockwise", "repeated", "collinear"],
)
def test_winding_closing_repeated_and_collinear_vertices_do_not_matter(exterior, holes):
    parts = decompose(exterior, holes)
    assert len(parts) == 2
    check_cover(parts, L)


@pytest.mark.parametrize(
    "holes",
    [
        [HOLE[::-1]],
        [[(0, 2), (2, 1), (2, 3)]],
        [[(0, 0), (2, 1), (1, 2)]],
        [[(1, 1), (2, 1), (2, 2)], [(2, 2), (3, 2), (3, 3)]],
        [[(1, 1), (2, 1), (2, 3), (1, 3)], [(2, 2), (3, 1), (3, 3)]],
        [[(0, 2), (1, 1), (1, 2)], [(4, 2), (3, 3), (3, 2)]],
    ],
    ids=["winding", "on an edge", "in a corner", "corner to corner", "corner to edge", "both sides"],
)
def test_holes_may_touch_in_points(holes):
    check_cover(decompose(SQUARE, holes), SQUARE, holes)


def test_parts_do_not_depend_on_where_the_ring_starts():
    expected = {frozenset(map(tuple, part.vertices.tolist())) for part in decompose(T)}
    for k in range(len(T)):
        parts = decompose(np.roll(T, k, axis=0))
        assert {frozenset(map(tuple, part.vertices.tolist())) for part in parts} == expected


def test_a_plate_with_many_holes_is_far_from_a_triangulation():
    holes = [circle(9, 0.4, (1 + i, 1 + j)) for i in range(3) for j in range(3)]
    exterior = [(0, 0), (4, 0), (4, 4), (0, 4)]
    parts = decompose(exterior, holes)
    check_cover(parts, exterior, holes)
    triangles = shapely.get_num_geometries(shapely.constrained_delaunay_triangles(shapely.Polygon(exterior, holes)))
    assert len(parts) <= 0.55 * triangles


def test_large_polygons_use_the_triangulation_and_still_cover(monkeypatch):
    monkeypatch.setattr(diagonals, "_ALL_VISIBLE", 0)
    for exterior, holes, count in [
        (L, (), 2),
        (PLUS, (), 3),
        (SQUARE, [HOLE], 4),
        (SQUARE, [[(0, 2), (2, 1), (2, 3)]], 3),
    ]:
        parts = decompose(exterior, holes)
        check_cover(parts, exterior, holes)
        assert len(parts) == count


@pytest.mark.parametrize("size", [1e-4, 1e6])
def test_sizes_from_hairline_to_country(size):
    parts = decompose(np.multiply(size, PLUS))
    check_cover(parts, np.multiply(size, PLUS))
    assert len(parts) == 3


@pytest.mark.parametrize(
    ("exterior", "holes", "path", "words"),
    [
        ([(0, 0), (1, 1), (1, 0), (0, 1)], (), "o", "crosses itself at (0.5, 0.5)"),
        ([(0, 0), (1, 1), (2, 2), (2, 0), (1, 1), (0, 2)], (), "o", "crosses itself at (1, 1)"),
        ([(0, 0), (4, 0), (4, 4), (1, 1), (3, 1), (0, 4)], (), "o", "crosses itself"),
        (SQUARE, [[(1, 1), (2, 2), (2, 1), (1, 2)]], "o.holes[0]", "crosses itself at (1.5, 1.5)"),
        (SQUARE, [HOLE, [(5, 5), (6, 5), (6, 6)]], "o.holes[1]", "outside the exterior"),
        (SQUARE, [[(3, 3), (5, 3), (5, 5), (3, 5)]], "o.holes[0]", "outside the exterior"),
        (SQUARE, [[(-1, -1), (5, -1), (5, 5), (-1, 5)]], "o.holes[0]", "outside the exterior"),
        (SQUARE, [HOLE, [(2, 2), (3.5, 2), (3.5, 3.5)]], "o.holes[1]", "overlaps o.holes[0]"),
        (SQUARE, [HOLE, [(1.5, 1.5), (2, 1.5), (2, 2)]], "o.holes[1]", "overlaps o.holes[0]"),
        (SQUARE, [[(0, 1), (2, 1), (2, 3), (0, 3)]], "o", "share an edge"),
        (SQUARE, [[(0, 2), (2, 0), (4, 2), (2, 4)]], "o", "cut the polygon into pieces"),
        (SQUARE, [SQUARE], "o", "share an edge"),
        ([(0, 0), (1, 0), (2, 0)], (), "o", "zero area"),
        (SQUARE, [[(1, 1), (2, 2), (3, 3)]], "o.holes[0]", "zero area"),
        ([(0, 0), (1, 0)], (), "o", "fewer than three"),
        ([(0, 0), (1, float("nan")), (1, 1)], (), "o[1]", "finite"),
        (SQUARE, [[(1, 1), (2, 1), (float("inf"), 2)]], "o.holes[0][2]", "finite"),
    ],
)
def test_what_is_no_polygon_is_refused_with_its_place(exterior, holes, path, words):
    with pytest.raises(GeometryError) as caught:
        decompose(exterior, holes, "o")
    assert [problem.path for problem in caught.value.problems] == [path]
    assert words in caught.value.problems[0].message


def test_problems_of_all_rings_are_named_at_once_and_without_a_name():
    with pytest.raises(GeometryError) as caught:
        decompose([(0, 0), (1, float("nan")), (1, 1)], [[(0, 0)], [(0, 0), (1, 0), (float("nan"), 1)]])
    assert [problem.path for problem in caught.value.problems] == ["[1]", "holes[0]", "holes[1][2]"]


def test_parts_are_convex_polygons_and_the_docstring_is_true():
    assert all(isinstance(part, ConvexPolygon) for part in decompose(H))
    assert doctest.testmod(tightspot.geometry.decomposition).failed == 0
