"""The judge on motions of known clearance, and against a brute-force replay with shapely."""

import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.geometry import ConvexPolygon, clearance, transform
from tightspot.scenarios import Tolerance
from tightspot.trajectory import Trajectory
from tightspot.vehicles import BodyPart, SingleTrack
from tightspot.verification import JudgeSettings, Witness, check_certificate, minimum_clearance, replay, verify
from tightspot.verification.certificate import metres, rounded_down


def square(x, y, size=1.0):
    """Corners of a square whose lower left corner is (x, y)."""
    return np.array([[x, y], [x + size, y], [x + size, y + size], [x, y + size]])


@pytest.fixture
def there_and_back(kit):
    """A body of 4 m x 2 m that drives 8 m straight ahead: its front bumper goes from x = 3 to x = 11."""
    car = kit.box_car()
    return car, kit.drive(car, [0, 2, 4, 6], [[1, 0], [0, 0], [-1, 0]], start=(0, 0, 0, 0, 0))


@pytest.mark.parametrize("gap", [0.001, 0.02, 0.3])
def test_passing_an_obstacle_at_known_clearance(kit, there_and_back, gap):
    car, trajectory = there_and_back
    scenario = kit.scene(trajectory, [square(5, 1 + gap)])
    certificate = verify(scenario, car, trajectory, margin=0.5 * gap)
    assert certificate.certified, certificate.summary()
    assert gap - 1e-3 - 1e-6 <= certificate.clearance <= gap
    assert certificate.witnesses == ()
    assert check_certificate(scenario, car, trajectory, certificate).ok


def test_stopping_before_an_obstacle(kit, there_and_back):
    car, trajectory = there_and_back
    end = trajectory.states[-1, 0]
    scenario = kit.scene(trajectory, [square(end + 3 + 0.04, -0.5)])
    assert verify(scenario, car, trajectory, margin=0.0399).certified
    certificate = verify(scenario, car, trajectory, margin=0.0401)
    assert not certificate.certified
    assert certificate.witness.kind == "margin"
    assert certificate.witness.clearance == pytest.approx(0.04, abs=1e-6)
    assert certificate.witness.time == pytest.approx(6, abs=0.02)
    assert [check.name for check in certificate.failed] == ["obstacles"]


def test_corner_of_a_turning_body_sweeps_a_circle(kit):
    """At constant steering every body point moves on a circle about the turning centre (0, R)."""
    car = kit.box_car(wheelbase=2.0)
    delta, speed = 0.6, 1.0
    R = 2.0 / np.tan(delta)
    trajectory = kit.drive(car, [0, 3, 6], np.zeros((2, 2)), start=(0, 0, 0, speed, delta))
    sweep = np.hypot(3, R + 1)  # the front right corner (3, -1), outermost
    angle = np.arctan2(-(R + 1), 3) + 0.5 * speed / R * 6  # where it is half way
    outward = np.array([np.cos(angle), np.sin(angle)])
    across = np.array([-outward[1], outward[0]])
    near = np.array([0, R]) + (sweep + 0.02) * outward
    ring = [near - 2 * across, near - 2 * across + outward, near + 2 * across + outward, near + 2 * across]
    certificate = verify(kit.scene(trajectory, [ring]), car, trajectory, margin=0.019)
    assert certificate.check("obstacles").passed
    assert 0.019 <= certificate.clearance <= 0.02
    into = [np.asarray(ring) - 0.05 * outward]
    witness = verify(kit.scene(trajectory, into), car, trajectory).witness
    assert witness.kind == "collision"
    assert witness.clearance == pytest.approx(-0.03, abs=1e-5)
    assert witness.time == pytest.approx(3, abs=2e-3)


