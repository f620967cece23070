"""Time grids and the resampling of trajectories onto them."""

import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.trajectory import Trajectory
from tightspot.transcription import TimeGrid, resample
from tightspot.transcription.sampling import inputs_on, states_at


def test_uniform_grids_have_equal_widths():
    grid = TimeGrid.uniform(4)
    np.testing.assert_array_equal(grid.fractions, [0, 0.25, 0.5, 0.75, 1])
    np.testing.assert_array_equal(grid.widths, 0.25)
    assert grid.steps == 4


def test_splitting_cuts_the_named_intervals_only():
    grid = TimeGrid(np.array([0, 0.2, 0.5, 1.0])).split([1, 2])
    np.testing.assert_allclose(grid.fractions, [0, 0.2, 0.35, 0.5, 0.75, 1.0])
    thirds = TimeGrid.uniform(2).split([0], parts=3)
    np.testing.assert_allclose(thirds.fractions, [0, 1 / 6, 1 / 3, 0.5, 1.0])
    np.testing.assert_array_equal(TimeGrid.uniform(3).split([]).fractions, TimeGrid.uniform(3).fractions)
    np.testing.assert_array_equal(TimeGrid.uniform(2).split(1).fractions, [0, 0.5, 0.75, 1])


@pytest.mark.parametrize("seed", range(5))
def test_each_interval_is_cut_into_equal_pieces(seed):
    rng = np.random.default_rng(seed)
    fractions = np.concatenate([[0.0], np.sort(rng.uniform(0.01, 0.99, 9)), [1.0]])
    pieces = rng.integers(1, 6, 10)
    cut = TimeGrid(fractions).cut(pieces).fractions
    ends = zip(fractions[:-1], fractions[1:], pieces, strict=True)
    expected = [np.linspace(before, after, count + 1)[:-1] for before, after, count in ends]
    np.testing.assert_allclose(cut, [*np.concatenate(expected), 1.0], rtol=0, atol=1e-15)
    assert set(fractions) <= set(cut), "the old knots stay where they are"


def test_split_grids_still_end_at_one_exactly():
    grid = TimeGrid.uniform(7)
    for _ in range(5):
        grid = grid.split(np.arange(grid.steps), parts=2)
    assert (grid.fractions[0], grid.fractions[-1]) == (0.0, 1.0)
    assert grid.steps == 7 * 32


@pytest.mark.parametrize(
    "fractions",
    [[], [0.0], [0.0, 0.5], [0.1, 1.0], [0, 0.5, 0.5, 1], [0, 0.7, 0.3, 1], [0, np.nan, 1], [[0, 1]], 1.0],
)
def test_fractions_must_increase_from_zero_to_one(fractions):
    with pytest.raises(InputError, match=r"grid.fractions: must increase from 0 to 1"):
        TimeGrid(fractions)


def test_odd_requests_are_refused():
    with pytest.raises(InputError, match="steps: 0 is too few"):
        TimeGrid.uniform(0)
    with pytest.raises(InputError, match="parts: 0 is too few"):
        TimeGrid.uniform(3).split([1], parts=0)
    with pytest.raises(InputError, match="intervals: 3 is not an interval of a grid of 3"):
        TimeGrid.uniform(3).split([0, 3])


def wild_guess(rng, knots=9):
    t = 5.0 + np.r_[0.0, np.cumsum(rng.uniform(0.1, 2.0, knots - 1))]
    return Trajectory(t, rng.normal(size=(knots, 5)), rng.normal(size=(knots - 1, 2)))


@pytest.mark.parametrize("steps", [1, 3, 8, 40])
def test_resampling_keeps_duration_ends_and_the_integral_of_the_inputs(steps):
    guess = wild_guess(np.random.default_rng(steps))
    result = resample(guess, TimeGrid.uniform(steps))
    assert result.t[0] == 0.0
    assert result.duration == pytest.approx(guess.duration, rel=1e-15)
    np.testing.assert_allclose(result.states[[0, -1]], guess.states[[0, -1]], atol=1e-12)
    integral = np.diff(guess.t) @ guess.inputs
    np.testing.assert_allclose(np.diff(result.t) @ result.inputs, integral, atol=1e-12)


def test_resampling_onto_its_own_grid_changes_nothing():
    guess = wild_guess(np.random.default_rng(0))
    result = resample(guess, TimeGrid((guess.t - guess.t[0]) / guess.duration))
    np.testing.assert_allclose(result.states, guess.states, atol=1e-12)
    np.testing.assert_allclose(result.inputs, guess.inputs, atol=1e-12)
    np.testing.assert_allclose(result.t, guess.t - 5.0, atol=1e-12)


def test_resampling_onto_a_finer_grid_repeats_the_inputs():
    guess = Trajectory([0, 1, 3], np.zeros((3, 5)), [[1.0, 2.0], [-1.0, 4.0]])
    fine = resample(guess, TimeGrid.uniform(6))
    np.testing.assert_allclose(fine.inputs[:, 0], [1, 1, -1, -1, -1, -1])
    np.testing.assert_allclose(inputs_on(guess, np.array([0.0, 2.0, 3.0]))[:, 0], [0.0, -1.0])


def test_states_between_knots_are_interpolated():
    guess = Trajectory([0, 2], [[0, 0, 0, 0, 0], [4, 8, 1, 2, 0.5]], [[0, 0]])
    np.testing.assert_allclose(states_at(guess, np.array([0.5])), [[1, 2, 0.25, 0.5, 0.125]])
