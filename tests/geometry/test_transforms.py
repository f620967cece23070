"""Rotations, frames and angles."""

import numpy as np
import pytest

from tightspot.geometry import nearest_angle, rotation, transform, wrap_angle

POINTS = np.array([[1.0, 0.0], [0.0, 2.0], [-3.0, 0.5]])


def test_rotation_turns_left_and_is_orthonormal():
    np.testing.assert_allclose(rotation(np.pi / 2) @ [1.0, 0.0], [0.0, 1.0], atol=1e-15)
    R = rotation(np.linspace(-4, 4, 6).reshape(2, 3))
    assert R.shape == (2, 3, 2, 2)
    np.testing.assert_allclose(R @ np.swapaxes(R, -1, -2), np.broadcast_to(np.eye(2), R.shape), atol=1e-15)
    np.testing.assert_allclose(np.linalg.det(R), 1.0)


def test_transform_is_rotation_then_translation_for_any_batch_shape():
    poses = np.random.default_rng(0).uniform(-5, 5, (4, 2, 3))
    moved = transform(POINTS, poses)
    assert moved.shape == (4, 2, 3, 2)
    for index in np.ndindex(4, 2):
        x, y, theta = poses[index]
        np.testing.assert_allclose(moved[index], POINTS @ rotation(theta).T + [x, y], atol=1e-14)
    np.testing.assert_array_equal(transform(POINTS, poses[1, 1]), moved[1, 1])


@pytest.mark.parametrize(
    ("angle", "wrapped"),
    [
        (0.0, 0.0),
        (1e-300, 1e-300),
        (np.pi, np.pi),
        (-np.pi, np.pi),
        (np.nextafter(-np.pi, 0), np.nextafter(-np.pi, 0)),
        (3 * np.pi, np.pi),
        (-7.0, -7.0 + 2 * np.pi),
        (2 * np.pi, 0.0),
    ],
)
def test_wrap_angle_is_in_the_half_open_interval(angle, wrapped):
    assert wrap_angle(angle) == pytest.approx(wrapped, abs=1e-15, rel=1e-15)


def test_wrap_angle_keeps_the_direction_of_many_angles():
    angles = np.random.default_rng(1).uniform(-1e3, 1e3, 10_000)
    wrapped = wrap_angle(angles)
    assert (wrapped > -np.pi).all()
    assert (wrapped <= np.pi).all()
    np.testing.assert_allclose(np.cos(wrapped), np.cos(angles), atol=1e-12)
    np.testing.assert_allclose(np.sin(wrapped), np.sin(angles), atol=1e-12)
    np.testing.assert_array_equal(wrap_angle(wrapped), wrapped)


def test_nearest_angle_is_within_half_a_turn_and_congruent():
    rng = np.random.default_rng(2)
    angle, reference = rng.uniform(-20, 20, (2, 1000))
    nearest = nearest_angle(angle, reference)
    assert np.abs(nearest - reference).max() <= np.pi + 1e-12
    turns = (nearest - angle) / (2 * np.pi)
    np.testing.assert_allclose(turns, np.round(turns), atol=1e-12)
    assert nearest_angle(3.0, -3.0) == pytest.approx(3.0 - 2 * np.pi)
