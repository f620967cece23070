"""Reeds-Shepp curves against OMPL, integration and the properties of a distance."""

from __future__ import annotations

import numpy as np
import pytest
from ompl import base

from tightspot.errors import InputError
from tightspot.search import all_paths, shortest_path

RADIUS = 3.3


def random_pairs(count: int, seed: int):
    rng = np.random.default_rng(seed)
    for scale in rng.choice([0.5, 3.0, 10.0, 40.0], count):
        yield tuple(np.r_[rng.normal(0, scale, 2), rng.uniform(-np.pi, np.pi)] for _ in range(2))


def state(space: base.ReedsSheppStateSpace, pose: np.ndarray):
    at = space.allocState()
    at.setX(pose[0])
    at.setY(pose[1])
    at.setYaw(pose[2])
    return at


def test_lengths_equal_ompl_s():
    space = base.ReedsSheppStateSpace(RADIUS)
    for start, goal in random_pairs(5000, seed=0):
        expected = space.distance(state(space, start), state(space, goal))
        assert shortest_path(start, goal, RADIUS).length == pytest.approx(expected, rel=1e-9)


def test_every_path_ends_at_the_goal(driven):
    kinds = set()
    for start, goal in random_pairs(150, seed=1):
        paths = all_paths(start, goal, RADIUS)
        assert (np.diff([path.length for path in paths]) >= -1e-9).all()
        assert paths[0].length == pytest.approx(shortest_path(start, goal, RADIUS).length, rel=1e-12)
        for path in paths:
            kinds.add("".join(segment.kind for segment in path.segments))
            end = driven(start, path.arcs)
            turns = (end[2] - goal[2]) / (2 * np.pi)
            assert np.abs(end[:2] - goal[:2]).max() < 1e-4  # what the sum in small steps leaves
            assert turns == pytest.approx(round(turns), abs=1e-9)
            assert path.arcs[:, 1] == pytest.approx(np.sign(path.arcs[:, 1]) / RADIUS)
    families = {"LSL", "LSR", "LRL", "LRLR", "LRSL", "LRSR", "LSRL", "RSRL", "LRSLR"}
    assert families <= kinds


def test_samples_follow_the_path_closely_and_end_exactly_at_the_goal():
    for start, goal in random_pairs(100, seed=2):
        path = shortest_path(start, goal, RADIUS)
        sampled = path.sample(0.05)
        steps = np.diff(sampled.poses, axis=0)
        chords = np.hypot(steps[:, 0], steps[:, 1])
        assert chords.max() <= 0.05 + 1e-9
        assert chords.sum() == pytest.approx(path.length, rel=1e-3)
        assert np.abs(steps[:, 2]).max() <= 0.05 / RADIUS + 1e-9
        assert (sampled.poses[0] == start).all()
        assert (sampled.poses[-1, :2] == goal[:2]).all()
        middle = sampled.poses[:-1, 2] + steps[:, 2] / 2
        along = np.cos(middle) * steps[:, 0] + np.sin(middle) * steps[:, 1]
        assert (np.sign(along[chords > 1e-9]) == sampled.gear[1:][chords > 1e-9]).all()


def test_special_poses():
    assert shortest_path((1, 2, 3), (1, 2, 3), 2.0).segments == ()
    assert shortest_path((1, 2, 3), (1, 2, 3), 2.0).sample().poses.shape == (1, 3)
    assert shortest_path((0, 0, 0), (-4, 0, 0), 2.0).word == "S-"
    quarter = shortest_path((0, 0, 0), (2, 2, np.pi / 2), 2.0)
    assert (quarter.word, quarter.length) == ("L+", pytest.approx(np.pi))
    turned = shortest_path((0, 0, 0), (0, 0, 2 * np.pi), 2.0)
    assert turned.length == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize(
    ("start", "goal", "radius", "word"),
    [
        ((0, 0, 0), (1, 0, 0), 0.0, "radius"),
        ((0, 0, 0), (1, 0, 0), np.nan, "radius"),
        ((0, 0), (1, 0, 0), 1.0, "start"),
        ((0, 0, 0), (1, np.inf, 0), 1.0, "goal"),
    ],
)
def test_bad_arguments_are_named(start, goal, radius, word):
    with pytest.raises(InputError, match=word):
        shortest_path(start, goal, radius)
