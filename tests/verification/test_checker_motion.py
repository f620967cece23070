"""The checker's own integration: its bound is honest, and it serves models other than the single track."""

import itertools

import numpy as np
import pytest

from tightspot.geometry import ConvexPolygon, transform
from tightspot.scenarios import Obstacle
from tightspot.trajectory import Trajectory
from tightspot.vehicles import BodyPart, MotionBounds, VehicleModel
from tightspot.verification import check_certificate, minimum_clearance, replay, verify
from tightspot.verification.extrapolation import general_motion
from tightspot.verification.lemma import Lemma
from tightspot.verification.quadrature import IntegrationError, single_track_motion


class Trailer(VehicleModel):
    """A car with an on-axle trailer of length d: theta_1' = v sin(theta - theta_1) / d."""

    name = "trailer"
    state_names = ("x", "y", "theta", "v", "delta", "theta1")
    state_units = ("m", "m", "rad", "m/s", "rad", "rad")
    input_names = ("a", "omega")
    input_units = ("m/s^2", "rad/s")
    wheelbase, length = 2.5, 3.0
    parts = (
        BodyPart("car", ConvexPolygon.rectangle(-0.8, 3.0, -0.9, 0.9)),
        BodyPart("trailer", ConvexPolygon.rectangle(-1.0, 2.0, -1.0, 1.0), frame=1),
    )
    state_bounds = (np.array([-np.inf] * 3 + [-3, -1, -np.inf]), np.array([np.inf] * 3 + [3, 1, np.inf]))
    input_bounds = (np.array([-3.0, -3]), np.array([3.0, 3]))

    def dynamics(self, state, control, ns):
        theta, v, delta, theta1 = state[2:]
        turn = v * ns.tan(delta) / self.wheelbase
        return [
            v * ns.cos(theta),
            v * ns.sin(theta),
            turn,
            *control,
            v * ns.sin(theta - theta1) / self.length,
        ]

    def frames(self, state, ns):
        x, y, theta, theta1 = state[0], state[1], state[2], state[5]
        return [(x, y, theta), (x - self.length * ns.cos(theta1), y - self.length * ns.sin(theta1), theta1)]

    def motion_bounds(self, before, after, controls):
        v = np.maximum(np.abs(before[:, 3]), np.abs(after[:, 3]))
        tan = np.tan(np.maximum(np.abs(before[:, 4]), np.abs(after[:, 4])))
        a, omega = np.abs(controls).T
        turn, turn1 = v * tan / self.wheelbase, v / self.length
        car = MotionBounds(v, turn, np.hypot(a, v * turn), (a * tan + v * omega * (1 + tan**2)) / self.wheelbase)
        trailer = MotionBounds(
            v, turn1, np.hypot(a + v * (turn + turn1), v * turn1), (a + v * (turn + turn1)) / self.length
        )
        return [car, trailer]

    def to_dict(self):
        return {"name": self.name}


def rk4_long_double(car, trajectory, at, steps):
    """(x, y, theta) at the times ``at``: RK4 in extended precision, ``steps`` steps from each to the next."""
    state, wide = trajectory.states[0].astype(np.longdouble), np.longdouble

    def slope(y, u):
        return np.array([y[3] * np.cos(y[2]), y[3] * np.sin(y[2]), y[3] * np.tan(y[4]) / wide(car.wheelbase), *u])

    rows = [state]
    for start, end in itertools.pairwise(at):
        k = np.searchsorted(trajectory.t, start, side="right") - 1
        h, u = (wide(end) - wide(start)) / steps, trajectory.inputs[k].astype(wide)
        for _ in range(steps):
            k1 = slope(state, u)
            k2 = slope(state + h / 2 * k1, u)
            k3 = slope(state + h / 2 * k2, u)
            state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + slope(state + h * k3, u))
        rows.append(state)
    return np.array(rows)[:, :3]


@pytest.mark.skipif(np.finfo(np.longdouble).eps > 1e-18, reason="needs extended precision")
def test_quadrature_keeps_its_bound_against_extended_precision(kit):
    car = kit.box_car()
    trajectory = kit.wander(car, 4, steps=3, dt=1.1)
    motion = single_track_motion(car, trajectory, np.array([0.4, 2.0]))
    assert motion.times.tolist() == sorted([*trajectory.t, 0.4, 2.0])
    coarse, fine = (rk4_long_double(car, trajectory, motion.times, steps) for steps in (400, 800))
    exact = fine + (fine - coarse) / 15
    error = np.abs(motion.states[:, :3] - exact).astype(float)
    assert (np.hypot(error[:, 0], error[:, 1]) <= motion.position_error).all()
    assert (error[:, 2] <= motion.heading_error).all()
    assert np.hypot(error[:, 0], error[:, 1]).max() < 1e-13
    assert motion.position_error.max() < 1e-10
    assert motion.heading_error.max() < 1e-11


