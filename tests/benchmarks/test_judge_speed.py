"""The judge's benchmark judges what it says: a free drive among so many obstacles."""

import numpy as np
import pytest
from benchmarks.judge_speed import FREE, crowd, drive, seconds_of

from tightspot.vehicles import vehicle
from tightspot.verification import verify


@pytest.mark.parametrize("count", [10, 60])
def test_a_crowd_beside_a_drive(count: int) -> None:
    car = vehicle("paper")
    trajectory = drive(car)
    assert trajectory.states[-1, 0] > 50, "it drives along the room"
    scenario = crowd(count, trajectory, np.random.default_rng(0))
    assert len(scenario.obstacle_parts) == count
    centres = np.array([part.vertices.mean(axis=0) for _, part in scenario.obstacle_parts])
    apart = np.hypot(*(trajectory.states[:, None, :2] - centres).transpose(2, 0, 1))
    assert apart.min() > FREE - 0.1
    seconds, certificate = seconds_of(lambda: verify(scenario, car, trajectory, margin=0.05), 2)
    assert 0 < seconds < 60
    assert certificate.certified
    assert {proof.obstacle for proof in certificate.pairs} == {name for name, _ in scenario.obstacle_parts}
