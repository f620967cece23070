"""Plans driven by hand: no solver, known gear changes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from matplotlib.figure import Figure

from tightspot.geometry import ConvexPolygon
from tightspot.scenarios import Obstacle, Scenario
from tightspot.trajectory import Trajectory
from tightspot.vehicles import vehicle
from tightspot.verification import Plan, replay, verify

BOX = Obstacle("box", [(12.0, -4.0), (15.0, -4.0), (15.0, -1.6), (12.0, -1.6)])
RING = Obstacle("ring", [(2, 4), (8, 4), (8, 7), (2, 7)], ([(3, 5), (7, 5), (7, 6), (3, 6)],))

# Forward 8 s, reverse 6 s, forward 4 s; intervals of 1 s.
INPUTS = np.array(
    [[0.5, 0.05]] * 2 + [[0.0, -0.05]] * 4 + [[-0.5, 0.0]] * 2
    + [[-0.5, 0.05]] * 2 + [[0.0, 0.0]] * 2 + [[0.5, -0.05]] * 2
    + [[0.4, 0.0]] * 2 + [[-0.4, 0.05]] * 2
)  # fmt: skip
DURATIONS = [8.0, 6.0, 4.0]
GEARS = [1, -1, 1]


def make_plan(
    *,
    name: str = "by hand",
    workspace: tuple[float, float, float, float] = (-3.0, 17.0, -5.0, 8.0),
    obstacles: tuple[Obstacle, ...] = (BOX, RING),
    offset: tuple[float, float] = (0.0, 0.0),
    car: str = "tpcap",
    margin: float = 0.05,
    inputs: np.ndarray = INPUTS,
) -> Plan:
    model, start = vehicle(car), np.zeros(5)
    t = np.arange(len(inputs) + 1.0)
    driven = replay(model, Trajectory(t, np.tile(start, (len(t), 1)), inputs)).knots
    trajectory = Trajectory(t, driven, inputs)
    scenario = Scenario(
        name=name,
        workspace=ConvexPolygon.rectangle(*workspace),
        obstacles=obstacles,
        start=start,
        goal=driven[-1],
        vehicle=car,
        margin=margin,
        offset=np.array(offset),
    )
    return Plan(scenario, model, trajectory, verify(scenario, model, trajectory, margin=margin))


@pytest.fixture(scope="session")
def plan() -> Plan:
    """A certified plan with two gear changes."""
    made = make_plan()
    assert made.certificate.certified, made.certificate.summary()
    return made


@pytest.fixture(scope="session")
def collision() -> Plan:
    """The same motion through an obstacle."""
    wall = Obstacle("wall", [(8.0, 0.5), (9.0, 0.5), (9.0, 3.0), (8.0, 3.0)])
    made = make_plan(name="collision", obstacles=(wall,))
    assert not made.certificate.certified
    return made


@pytest.fixture
def blank() -> Callable[[], Figure]:
    """Figures with one pair of axes."""

    def make() -> Figure:
        figure = Figure()
        figure.add_subplot()
        return figure

    return make