def test_collision_between_free_knots_is_found(kit):
    """Past a pole in two intervals: free at all three knots, a collision half way."""
    car = kit.box_car()
    trajectory = kit.drive(car, [0, 4, 8], [[0, 0], [0, 0]], start=(0, 0, 0, 3.0, 0.0))
    pole = square(8.95, 0.92, size=0.1)
    scenario = kit.scene(trajectory, [pole])
    knots, _ = kit.shapely_clearance(scenario, car, trajectory, trajectory.t)
    assert (knots > 1).all()
    certificate = verify(scenario, car, trajectory)
    series = minimum_clearance(scenario, car, trajectory, dt=1e-3)
    assert certificate.witness.kind == "collision"
    assert certificate.witness.clearance == pytest.approx(-0.08, abs=1e-6)
    assert certificate.witness.clearance == pytest.approx(series.minimum, abs=1e-6)
    assert certificate.witness.part == "body"
    assert certificate.witness.obstacle == "o0/0"
    assert 6 / 3 - 1e-6 <= certificate.witness.time <= 10 / 3 + 1e-6


def brute_force_minimum(car, trajectory, polygon):
    """Least clearance over time: samples 1 ms apart, refined to 10 us where they are nearly as low."""
    played = replay(car, trajectory, tolerance=1e-9)

    def at(times):
        poses = played.at(times)[:, :3]
        return np.min([clearance(transform(p.polygon.vertices, poses), polygon.vertices) for p in car.parts], axis=0)

    times = np.arange(0, trajectory.t[-1] + 5e-4, 1e-3)
    coarse = at(times)
    low = times[coarse < coarse.min() + 3e-3][:, None] + np.linspace(-1e-3, 1e-3, 201)
    low = np.clip(low.ravel(), 0, trajectory.t[-1])
    values = at(low)
    return values.min(), low[values < values.min() + 1e-6]


@pytest.mark.parametrize("seed", range(6))
def test_every_colliding_pair_with_its_worst_moment(kit, seed):
    car = kit.box_car()
    trajectory = kit.wander(car, seed, steps=16)
    low, high = trajectory.poses[:, :2].min(axis=0) - 2, trajectory.poses[:, :2].max(axis=0) + 2
    scenario = kit.scene(trajectory, kit.boxes(seed, 5, low, high))
    certificate = verify(scenario, car, trajectory)
    found = {witness.obstacle: witness for witness in certificate.witnesses}
    for name, polygon in scenario.obstacle_parts:
        worst, times = brute_force_minimum(car, trajectory, polygon)
        alone = kit.scene(trajectory, [polygon.vertices])
        _, area = kit.shapely_clearance(alone, car, trajectory, np.arange(0, trajectory.t[-1], 0.02))
        assert (name in found) == (worst < 0)
        assert not area.any() or name in found
        if name in found:
            assert found[name].kind == "collision"
            assert found[name].clearance == pytest.approx(worst, abs=2e-5)
            assert np.abs(times - found[name].time).min() <= 1e-3
    assert [w.clearance for w in certificate.witnesses] == sorted(w.clearance for w in certificate.witnesses)


def test_touching_exactly_cannot_be_decided_and_says_so(kit, there_and_back):
    car, trajectory = there_and_back
    scenario = kit.scene(trajectory, [square(5, 1)])
    certificate = verify(scenario, car, trajectory)
    assert not certificate.certified
    assert certificate.witness.kind == "undecided"
    assert abs(certificate.witness.clearance) < 1e-8
    assert "too near to decide" in str(certificate.witness)


def test_floor_bounds_the_work(kit, there_and_back):
    car, trajectory = there_and_back
    scenario = kit.scene(trajectory, [square(5, 1.001)])
    coarse = JudgeSettings(floor=0.1)
    assert not verify(scenario, car, trajectory, margin=0.0009, settings=coarse).certified
    assert verify(scenario, car, trajectory, margin=0.0009).certified


