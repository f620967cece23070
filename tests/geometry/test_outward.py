"""Simplification that only adds: fewer corners, nothing uncovered, never farther out than the tolerance."""

import numpy as np
import pytest
import shapely

from tightspot.geometry.outward import outward


def checked(polygon, tolerance):
    simple = outward(polygon, tolerance)
    assert simple.is_valid
    assert polygon.difference(simple).area <= 1e-12 * polygon.area
    assert polygon.buffer(tolerance + 1e-9, quad_segs=64).covers(simple)
    assert shapely.get_num_coordinates(simple) <= shapely.get_num_coordinates(polygon)
    return simple


def corners(polygon):
    return shapely.get_num_coordinates(polygon) - 1 - len(polygon.interiors)


def stairs(n):
    steps = [p for k in range(n) for p in ((k, k), (k + 1, k))]
    return shapely.Polygon([*steps, (n, n), (0, n + 3), (-3, 0)])


def test_a_staircase_becomes_a_slope():
    assert corners(checked(stairs(20), 1.0)) <= 6
    assert corners(checked(stairs(20), 0.2)) > 35


def test_a_square_keeps_its_corners():
    assert checked(shapely.box(0, 0, 1, 1), 0.3).equals(shapely.box(0, 0, 1, 1))


def test_notches_are_filled_and_bumps_levelled_outward():
    notched = shapely.box(0, 0, 10, 5).difference(shapely.box(4, 4.8, 6, 5)).union(shapely.box(7, 5, 8, 5.2))
    simple = checked(notched, 0.5)
    assert corners(simple) <= 6
    assert simple.covers(shapely.box(0, 0, 10, 5))


@pytest.mark.parametrize(("width", "holes"), [(0.3, 0), (3.0, 1)])
def test_narrow_holes_are_filled_and_wide_ones_shrink(width, holes):
    ragged = shapely.Point(0, 0).buffer(width / 2, quad_segs=16)
    simple = checked(shapely.box(-5, -5, 5, 5).difference(ragged), 0.2)
    assert len(simple.interiors) == holes
    for ring in simple.interiors:
        assert ragged.covers(shapely.Polygon(ring))
        assert len(ring.coords) < 20


def test_a_slot_wider_than_the_tolerance_stays_open():
    slotted = shapely.box(0, 0, 10, 10).difference(shapely.box(4, 2, 6, 10))
    assert checked(slotted, 0.5).disjoint(shapely.box(4.51, 2.51, 5.49, 9.49))


@pytest.mark.parametrize("seed", range(6))
def test_ragged_discs(seed):
    rng = np.random.default_rng(seed)
    angle = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    radius = 10 + rng.uniform(-0.1, 0.1, 400)
    disc = shapely.Polygon(np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1))
    assert corners(checked(disc, 0.3)) < 60


@pytest.mark.parametrize("seed", range(4))
def test_walls_of_random_cells(seed):
    rng = np.random.default_rng(seed)
    cells = [shapely.box(x, y, x + 1, y + 1) for x in range(30) for y in range(8) if 2 <= y <= 4 or rng.uniform() < 0.3]
    for polygon in shapely.get_parts(shapely.union_all(cells)):
        checked(polygon, 1.5)
