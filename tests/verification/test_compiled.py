"""The compiled judge finds what the one in NumPy finds: the same verdicts, proofs of one form, the same numbers."""

import copy
import pickle
import subprocess
import sys

import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.geometry import ConvexPolygon
from tightspot.trajectory import Trajectory
from tightspot.vehicles import BodyPart, SingleTrack
from tightspot.verification import compiled, minimum_clearance, replay, verify
from tightspot.verification.certificate import digest
from tightspot.verification.sampled import by_interval, nearness, nearness_along, sampled_clearance, sampled_room

pytestmark = pytest.mark.skipif(compiled.core() is None, reason="the core is not built")

NEAR = 1e-9


@pytest.fixture
def in_numpy(monkeypatch):
    """Runs a function with the compiled judge out of reach."""

    def run(function, *arguments, **options):
        with monkeypatch.context() as patch:
            patch.setattr(compiled, "is_compiled", lambda vehicle: False)
            return function(*arguments, **options)

    return run


def ring(rng, corners, size):
    """A convex ring with so many corners about the origin."""
    angles = np.sort(rng.uniform(0, 2 * np.pi, corners) / corners + np.linspace(0, 2 * np.pi, corners, endpoint=False))
    return size * np.stack([np.cos(angles), rng.uniform(0.4, 1) * np.sin(angles)], axis=1)


def crowded(kit, rng, trajectory, count, clear):
    """A scene with obstacles of 3 to 12 corners beside the motion, ``clear`` metres away from it or nearer."""
    rings = []
    for _ in range(count):
        pose = trajectory.states[rng.integers(len(trajectory.states))]
        side = rng.choice((-1, 1)) * (2.4 + clear * rng.uniform(-0.2, 1))
        centre = pose[:2] + side * np.array([-np.sin(pose[2]), np.cos(pose[2])])
        rings.append(centre + ring(rng, int(rng.integers(3, 13)), rng.uniform(0.2, 1.2)))
    return kit.scene(trajectory, rings)


def articulated(kit):
    """A body of three overlapping parts."""
    car = kit.box_car()
    parts = tuple(
        BodyPart(name, ConvexPolygon.rectangle(*sides))
        for name, sides in (("rear", (-1, 1, -1, 1)), ("front", (0.5, 3, -0.9, 0.9)), ("mast", (1, 1.2, -1.3, 1.3)))
    )
    return SingleTrack("three", car.wheelbase, parts, car.limits)


def same(one, other):
    """Certificates agree in everything but rounding."""
    assert one.certified == other.certified
    assert one.clearance == pytest.approx(other.clearance, abs=NEAR)
    assert [(w.part, w.obstacle, w.kind) for w in one.witnesses] == [
        (w.part, w.obstacle, w.kind) for w in other.witnesses
    ]
    for mine, its in zip(one.witnesses, other.witnesses, strict=True):
        assert mine.clearance == pytest.approx(its.clearance, abs=NEAR)
        assert mine.time == pytest.approx(its.time, abs=1e-4)
    assert [(p.part, p.obstacle, p.t.size) for p in one.pairs] == [(p.part, p.obstacle, p.t.size) for p in other.pairs]
    for mine, its in zip((*one.pairs, *one.workspace), (*other.pairs, *other.workspace), strict=True):
        np.testing.assert_allclose(mine.t, its.t, atol=NEAR)
        np.testing.assert_allclose(mine.clearance, its.clearance, atol=NEAR)
    assert [check.name for check in one.checks] == [check.name for check in other.checks]
    for mine, its in zip(one.checks, other.checks, strict=True):
        assert (mine.passed, mine.limit) == (its.passed, its.limit)
        assert mine.value == pytest.approx(its.value, abs=NEAR)
    assert one.integration.substeps == other.integration.substeps


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("margin", [0.0, 0.15])
def test_certificates_agree(kit, in_numpy, seed, margin):
    rng = np.random.default_rng(seed)
    car = articulated(kit) if seed % 3 == 0 else kit.box_car()
    trajectory = kit.wander(car, seed)
    scenario = crowded(kit, rng, trajectory, count=1 + seed % 6, clear=(0.5, 3.0, 12.0)[seed % 3 - 1])
    found = verify(scenario, car, trajectory, margin=margin)
    same(found, in_numpy(verify, scenario, car, trajectory, margin=margin))
    lowest = minimum_clearance(scenario, car, trajectory, dt=2e-3).minimum
    assert found.clearance <= lowest
    if found.clearance >= margin:
        assert found.clearance >= min(lowest, margin) - 1e-3


@pytest.mark.parametrize("room", [30.0, 0.0])
def test_walls_and_nothing_else(kit, in_numpy, room):
    car = kit.box_car()
    trajectory = kit.wander(car, 5)
    scenario = kit.scene(trajectory, room=room)
    found = verify(scenario, car, trajectory)
    same(found, in_numpy(verify, scenario, car, trajectory))
    assert found.certified == (room > 0)


