"""Headings are compared modulo whole turns: a start or goal turned once or twice is the same problem."""

from __future__ import annotations

import numpy as np
import pytest

import tightspot


@pytest.mark.parametrize(("at_start", "at_goal"), [(1, 0), (-2, 0), (0, -1), (1, -1)])
def test_whole_turns_do_not_matter(at_start, at_goal):
    scene = tightspot.load("oblique")
    turned = scene.with_(
        start=scene.start + np.array([0, 0, at_start * 2 * np.pi, 0, 0]),
        goal=scene.goal + np.array([0, 0, at_goal * 2 * np.pi, 0, 0]),
    )
    plan, same = tightspot.plan(scene), tightspot.plan(turned)
    assert same.certificate.certified
    assert same.trajectory.duration == pytest.approx(plan.trajectory.duration, rel=1e-3)
    turn = same.trajectory.poses[-1, 2] - turned.goal[2]
    assert np.cos(turn) == pytest.approx(1, abs=1e-3)
