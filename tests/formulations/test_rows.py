"""Disjoint polygons satisfy the rows, overlapping ones never do, and a swept line keeps its word."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from tightspot.formulations import FORMULATIONS, SeparatingLine, SweptLine, UnitNormalLine
from tightspot.geometry import ConvexPolygon, clearance, transform
from tightspot.vehicles import CATALOGUE, vehicle

MEMBERS = [member() for member in FORMULATIONS.values()]
each_member = pytest.mark.parametrize("member", MEMBERS, ids=lambda member: member.name)
CARS = [vehicle(name) for name in CATALOGUE]

angle = st.floats(-4, 4)
coordinate = st.floats(-6, 6)
poses = st.tuples(coordinate, coordinate, angle).map(np.array)


@st.composite
def polygons(draw, spread=0.0):
    """Three to six corners of an ellipse, its centre up to ``spread`` m away from the origin."""
    count = draw(st.integers(3, 6))
    gaps = np.array([draw(st.floats(0.2, 1.0)) for _ in range(count)])
    angles = 2 * np.pi * np.cumsum(gaps / gaps.sum()) + draw(angle)
    semi = draw(st.floats(0.3, 3.0)), draw(st.floats(0.3, 3.0))
    centre = [draw(st.floats(-spread, spread)), draw(st.floats(-spread, spread))]
    return ConvexPolygon.from_vertices(
        np.column_stack([semi[0] * np.cos(angles), semi[1] * np.sin(angles)]) + centre
    )


def count_of_poses(member):
    return 1 if member.holds == "knots" else 3


def build(evaluator, member, body, obstacle, n_poses):
    return evaluator(member, len(body.vertices), len(obstacle.vertices), n_poses)


@each_member
@given(body=polygons(), obstacle=polygons(spread=6), pose=poses)
def test_the_closed_form_start_is_feasible_with_the_clearance_as_margin(
    evaluator, member, body, obstacle, pose
):
    gap = float(clearance(transform(body.vertices, pose), obstacle.vertices))
    assume(gap > 1e-6)
    n_poses = count_of_poses(member)
    rows = build(evaluator, member, body, obstacle, n_poses)
    at_rest = np.tile(pose, (n_poses, 1))
    start = rows.start(body, obstacle, at_rest)
    assert rows.violation(start, body, obstacle, at_rest, np.full(n_poses, gap)) < 1e-9
    assert rows.violation(start, body, obstacle, at_rest, np.full(n_poses, gap + 0.01)) == pytest.approx(
        0.005, abs=1e-6
    )


@each_member
@given(body=polygons(), obstacle=polygons(spread=3), pose=poses)
def test_overlapping_polygons_leave_no_feasible_point(evaluator, member, body, obstacle, pose):
    """For every direction and length of the normal and the offset that serves the rows best."""
    pose[:2] /= 3
    V = transform(body.vertices, pose)
    depth = -float(clearance(V, obstacle.vertices))
    assume(depth > 1e-6)
    margin = max(member.smallest_margin, 1e-9)
    n_poses = count_of_poses(member)
    rows = build(evaluator, member, body, obstacle, n_poses)
    at_rest, margins = np.tile(pose, (n_poses, 1)), np.full(n_poses, margin)
    for direction in np.linspace(0, 2 * np.pi, 12, endpoint=False):
        normal = np.array([np.cos(direction), np.sin(direction)])
        gap = (V @ normal).min() - (obstacle.vertices @ normal).max()
        assert gap <= -depth + 1e-9, "no direction shows less overlap than the penetration depth"
        offset = ((V @ normal).min() + (obstacle.vertices @ normal).max()) / 2
        for length in (1.0, 0.3, 0.0) if isinstance(member, SeparatingLine) else (1.0,):
            aux = auxiliary(member, length * normal, direction, length * offset, pose)
            best = (margin - length * gap) / 2
            assert rows.violation(aux, body, obstacle, at_rest, margins) == pytest.approx(best, abs=1e-9)
            assert best > 0


def auxiliary(member, lam, direction, mu, pose):
    """The member's variables for the line ``lam.q = mu``."""
    if isinstance(member, SeparatingLine):
        return np.array([*lam, mu])
    if isinstance(member, UnitNormalLine):  # in the body's frame
        return np.array([direction - pose[2], mu - lam @ pose[:2]])
    return np.array([direction, mu])