def test_workspace_may_be_touched_at_the_start_but_not_left(kit, there_and_back):
    car, trajectory = there_and_back
    touching = ConvexPolygon.rectangle(-1, 20, -1, 1)
    assert verify(kit.scene(trajectory, workspace=touching), car, trajectory).check("workspace").passed
    tight = ConvexPolygon.rectangle(-1, 10.9, -2, 2)
    certificate = verify(kit.scene(trajectory, workspace=tight), car, trajectory)
    assert not certificate.certified
    overshoot = trajectory.states[-1, 0] + 3 - 10.9
    assert certificate.witness.obstacle == "workspace"
    assert certificate.witness.clearance == pytest.approx(-overshoot, abs=1e-6)
    assert certificate.check("workspace").value == pytest.approx(-overshoot, abs=2e-5)


def test_workspace_is_held_between_knots(kit):
    """Full turn in one interval: the body leaves a slanted workspace although both knots are inside."""
    car = kit.box_car(wheelbase=2.0)
    radius = 2.0 / np.tan(0.9)
    period = 2 * np.pi * radius / 1.0
    trajectory = kit.drive(car, [0, period], [[0, 0]], start=(0, 0, 0, 1.0, 0.9))
    W = ConvexPolygon.from_vertices([(-10, -2), (10, -2), (10, 2.5), (-10, 2.5)])
    certificate = verify(kit.scene(trajectory, workspace=W), car, trajectory)
    corner = radius + np.hypot(3, radius + 1)
    assert certificate.check("goal position").passed
    assert certificate.witness.obstacle == "workspace"
    assert certificate.witness.penetration == pytest.approx(corner - 2.5, abs=1e-6)


def test_body_of_several_parts_is_not_its_hull(kit):
    """A fork: the obstacle stands between the tines, which is free."""
    parts = (
        BodyPart("chassis", ConvexPolygon.rectangle(-1, 0, -1, 1)),
        BodyPart("left", ConvexPolygon.rectangle(0, 2, 0.8, 1)),
        BodyPart("right", ConvexPolygon.rectangle(0, 2, -1, -0.8)),
    )
    car = SingleTrack("fork", 1.5, parts, kit.box_car().limits)
    trajectory = kit.drive(car, [0, 1, 2], [[1, 0], [-1, 0]])
    scenario = kit.scene(trajectory, [square(1.3, -0.25, size=0.5)])
    certificate = verify(scenario, car, trajectory, margin=0.2)
    assert certificate.certified
    assert certificate.clearance == pytest.approx(0.3, abs=1.1e-3)
    assert [(p.part, p.obstacle) for p in certificate.pairs] == [
        ("chassis", "o0/0"),
        ("left", "o0/0"),
        ("right", "o0/0"),
    ]
    assert check_certificate(scenario, car, trajectory, certificate).ok


def test_goal_is_judged_on_the_replay_modulo_turns(kit):
    car = kit.box_car(wheelbase=2.0)
    period = 2 * np.pi * 2.0 / np.tan(0.9)
    trajectory = kit.drive(car, [0, period], [[0, 0]], start=(0, 0, 0, 1.0, 0.9))
    here = kit.scene(trajectory, goal=np.array([0, 0, 0, np.nan, np.nan]))
    certificate = verify(here, car, trajectory)
    assert certificate.certified
    assert {"goal speed", "goal steering"}.isdisjoint(check.name for check in certificate.checks)
    off = here.with_(goal=np.array([0.008, 0.008, 0.02, 1.5, 0.8]), tolerance=Tolerance(heading=0.01))
    failed = {check.name: check for check in verify(off, car, trajectory).failed}
    assert set(failed) == {"goal position", "goal heading", "goal speed", "goal steering"}
    assert failed["goal position"].value == pytest.approx(0.008 * np.sqrt(2), abs=1e-6)
    assert failed["goal heading"].value == pytest.approx(0.02, abs=1e-6)


