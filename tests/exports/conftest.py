"""A plan driven by hand with a CommonRoad vehicle, near the origin, far away, and ending in motion."""

from __future__ import annotations

import numpy as np
import pytest

from tightspot.geometry import ConvexPolygon
from tightspot.scenarios import Obstacle, Scenario
from tightspot.trajectory import Trajectory
from tightspot.vehicles import vehicle
from tightspot.verification import Plan, replay, verify

CAR = "commonroad-bmw-320i"
FAR = (4_484_378_812.0, -354_286_011.0)
START = np.array([0.25, -0.25, 0.4, 0.0, 0.1])
# Forward and back again, steering while all but standing; no duration is a multiple of a time step.
INPUTS = np.array([[1.0, 0.3], [0.2, -0.2], [-1.1, -0.1], [0.0, 0.35], [-0.8, 0.1], [0.1, -0.3], [0.6 / 0.9, -0.1]])
DURATIONS = np.array([0.83, 0.77, 0.9, 0.37, 0.83, 0.7, 0.9])
BOX = Obstacle("box", [(9.0, -1.0), (11.0, -1.0), (11.0, 1.0), (9.0, 1.0)])


def make_plan(
    *, car: str = CAR, offset: tuple[float, float] = (0.0, 0.0), steps: int = len(INPUTS), start: np.ndarray = START
) -> Plan:
    model = vehicle(car)
    t = np.concatenate([[0.0], np.cumsum(DURATIONS[:steps])])
    driven = replay(model, Trajectory(t, np.tile(start, (len(t), 1)), INPUTS[:steps])).knots
    trajectory = Trajectory(t, driven, INPUTS[:steps])
    goal = driven[-1].copy()
    scenario = Scenario(
        name="by hand",
        workspace=ConvexPolygon.rectangle(-12, 14, -10, 10),
        obstacles=(BOX,),
        start=start,
        goal=goal,
        vehicle=car,
        margin=0.05,
        offset=np.array(offset),
    )
    return Plan(scenario, model, trajectory, verify(scenario, model, trajectory, margin=0.05), {"seconds": 1.5})


@pytest.fixture(scope="session")
def plan() -> Plan:
    """It ends standing."""
    made = make_plan()
    assert made.certificate.certified, made.certificate.summary()
    assert abs(made.trajectory.states[-1, 3]) < 1e-9
    return made


@pytest.fixture(scope="session")
def moving_plan() -> Plan:
    """It ends while it drives."""
    made = make_plan(steps=2)
    assert made.certificate.certified, made.certificate.summary()
    assert made.trajectory.states[-1, 3] > 0.5
    return made


@pytest.fixture(scope="session")
def far_plan() -> Plan:
    """The same in a scene millions of kilometres from the origin."""
    return make_plan(offset=FAR)