def test_too_near_to_decide(kit, in_numpy):
    car = kit.box_car()
    trajectory = kit.drive(car, [0, 2, 4], [[1, 0], [-1, 0]])
    scenario = kit.scene(trajectory, [[[2, 1.1], [3, 1.1], [3, 2]]])
    found = verify(scenario, car, trajectory, margin=0.1)
    same(found, in_numpy(verify, scenario, car, trajectory, margin=0.1))
    assert found.witness.kind == "undecided"


def test_far_from_the_origin(kit, in_numpy):
    car = kit.box_car()
    near = kit.wander(car, 2)
    trajectory = near.shifted([8000.0, -6000.0])
    scenario = crowded(kit, np.random.default_rng(2), trajectory, 3, clear=4.0)
    mine, its = (run(verify, scenario, car, trajectory) for run in (lambda f, *a: f(*a), in_numpy))
    assert mine.certified == its.certified
    assert mine.clearance == pytest.approx(its.clearance, abs=1e-8)


@pytest.mark.parametrize("seed", range(4))
def test_replays_agree(kit, in_numpy, seed):
    car = kit.box_car()
    trajectory = kit.wander(car, seed)
    mine, its = replay(car, trajectory, tolerance=1e-9), in_numpy(replay, car, trajectory, tolerance=1e-9)
    np.testing.assert_array_equal(mine.substeps, its.substeps)
    np.testing.assert_array_equal(mine.first_nodes, its.first_nodes)
    np.testing.assert_allclose(mine.nodes, its.nodes, rtol=1e-15)
    np.testing.assert_allclose(mine.node_states, its.node_states, atol=1e-11)
    assert mine.position_error == pytest.approx(its.position_error, abs=1e-11)
    assert mine.heading_error == pytest.approx(its.heading_error, abs=1e-11)
    times = np.random.default_rng(seed).uniform(0, trajectory.t[-1], (7, 3))
    times[0] = trajectory.t[[0, 1, -1]]
    np.testing.assert_allclose(mine.at(times), its.at(times), atol=1e-11)
    assert mine.at(1.25).shape == (car.n_states,)
    assert mine.at([]).shape == (0, car.n_states)


def test_what_cannot_be_integrated_is_refused_alike(kit, in_numpy):
    car = kit.box_car()
    for inputs, t in (([[1e300, 0]], [0, 1e3]), ([[0, 0.01]], [0, 1e7]), ([[1, 1e-8]], [0, 1e9])):
        trajectory = Trajectory(t, [[0, 0, 0, 1, 0.2]] * 2, inputs)
        for run in (lambda f, *a: f(*a), in_numpy):
            with pytest.raises(InputError, match="cannot be integrated"):
                run(replay, car, trajectory)


def test_a_model_of_one_s_own_is_not_taken_for_a_known_one(kit):
    class Slower(SingleTrack):
        def dynamics(self, state, control, ns):
            return [0.5 * rate for rate in super().dynamics(state, control, ns)[:3]] + list(control)

    car = kit.box_car()
    slow = Slower(car.name, car.wheelbase, car.body, car.limits)
    assert compiled.is_compiled(car)
    assert not compiled.is_compiled(slow)
    trajectory = kit.wander(car, 1)
    assert replay(slow, trajectory).core is None
    assert not np.allclose(replay(slow, trajectory).knots, replay(car, trajectory).knots)


def test_replays_and_certificates_can_be_sent_elsewhere(kit):
    car = kit.box_car()
    trajectory = kit.wander(car, 3)
    scenario = kit.scene(trajectory)
    played, judged = replay(car, trajectory), verify(scenario, car, trajectory)
    for sent in (pickle.loads(pickle.dumps(played)), copy.deepcopy(played)):
        np.testing.assert_allclose(sent.at([0.3, 2.7]), played.at([0.3, 2.7]), atol=1e-11)
    assert pickle.loads(pickle.dumps(judged)).digest == judged.digest


def test_the_digest_is_what_it_would_be_at_once(kit):
    car = kit.box_car()
    trajectory = kit.wander(car, 4)
    scenario = kit.scene(trajectory)
    certificate = verify(scenario, car, trajectory)
    written = trajectory.shifted(scenario.offset).to_dict()
    assert not isinstance(vars(certificate)["digest"], str)
    assert certificate.digest == digest(scenario.to_dict(), car.to_dict(), written, certificate.to_dict())
    assert isinstance(vars(certificate)["digest"], str)


def test_a_thousand_obstacles(kit, in_numpy):
    """Those far away do not change what is found of the near ones; each has its proof."""
    car = kit.box_car()
    trajectory = kit.wander(car, 6)
    near = [[[2.0, 3.0], [3.0, 3.0], [2.5, 4.0]]]
    far = [[[x, y], [x + 0.5, y], [x, y + 0.5]] for x in range(-40, 40, 2) for y in range(40, 65)]
    scenario = kit.scene(trajectory, [*near, *far], room=100.0)
    found, alone = verify(scenario, car, trajectory), verify(kit.scene(trajectory, near, room=100.0), car, trajectory)
    assert len(found.pairs) == 1001
    assert found.certified == alone.certified
    assert found.clearance == pytest.approx(alone.clearance, abs=NEAR)
    assert all(proof.t.size == 2 for proof in found.pairs[1:])
    same(found, in_numpy(verify, scenario, car, trajectory))


