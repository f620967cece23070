"""Reeds-Shepp words as guesses: from start to goal, obstacles or not, cheapest first."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.guesses import ReedsShepp, guess
from tightspot.scenarios.library import builtin
from tightspot.search import shortest_path

SCENE = builtin("vertical")
CAR = SCENE.vehicle_model()


def test_the_name_at_the_edges():
    assert guess("reeds-shepp") == ReedsShepp()


@pytest.mark.parametrize("lift", ["rolling", "standing"])
def test_it_leads_from_start_to_goal_within_the_limits(lift):
    trajectory = ReedsShepp(lift=lift).make(SCENE, CAR, margin=0.05).trajectory
    np.testing.assert_allclose(trajectory.poses[0], SCENE.start[:3], atol=1e-9)
    difference = trajectory.poses[-1] - SCENE.goal[:3]
    assert np.abs(difference[:2]).max() < 1e-6
    assert np.cos(difference[2]) == pytest.approx(1)
    (low, high), (input_low, input_high) = CAR.state_bounds, CAR.input_bounds
    assert (trajectory.states >= low - 1e-9).all()
    assert (trajectory.states <= high + 1e-9).all()
    assert (trajectory.inputs >= input_low - 1e-9).all()
    assert (trajectory.inputs <= input_high + 1e-9).all()


def test_without_a_price_on_gear_changes_the_cheapest_is_the_shortest():
    word = ReedsShepp(gear_change=0.0).make(SCENE, CAR, margin=0.0).details
    shortest = shortest_path(SCENE.start[:3], SCENE.goal[:3], CAR.min_turning_radius / 0.95)
    assert word.length == pytest.approx(shortest.length)


def test_ranks_are_other_words_each_no_cheaper_and_then_there_are_no_more():
    words, rank = [], 0
    while (result := ReedsShepp(rank=rank).make(SCENE, CAR, margin=0.0)).trajectory is not None:
        words.append(result.report)
        rank += 1
    costs = [report["path_length"] + 2 * report["gear_changes"] for report in words]
    assert len({(report["word"], report["path_length"]) for report in words}) == len(words) > 5
    assert costs == sorted(costs)
    assert f"only {len(words)}" in result.reason


def test_standing_at_the_goal_is_a_short_rest():
    at_goal = replace(SCENE, start=SCENE.goal)
    trajectory = ReedsShepp().make(at_goal, CAR, margin=0.0).trajectory
    assert np.abs(np.diff(trajectory.poses, axis=0)).max() < 1e-9


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"rank": -1}, "rank"),
        ({"rank": 0.5}, "rank"),
        ({"gear_change": np.nan}, "gear_change"),
        ({"curvature_factor": 1.2}, "curvature_factor"),
        ({"lift": "x"}, "lift"),
    ],
)
def test_numbers_out_of_range_are_named(wrong, words):
    with pytest.raises(InputError, match=words):
        ReedsShepp(**wrong)