@given(
    body=polygons(), obstacle=polygons(spread=6), pose=poses, aux=st.tuples(angle, coordinate).map(np.array)
)
def test_a_feasible_unit_normal_promises_the_margin(evaluator, body, obstacle, pose, aux):
    """Soundness: whatever margin any line satisfies, the distance is at least that."""
    rows = build(evaluator, UnitNormalLine(), body, obstacle, 1)
    values = rows.values(aux, body, obstacle, pose[None], np.zeros(1))
    n_body = len(body.vertices)
    margin = 2 * min(values[:n_body].min(), -values[n_body:].max())
    assert float(clearance(transform(body.vertices, pose), obstacle.vertices)) >= margin - 1e-9


@st.composite
def motions(draw):
    """A vehicle, a state within its limits, a constant input that keeps it there, and a duration."""
    car = draw(st.sampled_from(CARS))
    low, high = (bound[3:] for bound in car.state_bounds)
    ends = [np.array([draw(st.floats(a, b)) for a, b in zip(low, high, strict=True)]) for _ in range(2)]
    duration = draw(st.floats(0.1, 4.0))
    control = np.clip((ends[1] - ends[0]) / duration, *car.input_bounds)
    return car, np.r_[draw(poses), ends[0]], control, duration


def drive(car, state, control, times):
    """Poses at increasing times, by steps small enough to be called exact here."""
    poses, now, t = [], state, 0.0
    for time in times:
        count = max(1, int(np.ceil((time - t) / 0.01)))
        h = (time - t) / count
        for _ in range(count):
            k1 = np.array(car.dynamics(now, control, np))
            k2 = np.array(car.dynamics(now + h / 2 * k1, control, np))
            k3 = np.array(car.dynamics(now + h / 2 * k2, control, np))
            k4 = np.array(car.dynamics(now + h * k3, control, np))
            now = now + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        poses.append(now[:3])
        t = time
    return np.array(poses)


def swept_margin(evaluator, car, part, obstacle, motion, intervals):
    """The margin that the line started at the motion's poses promises on the interval, and the cover."""
    state, control, duration = motion
    at = drive(car, state, control, np.linspace(0, duration, intervals + 1))
    rows = build(evaluator, SweptLine(), part.polygon, obstacle, intervals + 1)
    aux = rows.start(part.polygon, obstacle, at)
    middle = state + np.r_[0, 0, 0, control] * duration / 2
    bound = car.acceleration_bound(0, part.polygon.radius, middle, control, duration / 2, np)
    cover = bound * (duration / intervals) ** 2 / 8
    demanded = np.full(intervals + 1, cover)
    values = rows.values(aux, part.polygon, obstacle, at, demanded)
    n_obstacle = len(obstacle.vertices)
    margin = 2 * min(-values[:n_obstacle].max(), values[n_obstacle:].min())
    assert rows.violation(aux, part.polygon, obstacle, at, demanded + margin) < 1e-9
    return margin, cover


@given(motion=motions(), obstacle=polygons(spread=8), intervals=st.integers(1, 3))
def test_a_swept_line_holds_between_its_poses(evaluator, motion, obstacle, intervals):
    car, state, control, duration = motion
    dense = drive(car, state, control, np.linspace(0, duration, 61))
    for part in car.parts:
        margin, _ = swept_margin(evaluator, car, part, obstacle, (state, control, duration), intervals)
        true = clearance(transform(part.polygon.vertices, dense), obstacle.vertices).min()
        assert true >= margin - 1e-7


def test_without_the_cover_a_swept_line_would_not_hold(evaluator):
    """A car that backs up and comes again stands at the same pose at both ends and is nearer in between."""
    car = vehicle("paper")
    (part,) = car.parts
    wall = ConvexPolygon.rectangle(-4.0, -1.5, -3.0, 3.0)
    motion = np.array([0, 0, 0, -0.5, 0.0]), np.array([0.5, 0.0]), 2.0
    dense = drive(car, *motion[:2], np.linspace(0, 2.0, 101))
    true = float(clearance(transform(part.polygon.vertices, dense), wall.vertices).min())
    margin, cover = swept_margin(evaluator, car, part, wall, motion, 1)
    assert margin + cover > true + 0.2, "the poses alone promise too much"
    assert margin <= true + 1e-9, "the cover takes it back"
    closer, _ = swept_margin(evaluator, car, part, wall, motion, 4)
    assert margin < closer <= true, "more poses promise more"
