"""Rings that touch themselves are input; rings that cross themselves are refused; nothing drawn is dropped."""

import doctest

import numpy as np
import pytest
import shapely

import tightspot.geometry.windings
from tightspot.errors import GeometryError
from tightspot.geometry import decompose, rotation, solid_polygons

EIGHT = [(0, 0), (2, 0), (2, 2), (4, 2), (4, 4), (2, 4), (2, 2), (0, 2)]
KEYHOLE = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 2), (1, 2), (1, 3), (3, 3), (3, 1), (1, 1), (1, 2), (0, 2)]
VERTEX_ON_EDGE = [(0, 0), (4, 0), (4, 4), (2, 0), (0, 4)]
SLIT = [(0, 0), (6, 0), (6, 6), (3, 6), (3, 1), (3, 6), (0, 6)]
ANTENNA = [(0, 0), (6, 0), (6, 6), (3, 6), (3, 9), (3, 6), (0, 6)]
NOTCH_CLOSED = [(0, 0), (6, 0), (6, 6), (4, 6), (4, 2), (3, 2), (3, 4), (4, 4), (4, 6), (0, 6)]
TOUCHING = {
    "two squares in a corner": (EIGHT, 8),
    "keyhole": (KEYHOLE, 12),
    "vertex on an edge": (VERTEX_ON_EDGE, 8),
    "slit without width": (SLIT, 36),
    "wall without thickness": (ANTENNA, 36),
    "boundary along itself": (NOTCH_CLOSED, 34),
}


def area_of(parts):
    return shapely.union_all([part.to_shapely() for part in parts]).area


@pytest.mark.parametrize("kind", TOUCHING)
@pytest.mark.parametrize("reverse", [False, True])
def test_a_ring_that_touches_itself_encloses_what_it_should(kind, reverse):
    ring, area = TOUCHING[kind]
    ring = ring[::-1] if reverse else ring
    polygons = solid_polygons(ring)
    assert all(polygon.is_valid for polygon in polygons)
    assert sum(polygon.area for polygon in polygons) == pytest.approx(area, rel=1e-3)
    assert area_of(decompose(ring)) == pytest.approx(area, rel=1e-3)


@pytest.mark.parametrize("kind", TOUCHING)
@pytest.mark.parametrize("nudge", [1e-15, 1e-12, 1e-9, 1e-7])
def test_touching_up_to_rounding_is_touching(kind, nudge):
    ring, area = TOUCHING[kind]
    rng = np.random.default_rng(len(kind))
    for angle in rng.uniform(0, 6, 10):
        turned = (
            np.array(ring) @ rotation(angle).T + rng.uniform(-50, 50, 2) + rng.uniform(-nudge, nudge, (len(ring), 2))
        )
        assert area_of(decompose(turned)) == pytest.approx(area, rel=1e-3)


def test_a_wall_drawn_as_a_line_gets_a_thickness_that_holds_the_line():
    (polygon,) = solid_polygons(ANTENNA)
    wall = shapely.LineString([(3, 6), (3, 9)])
    assert polygon.covers(wall)
    assert polygon.difference(shapely.box(0, 0, 6, 6)).area == pytest.approx(3e-3, rel=1e-2)


def test_a_touching_exterior_may_have_holes():
    parts = decompose(EIGHT, [[(0.5, 0.5), (1, 0.5), (1, 1)], KEYHOLE_HOLE])
    assert area_of(parts) == pytest.approx(8 - 0.125 - 0.25)


KEYHOLE_HOLE = [(2.5, 2.5), (3, 2.5), (3, 3), (2.5, 3)]


@pytest.mark.parametrize(
    "ring",
    [
        [(0, 0), (1, 1), (1, 0), (0, 1)],
        [(0, 0), (1, 1), (2, 2), (2, 0), (1, 1), (0, 2)],
        [(0, 0), (4, 0), (4, 4), (1, 1), (3, 1), (0, 4)],
        [(np.cos(4 * k * np.pi / 5), np.sin(4 * k * np.pi / 5)) for k in range(5)],
    ],
    ids=["bow tie", "bow tie with its crossing as a vertex", "wound twice", "pentagram"],
)
def test_a_ring_that_crosses_itself_is_refused(ring):
    with pytest.raises(GeometryError, match="crosses itself at"):
        solid_polygons(ring, name="ring")


def test_a_hole_outside_a_touching_ring_is_refused():
    with pytest.raises(GeometryError, match="reaches outside"):
        solid_polygons(EIGHT, [[(2.5, 0.5), (3, 0.5), (3, 1)]])


def test_the_docstring_is_true():
    assert doctest.testmod(tightspot.geometry.windings).failed == 0
