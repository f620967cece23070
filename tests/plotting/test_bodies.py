"""Bodies and the area they sweep, against shapely."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from tightspot.plotting import swept_area
from tightspot.plotting.bodies import body_shape, heading_mark, placed_parts, shape_path, wheels
from tightspot.plotting.motion import dense_motion
from tightspot.vehicles import CATALOGUE, vehicle
from tightspot.verification import Plan


@pytest.mark.parametrize("name", CATALOGUE)
def test_sweep_contains_the_body_at_every_state(name: str, plan: Plan) -> None:
    model = vehicle(name)
    states = dense_motion(model, plan.trajectory).states
    area = swept_area(model, states).buffer(1e-9)
    for state in states[::20]:
        for part in model.parts:
            assert area.contains(part.polygon.transformed(*state[:3]).to_shapely())


def test_sweep_is_hardly_larger_than_the_bodies(plan: Plan) -> None:
    states = dense_motion(plan.vehicle, plan.trajectory).states
    bodies = shapely.union_all([body_shape(plan.vehicle, state) for state in states])
    assert swept_area(plan.vehicle, states).area == pytest.approx(bodies.area, rel=1e-3)


def test_sweep_of_a_translation_is_exact() -> None:
    model = vehicle("paper")
    area = swept_area(model, [[0, 0, 0], [10, 0, 0]])
    assert area.area == pytest.approx((10 + 4.628) * 2.097)
    assert swept_area(model, [[0, 0, 1.0]]).area == pytest.approx(4.628 * 2.097)


def test_sweep_keeps_the_space_between_the_tines() -> None:
    between = shapely.Point(2.4, 0.0)
    assert not swept_area(vehicle("forklift"), [[0, 0, 0], [0.1, 0, 0]]).contains(between)


def test_placed_parts_agree_with_the_polygons_own_transformation() -> None:
    model, poses = vehicle("forklift"), np.array([[1.0, 2.0, 0.3], [-4.0, 0.5, -2.0]])
    for part, placed in zip(model.parts, placed_parts(model, poses), strict=True):
        for pose, vertices in zip(poses, placed, strict=True):
            assert vertices == pytest.approx(part.polygon.transformed(*pose).vertices)


def test_path_of_a_shape_leaves_holes_empty() -> None:
    ring = shapely.Polygon([(0, 0), (0, 4), (4, 4), (4, 0)], [[(1, 1), (3, 1), (3, 3), (1, 3)]])
    outer, inner = (shapely.LinearRing(p) for p in np.split(shape_path(ring).vertices, 2))
    assert outer.is_ccw
    assert not inner.is_ccw
    assert len(shape_path(shapely.MultiPolygon([ring, shapely.box(9, 9, 10, 10)])).vertices) == 15
    assert len(shape_path(shapely.Polygon()).vertices) == 0


@pytest.mark.parametrize("name", CATALOGUE)
def test_heading_mark_points_forward_inside_the_body(name: str) -> None:
    model, pose = vehicle(name), np.array([3.0, -1.0, 2.0, 0.0, 0.0])
    tip, *base = heading_mark(model, pose)
    forward = tip - np.mean(base, axis=0)
    assert np.arctan2(forward[1], forward[0]) == pytest.approx(2.0)
    assert body_shape(model, pose).contains(shapely.Polygon([tip, *base]))


def test_front_wheels_steer_and_rear_wheels_do_not() -> None:
    model, state = vehicle("tpcap"), np.array([1.0, 2.0, 0.5, 0.0, 0.4])
    outlines = wheels(model, state)
    directions = [np.arctan2(*(corners[0] - corners[1])[::-1]) for corners in outlines]
    assert directions == pytest.approx([0.5, 0.5, 0.9, 0.9])
    rear, front = np.mean(outlines[:2], axis=(0, 1)), np.mean(outlines[2:], axis=(0, 1))
    assert rear == pytest.approx([1.0, 2.0])
    assert np.hypot(*(front - rear)) == pytest.approx(model.wheelbase)