def test_plans_are_judged_without_the_core():
    """In a Python in which the core cannot be imported."""
    program = """
import sys
sys.modules["tightspot._core"] = None
import numpy as np
from tightspot.scenarios import builtin
from tightspot.trajectory import Trajectory
from tightspot.vehicles import vehicle
from tightspot.verification import verify
states = np.tile(builtin("vertical").start, (2, 1))
print(len(verify(builtin("vertical"), vehicle("paper"), Trajectory([0, 1], states, [[0, 0]])).pairs))
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.stdout.strip() == "2", done.stderr


@pytest.mark.parametrize("far", [0.5, 8.0, np.inf])
def test_samples_agree(kit, monkeypatch, far):
    car = articulated(kit)
    trajectory = kit.wander(car, 8)
    scenario = crowded(kit, np.random.default_rng(8), trajectory, 6, clear=6.0)
    states = np.concatenate([trajectory.states, trajectory.states + np.eye(5)[2]])
    mine = sampled_clearance(states, scenario, car, far), sampled_room(states, scenario, car)
    monkeypatch.setattr(compiled, "core", lambda: None)
    its = sampled_clearance(states, scenario, car, far), sampled_room(states, scenario, car)
    for one, other in zip(mine, its, strict=True):
        assert one.shape == other.shape
        np.testing.assert_allclose(one, other, atol=1e-12)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("far", [0.0, 0.5, 8.0, np.inf])
@pytest.mark.parametrize("per_interval", [1, 5])
def test_nearness_on_intervals_is_the_least_of_the_samples(kit, monkeypatch, seed, far, per_interval):
    car = articulated(kit)
    trajectory = kit.wander(car, 7 + seed)
    scenario = crowded(kit, np.random.default_rng(seed), trajectory, 6, clear=[6.0, 0.5][seed % 2])
    times = np.linspace(0, trajectory.duration, 10 * per_interval + 1)
    states = replay(car, trajectory).at(times)
    mine = nearness(states, per_interval, scenario, car, far)
    samples = sampled_clearance(states, scenario, car, far)
    np.testing.assert_allclose(mine.clearances, by_interval(samples[:, :, mine.near], per_interval), atol=1e-12)
    others = np.setdiff1d(np.arange(samples.shape[2]), mine.near)
    assert (mine.apart[:, others] > far).all()
    np.testing.assert_allclose(mine.apart[:, others], samples[0][:, others], atol=1e-12)
    np.testing.assert_allclose(mine.depths, by_interval(sampled_room(states, scenario, car), per_interval), atol=1e-12)
    monkeypatch.setattr(compiled, "core", lambda: None)
    its = nearness(states, per_interval, scenario, car, far)
    assert np.array_equal(mine.near, its.near)
    for one, other in zip(
        (mine.apart, mine.clearances, mine.depths), (its.apart, its.clearances, its.depths), strict=True
    ):
        assert one.shape == other.shape
        np.testing.assert_allclose(one, other, atol=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_nearness_along_a_motion_is_that_at_its_nodes(kit, in_numpy, seed):
    for car in (kit.box_car(), articulated(kit)):
        trajectory = kit.wander(car, 5 + seed)
        scenario = crowded(kit, np.random.default_rng(seed), trajectory, 6, clear=[6.0, 0.5][seed % 2])
        motion, numpy_motion = replay(car, trajectory), in_numpy(replay, car, trajectory)
        mine, its = nearness_along(motion, scenario), nearness_along(numpy_motion, scenario)
        first, samples = motion.first_nodes, sampled_clearance(motion.node_states, scenario, car)
        for k in range(trajectory.steps):
            inside = samples[first[k] : first[k + 1] + 1, :, mine.near]
            np.testing.assert_allclose(mine.clearances[k], inside.min(axis=0), atol=1e-12)
        assert np.array_equal(mine.near, its.near)
        for one, other in zip(
            (mine.apart, mine.clearances, mine.depths), (its.apart, its.clearances, its.depths), strict=True
        ):
            assert one.shape == other.shape
            np.testing.assert_allclose(one, other, atol=1e-8)


def test_nearness_without_obstacles(kit):
    car = kit.box_car()
    trajectory = kit.wander(car, 8)
    found = nearness(np.repeat(trajectory.states[:1], 9, axis=0), 4, kit.scene(trajectory), car)
    assert found.near.size == 0
    assert found.clearances.shape == (2, 1, 0)
    assert found.depths.shape == (2, 1, 4)


def test_samples_of_no_states_and_no_obstacles(kit):
    car = kit.box_car()
    trajectory = kit.wander(car, 8)
    scenario = kit.scene(trajectory)
    assert sampled_clearance(trajectory.states, scenario, car).shape == (len(trajectory.states), 1, 0)
    assert sampled_clearance(trajectory.states[:0], scenario, car).shape == (0, 1, 0)
    assert sampled_room(trajectory.states[:0], scenario, car).shape == (0, 1, 4)
