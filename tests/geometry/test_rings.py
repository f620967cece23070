"""Cleaning of vertex lists: tolerance, order, and what is refused."""

import numpy as np
import pytest

from tightspot.errors import GeometryError
from tightspot.geometry import clean_ring

SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]


@pytest.mark.parametrize(
    "points",
    [
        SQUARE,
        [*SQUARE, SQUARE[0]],
        [SQUARE[0], *SQUARE, SQUARE[0], SQUARE[0]],
        [(0, 0), (0.5, 0), (1, 0), (1, 0.3), (1, 0.3), (1, 0.7), (1, 1), (0, 1), (0, 0.5)],
        [(0, 0), (0.5, 1e-11), (1, 0), (1, 1), (0, 1), (0, 1 - 1e-11)],
        [(0, 0), (0, 1), (1, 1), (1, 0)],
    ],
    ids=["as it is", "closed", "repeated", "collinear", "within the tolerance", "clockwise"],
)
def test_a_square_stays_the_square_that_starts_where_it_started(points):
    np.testing.assert_array_equal(clean_ring(points).vertices, SQUARE)


def test_indices_say_where_the_vertices_stood():
    points = [(0, 0), (0, 1), (0, 1), (0.5, 1), (1, 1), (1, 0), (0, 0)]
    ring = clean_ring(points)
    np.testing.assert_array_equal(np.array(points)[ring.indices], ring.vertices)
    assert ring.indices.tolist() == [0, 5, 4, 1]


def test_a_collinear_first_vertex_is_dropped():
    np.testing.assert_array_equal(clean_ring([(0.5, 0), *SQUARE[1:], SQUARE[0]]).vertices, np.roll(SQUARE, -1, axis=0))


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e5])
def test_the_tolerance_grows_with_the_size(size):
    dent = [(0, 0), (0.5, 3e-9), (1, 0), (1, 1), (0, 1)]
    assert len(clean_ring(np.multiply(size, dent)).vertices) == 5
    dent[1] = (0.5, 3e-10)
    assert len(clean_ring(np.multiply(size, dent)).vertices) == 4


def test_far_from_the_origin_the_tolerance_is_that_of_the_coordinates():
    far = np.array(SQUARE) + 5e8
    noisy = np.insert(far, 1, far[0] + [0.5, 6e-8], axis=0)
    assert len(clean_ring(noisy).vertices) == 4


@pytest.mark.parametrize(
    ("points", "path", "words"),
    [
        ([], "v", "no points"),
        ([(0, 0), (1, 0)], "v", "fewer than three are distinct"),
        ([(0, 0), (1, 0), (0, 0), (1, 0)], "v", "zero area"),
        ([(0, 0), (1, 0), (1, 0), (0, 0), (0, 0)], "v", "fewer than three"),
        ([(3, 3)] * 5, "v", "fewer than three"),
        ([(0, 0), (1, 1), (2, 2), (5, 5)], "v", "zero area"),
        ([(0, 0), (1, 1e-12), (2, 0), (1, -1e-12)], "v", "zero area"),
        ([(0, 0), (1, float("nan")), (1, 1)], "v[1]", "finite"),
        ([(0, 0), (1, 0), (float("-inf"), 1)], "v[2]", "finite"),
        ([(0, 0), (1e12, 0), (1, 1)], "v[1]", "1e+09"),
        ([(0, 0), (3, 0), (1, 0), (1, 2)], "v[1]", "doubles back"),
        ([(0, 0, 0), (1, 0, 0), (1, 1, 0)], "v", "shape (3, 3)"),
        ([(0, 0), (1,), (1, 1)], "v", "two numbers"),
        (["a", "b", "c"], "v", "two numbers"),
        (5.0, "v", "shape ()"),
    ],
)
def test_what_is_no_ring_is_refused_with_its_place(points, path, words):
    with pytest.raises(GeometryError) as caught:
        clean_ring(points, "v")
    assert [problem.path for problem in caught.value.problems] == [path]
    assert words in caught.value.problems[0].message


def test_all_odd_points_are_named_at_once():
    with pytest.raises(GeometryError) as caught:
        clean_ring([(0, float("nan")), (1, 0), (float("inf"), 1)])
    assert [problem.path for problem in caught.value.problems] == ["vertices[0]", "vertices[2]"]
