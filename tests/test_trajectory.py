"""Trajectories: shapes, columns, the file form, and one sentence for what does not fit."""

import json

import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.trajectory import Trajectory

T = np.array([0.0, 0.5, 2.0])
STATES = np.arange(15.0).reshape(3, 5)
INPUTS = np.array([[0.1, -0.2], [0.3, 0.4]])


def test_columns_by_name_and_derived_quantities():
    trajectory = Trajectory(T, STATES, INPUTS)
    assert trajectory.steps == 2
    assert trajectory.duration == 2.0
    np.testing.assert_array_equal(trajectory.column("delta"), [4, 9, 14])
    np.testing.assert_array_equal(trajectory.column("omega"), [-0.2, 0.4])
    np.testing.assert_array_equal(trajectory.poses, STATES[:, :3])
    with pytest.raises(InputError, match=r"no column 'jerk'.*omega"):
        trajectory.column("jerk")


def test_arrays_are_copies_that_cannot_be_written():
    states = STATES.copy()
    trajectory = Trajectory(T, states, INPUTS)
    states[0, 0] = 99.0
    assert trajectory.states[0, 0] == 0.0
    for array in (trajectory.t, trajectory.states, trajectory.inputs):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0


def test_lists_become_float_arrays():
    trajectory = Trajectory([0, 1], [[0, 0], [1, 1]], [[1]], ("x", "y"), ("v",))
    assert trajectory.states.dtype == float
    assert trajectory.steps == 1


def test_shifted_moves_positions_only():
    trajectory = Trajectory(T, STATES, INPUTS)
    moved = trajectory.shifted([100.0, -7.0])
    np.testing.assert_array_equal(moved.column("x"), STATES[:, 0] + 100)
    np.testing.assert_array_equal(moved.column("y"), STATES[:, 1] - 7)
    np.testing.assert_array_equal(moved.states[:, 2:], STATES[:, 2:])
    np.testing.assert_array_equal(moved.inputs, INPUTS)
    np.testing.assert_array_equal(trajectory.states, STATES)


@pytest.mark.parametrize(
    ("t", "states", "inputs", "path", "words"),
    [
        ([0.0], STATES[:1], INPUTS[:0], "t", "at least two"),
        ([], STATES[:0], INPUTS[:0], "t", "at least two"),
        ([[0.0, 1.0, 2.0]], STATES, INPUTS, "t", "in one list"),
        (T, STATES[:2], INPUTS, "states", r"(2, 5), but 3 knots need (3, 5)"),
        (T, STATES[:, :4], INPUTS, "states", "(3, 4)"),
        (T, STATES, STATES[:, :2], "inputs", "(3, 2), but 3 knots need (2, 2)"),
        (T, STATES, INPUTS[:, 0], "inputs", "(2,)"),
        ([0.0, 1.0, 1.0], STATES, INPUTS, "t[2]", "1 s does not come after 1 s"),
        ([0.0, -1.0, 1.0], STATES, INPUTS, "t[1]", "-1 s does not come after 0 s"),
        ([0.0, np.nan, 1.0], STATES, INPUTS, "t", "not finite"),
        (T, STATES * np.inf ** (STATES == 3), INPUTS, "states", "not finite"),
        (T, STATES, np.full((2, 2), np.nan), "inputs", "not finite"),
    ],
)
def test_what_does_not_fit_is_named(t, states, inputs, path, words):
    with pytest.raises(InputError) as error:
        Trajectory(t, states, inputs)
    (problem,) = error.value.problems
    assert problem.path == path
    assert words in problem.message


def test_the_file_form_survives_json_to_the_last_bit():
    rng = np.random.default_rng(4)
    trajectory = Trajectory(np.cumsum(rng.random(6)), rng.normal(size=(6, 5)), rng.normal(size=(5, 2)))
    data = json.loads(json.dumps(trajectory.to_dict()))
    assert list(data) == ["t", "states", "inputs"]
    assert list(data["states"]) == ["x", "y", "theta", "v", "delta"]
    copy = Trajectory.from_dict(data)
    for field in ("t", "states", "inputs", "state_names", "input_names"):
        np.testing.assert_array_equal(getattr(copy, field), getattr(trajectory, field))


def test_names_demanded_by_the_caller_fix_the_order():
    data = Trajectory(T, STATES, INPUTS).to_dict()
    data["states"] = dict(reversed(data["states"].items()))
    names = ("x", "y", "theta", "v", "delta")
    assert Trajectory.from_dict(data).state_names == names[::-1]
    np.testing.assert_array_equal(Trajectory.from_dict(data, names, ("a", "omega")).states, STATES)


@pytest.mark.parametrize(
    ("key", "value", "path", "words"),
    [
        ("t", None, "t", "plain list"),
        ("t", [[0, 1, 2]], "t", "plain list"),
        ("t", ["zero", 1, 2], "t", "list of numbers"),
        ("t", [0, 1, 10**400], "t", "list of numbers"),
        ("t", [0, [1], 2], "t", "list of numbers"),
        ("t", [0, 1], "states", "2 knots need"),
        ("states", [], "states", "must be an object"),
        ("states", {}, "states", "must be an object"),
        ("inputs", {"a": [1, 2]}, "inputs", "missing ['omega']"),
        ("inputs", {"a": [1, 2], "omega": [1, 2], "b": [1, 2]}, "inputs", "unknown ['b']"),
        ("inputs", {"a": [1, 2], "omega": [1]}, "inputs", "different lengths"),
        ("inputs", {"a": [1, 2], "omega": None}, "inputs.omega", "plain list"),
        ("inputs", {"a": [1, None], "omega": [1, 2]}, "inputs", "not finite"),
        ("inputs", {"a": {"0": 1}, "omega": [1, 2]}, "inputs.a", "list of numbers"),
    ],
)
def test_odd_files_are_named(key, value, path, words):
    data = Trajectory(T, STATES, INPUTS).to_dict() | {key: value}
    with pytest.raises(InputError) as error:
        Trajectory.from_dict(data, ("x", "y", "theta", "v", "delta"), ("a", "omega"))
    assert path in [problem.path for problem in error.value.problems]
    assert words in str(error.value)


def test_all_missing_fields_are_named_at_once():
    with pytest.raises(InputError) as error:
        Trajectory.from_dict({"inputs": 3})
    assert [str(problem) for problem in error.value.problems] == [
        "t: is missing",
        "states: is missing",
        "inputs: must be an object of lists, one a name",
    ]
