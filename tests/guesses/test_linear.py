"""Linear interpolation, and the registry of guesses."""

import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.guesses import GUESSES, HybridAStar, LinearInterpolation, SimplifiedModel, guess
from tightspot.scenarios.library import builtin
from tightspot.vehicles import vehicle

CAR = vehicle("paper")


def test_the_straight_line_from_start_to_goal():
    scenario = builtin("vertical")
    result = LinearInterpolation(duration=30.0, steps=6).make(scenario, CAR, margin=0.1)
    trajectory = result.trajectory
    np.testing.assert_allclose(trajectory.t, np.arange(7) * 5.0)
    np.testing.assert_array_equal(trajectory.states[0], scenario.start)
    np.testing.assert_allclose(trajectory.states[-1], scenario.goal)
    np.testing.assert_allclose(trajectory.states[3], (scenario.start + scenario.goal) / 2)
    assert not trajectory.inputs.any()
    assert "30 s" in result.reason


@pytest.mark.parametrize("turns", [-1, 0, 1])
def test_the_heading_takes_the_short_way(turns):
    scenario = builtin("vertical")
    turned = scenario.with_(goal=[6.3, -6.7, np.pi / 2 + 2 * np.pi * turns, 0, 0])
    heading = LinearInterpolation().make(turned, CAR, margin=0.0).trajectory.column("theta")
    assert heading[-1] == pytest.approx(np.pi / 2)


def test_free_entries_are_taken_as_zero():
    scenario = builtin("vertical").with_(start=[0, 0, 0, np.nan, np.nan])
    trajectory = LinearInterpolation().make(scenario, CAR, margin=0.0).trajectory
    np.testing.assert_array_equal(trajectory.states[0], 0.0)


@pytest.mark.parametrize("arguments", [{"duration": 0.0}, {"duration": np.inf}, {"duration": np.nan}, {"steps": 0}])
def test_odd_arguments_are_refused(arguments):
    (field,) = arguments
    with pytest.raises(InputError, match=f"guess.{field}"):
        LinearInterpolation(**arguments)


@pytest.mark.parametrize(
    ("name", "member"),
    [
        ("linear", LinearInterpolation),
        ("LinearInterpolation", LinearInterpolation),
        ("simplified", SimplifiedModel),
        ("Simplified Model", SimplifiedModel),
        ("hybrid-astar", HybridAStar),
        ("hybrid_a*", HybridAStar),
        ("HybridAStar", HybridAStar),
    ],
)
def test_names_are_found_however_they_are_written(name, member):
    assert type(guess(name)) is member


def test_an_unknown_name_lists_the_members():
    with pytest.raises(InputError, match=r"guess: 'rrt' is not known; choose one of .*linear"):
        guess("rrt")


def test_members_say_whether_they_see_obstacles():
    assert {name for name, member in GUESSES.items() if member.collision_free} == {"hybrid-astar", "collision-free"}
    assert all(member.name == name for name, member in GUESSES.items())
