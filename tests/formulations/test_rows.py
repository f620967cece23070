"""Disjoint polygons satisfy the rows, overlapping ones never an exact member's, and a swept line keeps its word."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from tightspot.formulations import (
    FORMULATIONS,
    DiscCover,
    FarkasDual,
    MinEdgeDistance,
    NormalisedFarkasDual,
    SeparatingLine,
    SharedVertexExclusion,
    SignedDistanceDual,
    SoftSignedDistance,
    SoftUnitNormalLine,
    SweptLine,
    SweptUnitNormalLine,
    TriangleArea,
    UnitNormalLine,
    VertexExclusion,
)
from tightspot.formulations.disc_cover import covering_discs
from tightspot.formulations.duals import support_multipliers
from tightspot.geometry import ConvexPolygon, clearance, transform
from tightspot.vehicles import CATALOGUE, vehicle

COPIES = [member(copies=4) for member in (FarkasDual, NormalisedFarkasDual, SignedDistanceDual)]
MEMBERS = [*(member() for member in FORMULATIONS.values()), *COPIES]


def label(member):
    return member.name + (f" x{member.copies}" if getattr(member, "copies", 1) > 1 else "")


LINES = (SeparatingLine, UnitNormalLine, SweptLine, SweptUnitNormalLine)  # half the margin on either side of the line
SCALELESS = (FarkasDual, SharedVertexExclusion)  # say "distance > margin" and approach it as multipliers grow
ATTAINING = [m for m in MEMBERS if m.expresses_margin and not isinstance(m, SCALELESS)]
EXACT = [m for m in MEMBERS if m.is_exact]
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
    return ConvexPolygon.from_vertices(np.column_stack([semi[0] * np.cos(angles), semi[1] * np.sin(angles)]) + centre)


def count_of_poses(member):
    return 1 if member.holds == "knots" else 3


def build(evaluator, member, body, obstacle, n_poses=1):
    return evaluator(member, body, len(obstacle.vertices), n_poses)


@pytest.mark.parametrize("member", ATTAINING, ids=label)
@settings(max_examples=30)
@given(body=polygons(), obstacle=polygons(spread=6), pose=poses)
def test_the_closed_form_start_is_feasible_with_the_clearance_as_margin(evaluator, member, body, obstacle, pose):
    gap = float(clearance(transform(body.vertices, pose), obstacle.vertices))
    assume(gap > 1e-6)
    n_poses = count_of_poses(member)
    rows = build(evaluator, member, body, obstacle, n_poses)
    at_rest = np.tile(pose, (n_poses, 1))
    start = rows.start(obstacle, at_rest)
    assert rows.violation(start, obstacle, at_rest, np.full(n_poses, gap)) < 1e-9
    short = 0.005 if isinstance(member, LINES) else 0.01
    assert rows.violation(start, obstacle, at_rest, np.full(n_poses, gap + 0.01)) == pytest.approx(short, abs=1e-6)


@pytest.mark.parametrize("member", [FarkasDual(), SharedVertexExclusion(), VertexExclusion()], ids=label)
@settings(max_examples=30)
@given(body=polygons(), obstacle=polygons(spread=6), pose=poses)
def test_without_a_scale_the_start_is_feasible_with_half_the_clearance(evaluator, member, body, obstacle, pose):
    gap = float(clearance(transform(body.vertices, pose), obstacle.vertices))
    assume(gap > 1e-6)
    rows = build(evaluator, member, body, obstacle)
    start = rows.start(obstacle, pose[None])
    assert rows.violation(start, obstacle, pose[None], np.array([gap / 2 - 1e-8])) < 1e-9


@pytest.mark.parametrize("member", EXACT, ids=label)
@settings(max_examples=25)
@given(body=polygons(), obstacle=polygons(spread=3), pose=poses)
def test_overlapping_polygons_leave_no_feasible_point(evaluator, line_auxiliary, member, body, obstacle, pose):
    """For every direction and length of the normal, with the variables that then serve the rows best."""
    pose[:2] /= 3
    V = transform(body.vertices, pose)
    depth = -float(clearance(V, obstacle.vertices))
    assume(depth > 1e-6)
    margin = max(member.smallest_margin, 1e-9)
    n_poses = count_of_poses(member)
    rows = build(evaluator, member, body, obstacle, n_poses)
    at_rest, margins = np.tile(pose, (n_poses, 1)), np.full(n_poses, margin)
    unit = isinstance(member, UnitNormalLine | SweptUnitNormalLine | MinEdgeDistance)
    for direction in np.linspace(0, 2 * np.pi, 8, endpoint=False):
        normal = np.array([np.cos(direction), np.sin(direction)])
        gap = (V @ normal).min() - (obstacle.vertices @ normal).max()
        assert gap <= -depth + 1e-9, "no direction shows less overlap than the penetration depth"
        for length in (1.0,) if unit else (1.0, 0.3, 0.0):
            aux = line_auxiliary(member, body, obstacle, pose, direction, length)
            violation = rows.violation(aux, obstacle, at_rest, margins)
            if isinstance(member, LINES):
                assert violation == pytest.approx((margin - length * gap) / 2, abs=1e-9)
            elif isinstance(member, MinEdgeDistance):
                assert violation == pytest.approx(margin + depth, abs=1e-9)
            else:
                assert violation >= margin / 2 - length * gap - 1e-9
            assert violation > 0


BAR = ConvexPolygon.rectangle(-2, 2, -0.4, 0.4)


@pytest.mark.parametrize("angle", [np.pi / 2, 1.2])
@pytest.mark.parametrize("member", MEMBERS, ids=label)
def test_two_crossing_bars_are_accepted_by_no_exact_member(evaluator, line_auxiliary, member, angle):
    """A plus sign: no vertex of either bar is in the other, yet they overlap (NOTES.md, erratum 1)."""
    n_poses = count_of_poses(member)
    rows = build(evaluator, member, BAR, BAR, n_poses)
    crossing, margins = np.tile([0, 0, angle], (n_poses, 1)), np.full(n_poses, 0.05)
    if isinstance(member, VertexExclusion | TriangleArea):
        assert rows.violation(rows.start(BAR, crossing), BAR, crossing, margins) == 0
    elif isinstance(member, DiscCover):
        assert rows.violation(np.zeros(0), BAR, crossing, margins) > 0.3
    else:
        assert member.is_exact
        for direction in np.linspace(0, 2 * np.pi, 90):
            aux = line_auxiliary(member, BAR, BAR, crossing[0], direction)
            assert rows.violation(aux, BAR, crossing, margins) > 0.1


@given(polygon=polygons(spread=5), direction=angle)
def test_support_multipliers_prove_the_support_value(polygon, direction):
    n = np.array([np.cos(direction), np.sin(direction)])
    (lam,) = support_multipliers(polygon, n[None])
    assert (lam >= 0).all()
    assert np.count_nonzero(lam) <= 2
    np.testing.assert_allclose(polygon.A.T @ lam, n, atol=1e-9)
    assert polygon.b @ lam == pytest.approx((polygon.vertices @ n).max(), abs=1e-7)


@given(body=polygons(), obstacle=polygons(spread=5), pose=poses)
def test_edge_distance_has_the_sign_of_the_clearance_and_is_never_more(evaluator, body, obstacle, pose):
    rows = build(evaluator, MinEdgeDistance(), body, obstacle)
    (value,) = rows.values(np.zeros(0), obstacle, pose[None], np.zeros(1))
    gap = float(clearance(transform(body.vertices, pose), obstacle.vertices))
    assert value <= gap + 1e-9
    assert (value > 1e-9) == (gap > 1e-9)
    if gap < 0:
        assert value == pytest.approx(gap, abs=1e-9)


@given(body=polygons(), obstacle=polygons(spread=5), pose=poses)
def test_triangle_areas_tell_vertices_outside(evaluator, body, obstacle, pose):
    values = build(evaluator, TriangleArea(), body, obstacle).values(np.zeros(0), obstacle, pose[None], np.zeros(1))
    moved = body.transformed(*pose)
    outside = [(moved.A @ q - moved.b).max() for q in obstacle.vertices]
    outside += [(obstacle.A @ q - obstacle.b).max() for q in moved.vertices]
    for value, distance in zip(values, outside, strict=True):
        assert value >= -1e-9
        if abs(distance) > 1e-6:
            assert (value > 1e-9) == (distance > 0)


@settings(max_examples=25)
@given(body=polygons(), obstacle=polygons(spread=6), pose=poses, cell=st.sampled_from([0.3, 0.8, 9.0]))
def test_discs_keep_the_body_away_and_cost_no_more_than_their_excess(evaluator, body, obstacle, pose, cell):
    rows = build(evaluator, DiscCover(cell=cell), body, obstacle)
    promised = float(rows.values(np.zeros(0), obstacle, pose[None], np.zeros(1)).min())
    gap = float(clearance(transform(body.vertices, pose), obstacle.vertices))
    assert promised <= max(gap, 0.0) + 1e-6
    if gap > 0:
        assert promised >= gap - covering_discs(body, cell).excess - 1e-6


@given(
    body=polygons(), cell=st.sampled_from([0.3, 0.8, 9.0]), weights=st.lists(st.floats(0.01, 1), min_size=6, max_size=6)
)
def test_discs_cover_the_body(body, cell, weights):
    discs = covering_discs(body, cell)
    weights = np.array(weights[: len(body.vertices)])
    points = np.vstack([weights @ body.vertices / weights.sum(), body.vertices])
    distances = np.hypot(*(points[:, None] - discs.centres).transpose(2, 0, 1))
    assert (distances <= discs.radii + 1e-6).any(axis=1).all()


@pytest.mark.parametrize("member", [SoftSignedDistance(), SoftUnitNormalLine()])
@given(body=polygons(), obstacle=polygons(spread=3), pose=poses)
def test_the_slack_of_the_soft_form_starts_at_the_penetration_depth(evaluator, member, body, obstacle, pose):
    pose[:2] /= 2
    rows = build(evaluator, member, body, obstacle)
    start = rows.start(obstacle, pose[None])
    depth = max(0.0, -float(clearance(transform(body.vertices, pose), obstacle.vertices)))
    assert member.penalty(start) == pytest.approx(depth, abs=1e-9)
    assert rows.violation(start, obstacle, pose[None], np.zeros(1)) < 1e-9
    start[-1] -= 0.01
    assert rows.violation(start, obstacle, pose[None], np.zeros(1)) > (0.0099 if depth > 0 else -1)


@given(body=polygons(), obstacle=polygons(spread=6), pose=poses, aux=st.tuples(angle, coordinate).map(np.array))
def test_a_feasible_unit_normal_promises_the_margin(evaluator, body, obstacle, pose, aux):
    """Soundness: whatever margin any line satisfies, the distance is at least that."""
    rows = build(evaluator, UnitNormalLine(), body, obstacle, 1)
    values = rows.values(aux, obstacle, pose[None], np.zeros(1))
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
    aux = rows.start(obstacle, at)
    middle = state + np.r_[0, 0, 0, control] * duration / 2
    bound = car.acceleration_bound(0, part.polygon.radius, middle, control, duration / 2, np)
    cover = bound * (duration / intervals) ** 2 / 8
    demanded = np.full(intervals + 1, cover)
    values = rows.values(aux, obstacle, at, demanded)
    n_obstacle = len(obstacle.vertices)
    margin = 2 * min(-values[:n_obstacle].max(), values[n_obstacle:-1].min())
    assert rows.violation(aux, obstacle, at, demanded + margin) < 1e-9
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
