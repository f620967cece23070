"""What is done in a hurry with clean convex rings is what the careful way does."""

from __future__ import annotations

import dataclasses

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tightspot.errors import GeometryError
from tightspot.geometry import PolygonStack, clean_ring, convex_parts, covers, is_convex, rings, solid_polygons
from tightspot.scenarios import Obstacle
from tightspot.scenarios.solids import member_of, solids

NUDGE = st.sampled_from([0.0, 0.0, 0.0, 1e-13, 1e-9, 3e-9, 1e-7, 1e-3, 0.3])


@st.composite
def drawn_rings(draw: st.DrawFn) -> np.ndarray:
    """Corners about a circle, seldom clean: nudged, repeated, collinear, closed, clockwise, crossing, far away."""
    size = draw(st.sampled_from([1e-6, 0.1, 1.0, 30.0]))
    angles = np.sort(draw(st.lists(st.floats(0, 6.28), min_size=3, max_size=12)))
    corners = size * np.c_[np.cos(angles), np.sin(angles)]
    nudges = np.array([[draw(NUDGE), draw(NUDGE)] for _ in angles])
    corners = corners + size * nudges
    if draw(st.booleans()):
        at = draw(st.integers(0, len(corners) - 1))
        corners = np.insert(corners, at, (corners[at] + corners[at - 1]) / 2, axis=0)
    if draw(st.booleans()):
        corners = corners[::-1]
    if draw(st.integers(0, 9)) == 0:
        corners = corners[draw(st.permutations(range(len(corners))))]
    if draw(st.booleans()):
        corners = np.concatenate([corners, corners[:1]])
    return corners + np.array([draw(st.sampled_from([0.0, 0.0, -7.5, 1e4])), 0.0])


@given(drawn_rings())
def test_an_obvious_ring_is_the_cleaned_one(corners):
    obvious = rings.clean_convex_ring(corners)
    if obvious is None:
        return
    ring = clean_ring(corners)
    assert np.array_equal(obvious, ring.vertices)
    assert is_convex(ring.vertices)
    (polygon,) = solid_polygons(corners)
    (part,) = convex_parts([polygon])
    assert np.array_equal(part.vertices, obvious)


@given(st.integers(3, 64), st.floats(0.05, 100), st.floats(-1e3, 1e3), st.booleans(), st.booleans())
def test_regular_polygons_are_obvious(corners, size, place, clockwise, closed):
    angles = 2 * np.pi * np.arange(corners + closed) / corners
    points = size * np.c_[np.cos(angles), np.sin(angles)][:: -1 if clockwise else 1] + place
    if closed:
        points[-1] = points[0]
    assert Obstacle("post", points).is_plain


@given(drawn_rings())
def test_rings_that_need_no_cleaning_come_out_as_from_the_loop(corners):
    def cleaned() -> tuple[list[int], str]:
        try:
            return clean_ring(corners).indices.tolist(), ""
        except GeometryError as error:
            return [], str(error)

    quick, looked = cleaned(), rings._all_stand_out
    try:
        rings._all_stand_out = lambda ring, tol: False
        assert cleaned() == quick
    finally:
        rings._all_stand_out = looked


@given(st.lists(drawn_rings(), min_size=1, max_size=6))
def test_solids_do_not_depend_on_which_members_are_plain(corners):
    found = []
    for index, ring in enumerate(corners):
        try:
            found.append(member_of(Obstacle(f"o{index}", ring + np.array([25.0 * index, 0.0]))))
        except GeometryError:
            continue
    slow = [dataclasses.replace(member, pieces=member.polygons) for member in found]
    for one, other in zip(solids(found), solids(slow), strict=True):
        assert (one.name, one.members, one.labels) == (other.name, other.members, other.labels)
        assert one.parts == other.parts


@given(st.lists(drawn_rings(), min_size=1, max_size=6), st.sampled_from([1e-6, 4e-4, 0.05, 1.0]))
def test_polygons_that_cannot_be_simplified_stay(corners, tolerance):
    polygons = [part for part in map(covers.ConvexPolygon.if_obvious, corners) if part is not None]
    hopeful = covers.can_be_simplified(PolygonStack(polygons), tolerance)
    assert hopeful.shape == (len(polygons),)
    for polygon, might in zip(polygons, hopeful, strict=True):
        assert might or covers.simplified(polygon, tolerance) is polygon
