"""The independent replay against motions with known answers, and against plans with known faults."""

from __future__ import annotations

import copy
import math

import numpy as np
import pytest
from benchmarks.replay import integrate, replay

CAR = {
    "wheelbase": 2.5,
    "body": [{"name": "body", "vertices": [[-1, -1], [3, -1], [3, 1], [-1, 1]]}],
    "limits": {"speed": [-2, 2], "acceleration": [-1, 1], "steering": 0.6, "steering_rate": 0.5},
}


def plan(t, inputs, first, goal, obstacle):
    """A plan file's object whose knots are the replay's own."""
    a, omega = zip(*inputs, strict=True)
    states = {name: [value] * len(t) for name, value in zip(("x", "y", "theta", "v", "delta"), first, strict=True)}
    data = {
        "vehicle": CAR,
        "scenario": {
            "workspace": [[-50, -50], [50, -50], [50, 50], [-50, 50]],
            "obstacles": [{"name": "box", "vertices": obstacle}],
            "goal": dict(zip(("x", "y", "theta"), goal, strict=True)),
        },
        "trajectory": {"t": list(t), "states": states, "inputs": {"a": list(a), "omega": list(omega)}},
    }
    knots = integrate(data, np.zeros(2))[1]
    for i, name in enumerate(states):
        states[name] = knots[:, i + 1].tolist()
    return data


BOX = [[20.0, 0], [21, 0], [21, 1], [20, 1]]


def straight(obstacle=BOX):
    """From rest to rest, 2 m forward in 2 s + 8 m at 1 m/s."""
    return plan([0, 1, 10, 11], [(1, 0), (0, 0), (-1, 0)], [0, 0, 0, 0, 0], [10, 0, 0], obstacle)


def test_straight_line_ends_where_it_must():
    seen = replay(straight())
    assert seen.problems() == []
    assert seen.goal_position == pytest.approx(0, abs=1e-9)
    assert seen.clearance == pytest.approx(7.0, abs=1e-9)
    assert seen.knots == 0


def test_circle_has_the_radius_of_the_steering_angle():
    delta, radius = 0.5, 2.5 / math.tan(0.5)
    full_turn = 2 * math.pi * radius
    data = plan([0, full_turn], [(0, 0)], [3, 4, 0.7, 1, delta], [3, 4, 0.7], BOX)
    rows, _ = integrate(data, np.zeros(2))
    centre = np.array([3 - radius * math.sin(0.7), 4 + radius * math.cos(0.7)])
    assert np.hypot(*(rows[:, 1:3] - centre).T) == pytest.approx(radius, abs=1e-9)
    assert rows[-1, 1:3] == pytest.approx([3, 4], abs=1e-9)
    assert rows[-1, 3] == pytest.approx(0.7 + 2 * math.pi, abs=1e-9)
    assert np.diff(rows[:, 0]).max() <= 1e-3 + 1e-12


def test_thin_wall_between_the_knots_is_seen():
    seen = replay(straight([[6.0, 0], [6.01, 0], [6.01, 0.1], [6, 0.1]]))
    assert seen.clearance == 0
    # The front, 3 m ahead, reaches x = 6 at 3.5 s; the rear, 1 m behind, leaves x = 6.01 at 7.51 s.
    assert seen.overlaps[0] == pytest.approx(3.5, abs=2e-3)
    assert seen.overlaps[-1] == pytest.approx(7.51, abs=2e-3)
    assert any("overlap" in problem for problem in seen.problems())


def test_an_obstacle_with_a_hole_is_free_inside():
    data = straight([[-20, -20], [30, -20], [30, 20], [-20, 20]])
    assert replay(data).overlaps
    data["scenario"]["obstacles"][0]["holes"] = [[[-15, -15], [25, -15], [25, 15], [-15, 15]]]
    assert replay(data).problems() == []


@pytest.mark.parametrize(
    ("fault", "word"),
    [
        (lambda p: p["scenario"]["goal"].update(x=10.02), "goal is missed"),
        (lambda p: p["scenario"]["goal"].update(theta=0.03), "heading"),
        (lambda p: p["trajectory"]["states"]["y"].__setitem__(2, 0.006), "knot"),
        (lambda p: p["vehicle"]["limits"].update(speed=[-2, 0.9]), "limit"),
        (lambda p: p["vehicle"]["limits"].update(acceleration=[-0.5, 1]), "limit"),
        (lambda p: p["scenario"].update(workspace=[[-50, -50], [12, -50], [12, 50], [-50, 50]]), "workspace"),
    ],
)
def test_faults_are_named(fault, word):
    data = copy.deepcopy(straight())
    fault(data)
    problems = replay(data).problems()
    assert len(problems) == 1
    assert word in problems[0]


def test_a_promise_that_is_not_kept():
    assert replay(straight()).problems(margin=7.0) == []
    assert "promises" in replay(straight()).problems(margin=7.01)[0]


def test_headings_are_equal_modulo_a_full_turn():
    data = straight()
    data["scenario"]["goal"]["theta"] = -4 * math.pi
    assert replay(data).problems() == []


def test_far_from_the_origin():
    data = straight()
    shift = 4.5e9
    data["trajectory"]["states"]["x"] = [x + shift for x in data["trajectory"]["states"]["x"]]
    data["scenario"]["goal"]["x"] += shift
    for polygon in (data["scenario"]["workspace"], data["scenario"]["obstacles"][0]["vertices"]):
        polygon[:] = [[x + shift, y] for x, y in polygon]
    assert replay(data).problems() == []
