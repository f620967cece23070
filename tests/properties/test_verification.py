"""Random motions in random scenes: what the judge says and what the checker accepts is true, says shapely."""

import copy
import json

import numpy as np
import shapely
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from tightspot.errors import InputError, PlanFileError
from tightspot.geometry import ConvexPolygon, transform
from tightspot.scenarios import Obstacle, Scenario
from tightspot.trajectory import Trajectory
from tightspot.vehicles import BodyPart, Limits, SingleTrack
from tightspot.verification import Plan, check_certificate, load_plan, replay, verify, verify_plan
from tightspot.verification.certificate import digest

LIMITS = Limits(speed=(-3, 3), acceleration=(-4, 4), steering=1.1, steering_rate=4)
PARTS = (
    (BodyPart("body", ConvexPolygon.rectangle(-1, 3.2, -0.9, 0.9)),),
    (
        BodyPart("rear", ConvexPolygon.rectangle(-1, 2, -0.9, 0.9)),
        BodyPart("left", ConvexPolygon.rectangle(2, 3.5, 0.5, 0.9)),
        BodyPart("right", ConvexPolygon.from_vertices([(2, -0.9), (3.5, -0.8), (2, -0.5)])),
    ),
)
seeds = st.integers(0, 2**32 - 1)


@st.composite
def motions(draw):
    """A vehicle and the replay of random inputs, with v and delta within bounds at every knot."""
    rng = np.random.default_rng(draw(seeds))
    car = SingleTrack("car", 2.4, draw(st.sampled_from(PARTS)), LIMITS)
    durations = rng.uniform(0.2, draw(st.sampled_from([0.6, 2.5])), draw(st.integers(1, 8)))
    state, inputs = rng.uniform([-3, -1], [3, 1]), []
    first = np.concatenate([rng.uniform(-3, 3, 3), state])
    for duration in durations:
        u = np.clip((rng.uniform([-3, -1.1], [3, 1.1]) - state) / duration, -4, 4)
        state, inputs = state + duration * u, [*inputs, u]
    t = np.concatenate([[0], np.cumsum(durations)])
    states = np.zeros((t.size, 5))
    states[0] = first
    trajectory = Trajectory(t, states, np.array(inputs))
    return car, Trajectory(t, replay(car, trajectory).knots, inputs)


@st.composite
def scenes(draw, trajectory):
    """Up to five random convex or L-shaped obstacles around the motion."""
    rng = np.random.default_rng(draw(seeds))
    low, high = trajectory.poses[:, :2].min(axis=0), trajectory.poses[:, :2].max(axis=0)
    obstacles = []
    for index in range(draw(st.integers(0, 5))):
        size, turn, where = rng.uniform(0.1, 2), rng.uniform(0, 6), rng.uniform(low - 6, high + 6)
        ring = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)] if rng.random() < 0.3 else rng.normal(size=(6, 2))
        if len(ring) == 6 and not isinstance(ring, list):
            ring = shapely.convex_hull(shapely.MultiPoint(ring)).exterior.coords[:-1]
        R = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        obstacles.append(Obstacle(f"o{index}", size * np.array(ring) @ R.T + where))
    room = draw(st.sampled_from([1.5, 40.0]))
    goal = trajectory.states[-1].copy()
    goal[2] = np.arctan2(np.sin(goal[2]), np.cos(goal[2]))
    W = ConvexPolygon.rectangle(low[0] - room, high[0] + room, low[1] - room, high[1] + room)
    return Scenario(name="random", workspace=W, obstacles=tuple(obstacles), start=trajectory.states[0], goal=goal)


def bodies(car, trajectory, times):
    """The parts as shapely polygons, shape (times, parts)."""
    poses = replay(car, trajectory, tolerance=1e-9).at(times)[:, :3]
    return np.stack([shapely.polygons(transform(part.polygon.vertices, poses)) for part in car.parts], axis=1)


def check_against_shapely(scenario, car, trajectory, certificate, dt=1e-3):
    """A certified motion keeps its proved clearance at every sample; a witness is true at its time."""
    obstacles = {name: polygon.to_shapely() for name, polygon in scenario.obstacle_parts}
    W = scenario.workspace.to_shapely()
    if certificate.check("obstacles").passed and obstacles:
        times = np.arange(0, trajectory.t[-1], dt)
        gap = shapely.distance(bodies(car, trajectory, times), shapely.unary_union([*obstacles.values()]))
        assert gap.min() >= certificate.clearance - 1e-6
        assert certificate.clearance >= certificate.margin
    if certificate.check("workspace").passed:
        times = np.arange(0, trajectory.t[-1], dt)
        assert shapely.contains(W.buffer(2e-6, join_style="mitre"), bodies(car, trajectory, times)).all()
    parts = {part.name: part.polygon for part in car.parts}
    for witness in certificate.witnesses:
        body = parts[witness.part].transformed(*witness.pose).to_shapely()
        if witness.obstacle == "workspace":
            assert body.difference(W).area > 0
        elif witness.kind == "collision":
            assert body.intersection(obstacles[witness.obstacle]).area > 0
        elif witness.kind == "margin":
            distance = body.distance(obstacles[witness.obstacle])
            assert abs(distance - max(0.0, witness.clearance)) < 1e-7
            assert distance < certificate.margin