def test_start_limits_and_dynamics_are_judged(kit):
    car = kit.box_car()
    good = kit.wander(car, 3)
    scenario = kit.scene(good)
    assert verify(scenario, car, good).certified
    moved = scenario.with_(start=np.add(scenario.start, [2e-6, 0, 0, 0, 0]))
    assert [c.name for c in verify(moved, car, good).failed] == ["start position"]
    states = good.states.copy()
    states[5, 0] += 0.01
    odd = verify(scenario, car, Trajectory(good.t, states, good.inputs))
    assert [c.name for c in odd.failed] == ["dynamics position"]
    assert odd.check("dynamics position").value == pytest.approx(0.01, abs=1e-6)
    weak = kit.box_car(limits=car.limits.__class__((-3, 3), (-0.05, 0.05), 0.1, 3))
    assert [c.name for c in verify(scenario, weak, good).failed] == ["state bounds", "input bounds"]


def test_no_obstacles(kit, there_and_back):
    car, trajectory = there_and_back
    certificate = verify(kit.scene(trajectory), car, trajectory, margin=1.0)
    assert certificate.certified
    assert certificate.clearance == np.inf
    assert "nothing to touch" in certificate.summary()[0]


def test_steering_beyond_a_right_angle_ends_without_a_certificate(kit):
    car = kit.box_car()
    trajectory = kit.drive(car, [0, 1], [[0, 3.0]], start=(0, 0, 0, 0, 0))
    scenario = kit.scene(trajectory, [square(5, 5)], goal=np.zeros(5))
    certificate = verify(scenario, car, trajectory)
    assert not certificate.certified
    assert certificate.witness.kind == "undecided"
    assert certificate.to_dict()["clearance"] is None


@pytest.mark.parametrize("margin", [-0.1, np.nan, np.inf])
def test_margin_must_be_a_length(kit, there_and_back, margin):
    car, trajectory = there_and_back
    with pytest.raises(InputError, match="margin"):
        verify(kit.scene(trajectory), car, trajectory, margin=margin)


def test_dense_series_names_the_nearest_parts(kit, there_and_back):
    car, trajectory = there_and_back
    scenario = kit.scene(trajectory, [square(-3, 0), square(11.5, 0)])
    series = minimum_clearance(scenario, car, trajectory, dt=0.05)
    assert series.obstacle[0] == "o0/0"
    assert series.obstacle[-1] == "o1/0"
    expected, _ = kit.shapely_clearance(scenario, car, trajectory, series.t)
    assert series.clearance == pytest.approx(expected, abs=1e-6)
    assert series.t[series.worst] == pytest.approx(6)
    assert series.workspace[0] == pytest.approx(29, abs=1e-6)


def test_a_known_replay_changes_nothing_in_the_certificate(kit):
    car = kit.box_car()
    trajectory = kit.wander(car, seed=3)
    scenario = kit.scene(trajectory, kit.boxes(3, 12, (-15, -15), (15, 15)))
    alone = verify(scenario, car, trajectory, margin=0.01)
    other = replay(car, kit.wander(car, seed=4))
    for known in (replay(car, trajectory), other):
        assert verify(scenario, car, trajectory, margin=0.01, known=known).to_dict() == alone.to_dict()


@pytest.mark.parametrize(
    ("length", "said", "promised"),
    [
        (0.0, "0.0000", "0.0000"),
        (0.12349, "0.1235", "0.1234"),
        (-0.12349, "-0.1235", "-0.1235"),
        (9.99e-5, "1.0e-04", "9.9e-05"),
        (1.06e-6, "1.1e-06", "1.0e-06"),
        (-2.0e-9, "-2.0e-09", "-0.0001"),
    ],
)
def test_small_lengths_are_said_by_their_digits(length, said, promised):
    assert metres(length) == said
    assert rounded_down(length) == promised
    assert float(rounded_down(length)) <= length


def test_an_overlap_of_a_micrometre_is_not_told_as_nothing():
    moment = Witness(1.0, "body", "wall/0", -1e-6, (0.0, 0.0, 0.0), "collision")
    assert str(moment) == "body overlaps wall/0 by 1.0e-06 m at t = 1.000 s"
