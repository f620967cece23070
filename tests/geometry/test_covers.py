"""Covers: fewer parts, nothing uncovered, never farther out than the tolerance."""

import numpy as np
import pytest
import shapely

from tightspot.geometry import ConvexPolygon, covers

TOLERANCE = 1e-3


def box(x0, x1, y0, y1):
    return ConvexPolygon.rectangle(x0, x1, y0, y1)


def union(parts):
    return shapely.union_all([part.to_shapely() for part in parts])


def merged(parts, tolerance=TOLERANCE):
    found = covers.merged(parts, union(parts), tolerance)
    assert sorted(i for item in found for i in item.indices) == list(range(len(parts)))
    result = [item.polygon for item in found]
    assert union(parts).difference(union(result)).area == 0
    assert union(parts).buffer(tolerance + 1e-9).covers(union(result))
    return result


@pytest.mark.parametrize(
    ("parts", "count"),
    [
        ([box(i, i + 1, 0, 1) for i in range(10)], 1),
        ([box(i + 5e-4, i + 1, 0, 1) for i in range(10)], 1),
        ([box(i + 0.01, i + 1, 0, 1) for i in range(10)], 10),
        ([box(i, i + 1, j, j + 1) for i in range(4) for j in range(4)], 1),
        ([box(0, 3, 0, 1), box(1, 2, 0.2, 0.8)], 1),
        ([box(0, 3, 0, 1), box(1, 2, -1, 2)], 2),
        ([box(0, 1, 0, 2), box(1, 3, 0, 1), box(2, 3, 1, 3), box(0, 2, 2, 3), box(1, 2, 1, 2)], 1),
        ([box(0, 1, 0, 1), box(0, 1, 1, 2), box(1, 2, 0, 1)], 2),
    ],
    ids=["row", "hairline gaps", "true gaps", "block", "contained", "cross", "pinwheel", "L"],
)
def test_known_arrangements(parts, count):
    assert len(merged(parts)) == count


def test_nothing_is_merged_across_a_gap_of_more_than_the_tolerance():
    parts = [box(0, 1, 0, 1), box(1.1, 2, 0, 1)]
    assert merged(parts) == parts
    assert len(merged(parts, 0.1)) == 1


@pytest.mark.parametrize("n", [5, 8, 30, 64])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-2, 0.1])
def test_a_disc_keeps_its_size_but_for_the_tolerance(n, tolerance):
    angle = np.linspace(0, 2 * np.pi, n, endpoint=False)
    disc = ConvexPolygon.from_vertices(0.5 * np.stack([np.cos(angle), np.sin(angle)], axis=1) + (3, 4))
    simple = covers.simplified(disc, tolerance)
    assert simple.to_shapely().buffer(1e-12).covers(disc.to_shapely())
    assert disc.to_shapely().hausdorff_distance(simple.to_shapely()) <= tolerance + 1e-12
    # The polygon of fewest edges about a disc that reaches out by t has about pi / sqrt(2 t / r) of them.
    assert len(simple.vertices) <= max(4, min(n, 2.5 * np.pi / np.sqrt(2 * tolerance / 0.5)))


def test_what_cannot_be_simplified_is_returned_itself():
    square = box(0, 1, 0, 1)
    assert covers.simplified(square, 0.1) is square


def test_a_chamfer_within_the_tolerance_is_cut_off_outward():
    chamfered = ConvexPolygon.from_vertices([(0, 0), (1, 0), (1, 0.999), (0.999, 1), (0, 1)])
    np.testing.assert_allclose(covers.simplified(chamfered, TOLERANCE).vertices, [(0, 0), (1, 0), (1, 1), (0, 1)])


def test_growing_moves_every_edge():
    triangle = ConvexPolygon.from_vertices([(0, 0), (4, 0), (0, 3)])
    larger = covers.grown(triangle, 0.1)
    np.testing.assert_allclose(larger.A, triangle.A, atol=1e-12)
    np.testing.assert_allclose(larger.b, triangle.b + 0.1)


def test_a_dropped_vertex_is_taken_in_again():
    bump = (0.5, -9e-10)  # clean_ring drops it: it lies on the line but for 1e-9 of the extent
    (part,) = covers.reaching([ConvexPolygon.from_vertices([(0, 0), bump, (1, 0), (1, 1), (0, 1)])], np.array([bump]))
    assert part.contains(bump)
    assert part.area == pytest.approx(1)


@pytest.mark.parametrize("height", [3.0, 0.1, 1e-3, 1e-5])
@pytest.mark.parametrize("distance", [0.1, 1e-3, 1e-8])
def test_growing_moves_no_corner_far_however_sharp(height, distance):
    sliver = ConvexPolygon.from_vertices(np.array([[0.0, 0.0], [3.0, 0.0], [3.0, height]]))
    larger = covers.grown(sliver, distance)
    reach = shapely.distance(sliver.to_shapely(), shapely.points(larger.vertices)).max()
    assert reach <= 10 * distance + 1e-14
    around = sliver.to_shapely().buffer(0.999 * distance)
    assert ((shapely.get_coordinates(around) @ larger.A.T).max(axis=0) <= larger.b + 1e-13).all()
