"""The paper's settings, solved: free at every knot, and the judge finds the collision between them."""

import json
from pathlib import Path

import numpy as np
import pytest

from tightspot.geometry import clearance, transform
from tightspot.scenarios import builtin
from tightspot.trajectory import Trajectory
from tightspot.vehicles import vehicle
from tightspot.verification import minimum_clearance, replay, verify


@pytest.fixture(scope="module")
def solution():
    data = json.loads((Path(__file__).parent / "data" / "paper_vertical.json").read_text())
    car, t = vehicle(data["vehicle"]), np.array(data["t"])
    states = np.zeros((t.size, 5))
    inputs = np.column_stack([data["a"], data["omega"]])
    return car, Trajectory(t, replay(car, Trajectory(t, states, inputs)).knots, inputs)


def test_knots_are_free(solution):
    car, trajectory = solution
    V = transform(car.parts[0].polygon.vertices, trajectory.poses)
    for _, obstacle in builtin("vertical").obstacle_parts:
        assert clearance(V, obstacle.vertices).min() > -2e-6


def test_the_collision_between_the_knots_is_found_in_time_parts_and_depth(solution):
    car, trajectory = solution
    scenario = builtin("vertical")
    certificate = verify(scenario, car, trajectory)
    assert not certificate.certified
    assert {check.name for check in certificate.failed} == {"obstacles", "workspace"}
    [witness] = [w for w in certificate.witnesses if w.obstacle != "workspace"]
    assert (witness.part, witness.obstacle, witness.kind) == ("body", "right/0", "collision")
    assert witness.time == pytest.approx(56.337, abs=2e-3)
    assert witness.penetration == pytest.approx(0.0225, abs=1e-4)
    assert np.abs(trajectory.t - witness.time).min() > 1.0


def test_a_brute_force_replay_says_the_same(solution, kit):
    car, trajectory = solution
    scenario = builtin("vertical")
    certificate = verify(scenario, car, trajectory)
    [witness] = [w for w in certificate.witnesses if w.obstacle != "workspace"]
    series = minimum_clearance(scenario, car, trajectory, dt=1e-3)
    assert witness.clearance == pytest.approx(series.minimum, abs=1e-4)
    assert witness.time == pytest.approx(series.t[series.worst], abs=2e-3)
    outside = certificate.check("workspace").value
    assert outside == pytest.approx(series.workspace.min(), abs=1e-4)
    _, area = kit.shapely_clearance(scenario, car, trajectory, [witness.time, trajectory.t[0]])
    assert area[0] > 1e-5
    assert area[1] == 0