@pytest.mark.parametrize("seed", range(5))
def test_quadrature_and_replay_agree_within_their_errors(kit, seed):
    car = kit.box_car()
    trajectory = kit.wander(car, seed, steps=15, dt=1.3)
    times = np.sort(np.random.default_rng(seed).uniform(0, trajectory.t[-1], 200))
    played, motion = replay(car, trajectory), single_track_motion(car, trajectory, times)
    error = played.at(motion.times) - motion.states
    assert np.hypot(error[:, 0], error[:, 1]).max() <= played.position_error + motion.position_error.max()
    assert np.abs(error[:, 2]).max() <= played.heading_error + motion.heading_error.max()
    assert np.abs(error[:, 3:]).max() < 1e-12
    assert motion.position_error.max() < 1e-8


def test_extrapolation_agrees_with_quadrature(kit):
    car = kit.box_car()
    trajectory = kit.wander(car, 7)
    times = np.linspace(0, trajectory.t[-1], 33)
    exact, general = single_track_motion(car, trajectory, times), general_motion(car, trajectory, times)
    error = np.abs(exact.states - general.states).max(axis=0)
    assert (error[:2] <= general.position_error.max()).all()
    assert error[2] <= general.heading_error.max() + 1e-13
    assert general.position_error.max() < 1e-8


@pytest.mark.parametrize(("duration", "delta"), [(1e9, 0.1), (1.0, 1.55)])
def test_what_cannot_be_followed_is_said(kit, duration, delta):
    states = np.zeros((2, 5))
    states[0, 3:] = 1.0, delta
    with pytest.raises(IntegrationError):
        single_track_motion(kit.box_car(), Trajectory([0, duration], states, [[0, 0]]), np.zeros(1))


@pytest.mark.parametrize(("count", "slack"), [(6, 2.0), (60, 0.04)])
def test_lemma_bounds_every_vertex_between_its_times(kit, count, slack):
    """The lower bound of n.p on each interval, against dense samples; the slack falls with h squared."""
    car = kit.box_car()
    trajectory = kit.wander(car, 11)
    cuts = np.linspace(0, trajectory.t[-1], count + 1)
    lemma = Lemma.of(car, trajectory, cuts)
    times = np.linspace(0, trajectory.t[-1], 60 * 40 + 1)
    moved = transform(car.parts[0].polygon.vertices, replay(car, trajectory).at(times)[:, :3])
    for angle in np.linspace(0, 6, 9):
        normal = np.array([np.cos(angle), np.sin(angle)])
        bound = lemma.lowest(0, cuts, np.tile(normal, (count, 1)))
        lowest = (moved @ normal).min(axis=1)[:-1].reshape(count, -1).min(axis=1)
        assert (bound <= lowest).all()
        assert (bound >= lowest - slack).all()


def test_a_trailer_is_judged_in_its_own_frame(kit):
    car = Trailer()
    start = np.array([0, 0, 0, 0, 0, 0.3])
    trajectory = kit.drive(car, np.arange(7.0), [[1, 0.3], [0, 0], [-1, -0.3], [-1, -0.3], [0, 0.3], [1, 0]], start)
    wall = [(-9, -4.5), (3, -4.5), (3, -3.4), (-9, -3.4)]
    scenario = kit.scene(trajectory, [wall, [(9, 9), (10, 9), (10, 10)]], start=start[:5])
    series = minimum_clearance(scenario, car, trajectory, dt=1e-3)
    assert series.part[series.worst] == "trailer"
    assert series.minimum > 0.1
    certificate = verify(scenario, car, trajectory, margin=0.1)
    assert certificate.certified, certificate.summary()
    assert series.minimum - 2e-3 <= certificate.clearance <= series.minimum
    assert check_certificate(scenario, car, trajectory, certificate).reasons == ()
    deeper = scenario.with_(obstacles=(Obstacle("w", np.add(wall, [0, series.minimum + 0.05])),))
    witness = verify(deeper, car, trajectory).witness
    assert witness.part == "trailer"
    assert witness.clearance == pytest.approx(-0.05, abs=2e-5)
    assert not check_certificate(deeper, car, trajectory, certificate).ok


def test_a_proof_is_not_cut_where_others_are(kit):
    """A small body in an arc bulges as far as the lemma allows, so that at the middle the lemma gives less than without
    a cut there: the wall's one interval must be evaluated whole, though another proof has cuts."""
    tiny = kit.box_car(length=2e-4, width=2e-4, overhang=1e-4)
    steering = np.arctan(0.2 * tiny.wheelbase)
    trajectory = kit.drive(tiny, [0, 1], [[0, 0]], start=(0, 0, -0.1, 1, steering))
    dip = replay(tiny, trajectory).at(np.array([0.5]))[0, 1]
    scenario = kit.scene(
        trajectory,
        [[(0.4, 1), (0.45, dip + 0.01), (0.55, dip + 0.01), (0.6, 1)]],
        workspace=ConvexPolygon.rectangle(-1, 3, -2, 2),
    )
    certificate = verify(scenario, tiny, trajectory)
    assert certificate.certified, certificate.summary()
    cuts, A, b = certificate.pairs[0].t, scenario.workspace.A, scenario.workspace.b
    low = next(proof for proof in certificate.workspace if A[proof.edge, 1] < -0.5)
    finer = Lemma.of(tiny, trajectory, cuts).lowest(0, cuts, np.tile(-A[low.edge], (cuts.size - 1, 1))) + b[low.edge]
    assert low.clearance.size == 1
    assert finer.min() < low.clearance[0]
    assert check_certificate(scenario, tiny, trajectory, certificate).reasons == ()