@settings(max_examples=60)
@given(st.data(), motions(), st.sampled_from([0.0, 0.02, 0.3]))
def test_the_judge_is_right(data, motion, margin):
    car, trajectory = motion
    scenario = data.draw(scenes(trajectory))
    certificate = verify(scenario, car, trajectory, margin=margin)
    failed = {check.name for check in certificate.failed}
    assert failed <= {"obstacles", "workspace"}
    assert bool(failed) == bool(certificate.witnesses) == (not certificate.certified)
    check_against_shapely(scenario, car, trajectory, certificate)
    result = check_certificate(scenario, car, trajectory, certificate)
    assert result.ok == certificate.certified, result.reasons


def reference_plan():
    """A certified plan between two obstacles."""
    car = SingleTrack("car", 2.4, PARTS[1], LIMITS)
    t, inputs = np.arange(5.0), [[1, 0.5], [0, -0.4], [0, -0.4], [-1, 0.3]]
    states = np.zeros((5, 5))
    trajectory = Trajectory(t, replay(car, Trajectory(t, states, inputs)).knots, inputs)
    rings = ([(0, -2), (5, -2), (5, -1.0), (0, -1.0)], [(6.8, 1), (8, -1), (8, 3)])
    scenario = Scenario(
        name="reference",
        workspace=ConvexPolygon.rectangle(-5, 20, -9, 9),
        obstacles=tuple(Obstacle(f"o{i}", ring) for i, ring in enumerate(rings)),
        start=trajectory.states[0],
        goal=trajectory.states[-1],
    )
    return Plan(scenario, car, trajectory, verify(scenario, car, trajectory, margin=0.01), {})


PLAN = reference_plan()
DATA = PLAN.to_dict()


def number_paths(data, path=()):
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in items:
        if isinstance(value, float | int) and not isinstance(value, bool):
            yield (*path, key)
        else:
            yield from number_paths(value, (*path, key))


PATHS = [path for path in number_paths(DATA) if path[0] != "report"]


def altered(paths, change):
    data = copy.deepcopy(DATA)
    for path in paths:
        owner = data
        for key in path[:-1]:
            owner = owner[key]
        owner[path[-1]] = change(owner[path[-1]])
    return data


def upheld(plan):
    """The verdict; a motion that nobody can integrate has none."""
    try:
        return verify_plan(plan).upheld
    except InputError:
        return False


@settings(max_examples=150)
@given(
    st.lists(st.sampled_from(PATHS), min_size=1, max_size=3, unique=True),
    st.sampled_from([1e-7, 1e-5, 1e-3, 0.03, 0.3]),
    st.sampled_from([-1, 1]),
)
def test_whatever_the_checker_accepts_is_true(paths, size, sign):
    """Even if the digest is the forger's."""
    data = altered(paths, lambda value: value + sign * size)
    try:
        plan = Plan.from_dict(data)
        written = plan.to_dict()
        keys = ("scenario", "vehicle", "trajectory", "certificate")
        written["certificate"]["digest"] = digest(*(written[key] for key in keys))
        plan = Plan.from_dict(written)
    except InputError:
        return
    result = check_certificate(plan.scenario, plan.vehicle, plan.trajectory, plan.certificate)
    if result.ok:
        parts = plan.scenario, plan.vehicle, plan.trajectory
        truth = verify(*parts, margin=plan.certificate.margin)
        assert truth.certified
        assert plan.certificate.clearance <= min(truth.clearance + 2e-3, 0.3)
        check_against_shapely(*parts, plan.certificate, dt=1e-2)


@settings(max_examples=150)
@given(st.lists(st.sampled_from(PATHS), min_size=1, max_size=3, unique=True), st.floats() | st.none() | st.text())
@example([("trajectory", "inputs", "a", 0)], 1e300)
@example([("trajectory", "t", 4)], 1e18)
@example([("vehicle", "wheelbase")], 1e-300)
@example([("certificate", "margin")], -0.0)
def test_any_value_anywhere_is_refused_or_not_upheld(paths, value):
    data = altered(paths, lambda _: value)
    try:
        plan = Plan.from_dict(data)
    except PlanFileError:
        return
    assume(plan.to_dict() != DATA)
    assert not upheld(plan)


@settings(max_examples=150)
@given(st.integers(0, 10**6), st.binary(max_size=3), st.integers(0, 3))
def test_damaged_files_are_plan_file_errors_or_not_upheld(tmp_path_factory, at, inserted, dropped):
    text = json.dumps(DATA).encode()
    at %= len(text)
    path = tmp_path_factory.getbasetemp() / "damaged.json"
    path.write_bytes(text[:at] + inserted + text[at + dropped :])
    try:
        plan = load_plan(path)
    except PlanFileError:
        return
    same = {**plan.to_dict(), "report": {}} == DATA
    assert upheld(plan) == same
