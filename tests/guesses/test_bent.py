"""Bent trajectories: both ends stay, the pace changes, nothing else than asked for."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tightspot.errors import InputError
from tightspot.guesses import HybridAStar, bent, bent_versions
from tightspot.guesses.bent import PACE
from tightspot.scenarios.library import builtin
from tightspot.trajectory import Trajectory

SCENE = builtin("oblique")
CAR = SCENE.vehicle_model()
GUESS = HybridAStar().make(SCENE, CAR, margin=0.05)
WAY = GUESS.trajectory


@given(seed=st.integers(0, 2**32 - 1), amount=st.floats(0, 3))
def test_both_ends_stay_and_the_pace_is_within_its_bounds(seed, amount):
    result = bent(WAY, amount, seed, length=2.0)
    np.testing.assert_array_equal(result.states[[0, -1], :3], WAY.states[[0, -1], :3])
    factor = result.duration / WAY.duration
    assert 1 / PACE - 1e-9 <= factor <= PACE + 1e-9
    np.testing.assert_allclose(result.states[:, 3] * factor, WAY.states[:, 3])
    np.testing.assert_array_equal(result.states[:, 4], WAY.states[:, 4])
    np.testing.assert_allclose(result.inputs * factor, WAY.inputs)


def test_the_way_driven_on_a_straight_path_is_the_same_at_another_pace():
    result = bent(WAY, 0.0, 4, length=2.0)
    np.testing.assert_allclose(result.poses, WAY.poses, atol=1e-12)
    driven = [np.sum(way.states[:-1, 3] * np.diff(way.t)) for way in (WAY, result)]
    assert driven[0] == pytest.approx(driven[1])


def test_poses_move_by_about_the_amount_and_headings_by_the_amount_over_the_length():
    moved = np.stack([bent(WAY, 0.3, seed, length=1.5).poses - WAY.poses for seed in range(400)])
    s = (WAY.t - WAY.t[0]) / WAY.duration
    wanted = np.sqrt(sum((np.sin(np.pi * w * s) / w) ** 2 for w in (1, 2, 3)))
    inner = slice(1, -1)
    for column, amount in ((0, 0.3), (1, 0.3), (2, 0.2)):
        np.testing.assert_allclose(moved[:, inner, column].std(axis=0), amount * wanted[inner], rtol=0.15)
        assert np.abs(moved[:, :, column].mean(axis=0)).max() < 0.25 * amount


def test_seeds_decide_and_nothing_else():
    first, same, other = (bent(WAY, 0.2, seed, length=2.0) for seed in (5, 5, 6))
    np.testing.assert_array_equal(first.states, same.states)
    assert np.abs(first.states - other.states).max() > 0.01


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"amount": -1.0}, "amount"),
        ({"amount": float("nan")}, "amount"),
        ({"length": 0.0}, "length"),
        ({"seed": -1}, "seed"),
        ({"seed": 0.5}, "seed"),
    ],
)
def test_numbers_out_of_range_are_named(changes, words):
    arguments = {"amount": 0.1, "seed": 0, "length": 2.0} | changes
    with pytest.raises(InputError, match=words):
        bent(WAY, arguments["amount"], arguments["seed"], length=arguments["length"])


def test_without_a_pose_there_is_nothing_to_bend():
    slide = Trajectory([0.0, 1.0], [[0.0], [1.0]], [[1.0]], ("x",), ("u",))
    with pytest.raises(InputError, match="no state y, theta"):
        bent(slide, 0.1, 0, length=1.0)


def test_versions_have_names_of_their_own_and_come_from_all_guesses():
    named = [HybridAStar(seed=seed).make(SCENE, CAR, margin=0.05) for seed in range(3)]
    versions = bent_versions(named, CAR, 12, seed=3)
    assert len({version.report["variant"] for version in versions}) == 12
    width = 1.9
    for version in versions:
        assert 0.04 * width < version.report["amount"] < 0.6 * width
    ways = [version.trajectory.poses for version in versions]
    assert all(np.abs(a[len(a) // 2] - b[len(b) // 2]).max() > 1e-6 for a, b in itertools.pairwise(ways))
    assert bent_versions(named, CAR, 0, seed=3) == []
