"""Every member of the family: names, counts, derivatives, and exactness against shapely's distance."""

import casadi as ca
import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.formulations import (
    FORMULATIONS,
    DiscCover,
    FarkasDual,
    MinEdgeDistance,
    NormalisedFarkasDual,
    SeparatingGap,
    SeparatingLine,
    SharedVertexExclusion,
    SignedDistanceDual,
    SoftSignedDistance,
    SoftSweptUnitNormalLine,
    SoftUnitNormalLine,
    SweptLine,
    SweptUnitNormalLine,
    TriangleArea,
    UnitNormalLine,
    VertexExclusion,
    formulation,
)
from tightspot.geometry import ConvexPolygon
from tightspot.solvers import Ipopt, Nlp

SOFT = [SoftSignedDistance(), SoftUnitNormalLine(), SoftSweptUnitNormalLine()]
COPIES = [member(copies=4) for member in (FarkasDual, NormalisedFarkasDual, SignedDistanceDual)]
MEMBERS = [*(member() for member in FORMULATIONS.values()), *COPIES]


def label(member):
    return member.name + (f" x{member.copies}" if getattr(member, "copies", 1) > 1 else "")


each_member = pytest.mark.parametrize("member", MEMBERS, ids=label)
SCALELESS = (FarkasDual, SharedVertexExclusion)  # say "distance > margin" and approach it as multipliers grow
ATTAINING = [m for m in MEMBERS if m.expresses_margin and not isinstance(m, SCALELESS)]

CAR = ConvexPolygon.rectangle(-0.9, 3.7, -1.0, 1.0)
TRIANGLE = ConvexPolygon.from_vertices([(4.5, 0.5), (7.0, -1.0), (6.5, 3.0)])
PENTAGON = ConvexPolygon.from_vertices([(-3, -4), (0, -5), (2, -4), (1.5, -2.5), (-2, -2.2)])


@pytest.mark.parametrize("name", [*FORMULATIONS, "SeparatingLine", "unit_normal_line", "Swept Line", "SWEPT-LINE"])
def test_names_are_found_however_they_are_written(name):
    assert isinstance(formulation(name), tuple(FORMULATIONS.values()))


def test_each_name_gives_its_own_member():
    assert type(formulation("separating_line")) is SeparatingLine
    assert type(formulation("UnitNormalLine")) is UnitNormalLine
    assert type(formulation("swept line")) is SweptLine


def test_an_unknown_name_lists_the_members():
    with pytest.raises(
        InputError, match=r"formulation: 'OBCA' is not known; choose one of separating-line, .*swept-line"
    ):
        formulation("OBCA")


NOT_EXACT = (VertexExclusion, TriangleArea, DiscCover)


@pytest.mark.parametrize("member", [*MEMBERS, *SOFT], ids=label)
def test_members_state_their_facts(member):
    assert member.holds in ("knots", "interval")
    assert member.is_exact is (type(member) not in (*NOT_EXACT, *map(type, SOFT)))
    assert not member.expresses_margin or member.is_exact
    assert member.equation
    assert (FORMULATIONS.get(member.name) is type(member)) is (member not in SOFT)
    if getattr(member, "copies", 1) == 1:
        assert member == type(member)(), "members are values"


@pytest.mark.parametrize("member", [FarkasDual, NormalisedFarkasDual, SignedDistanceDual])
def test_at_least_one_copy(member):
    with pytest.raises(InputError, match="copies: 0 is too few"):
        member(copies=0)


def test_rows_that_nothing_satisfies_at_margin_0_need_a_smallest_margin():
    """At margin 0 the rows of these members hold for lam = 0, or everywhere, whatever the polygons do."""
    vacuous = {SeparatingLine, SweptLine, SeparatingGap, NormalisedFarkasDual, SignedDistanceDual, TriangleArea}
    assert {member for member in FORMULATIONS.values() if member.smallest_margin > 0} == vacuous


@pytest.mark.parametrize(
    "member", [SeparatingLine(), SeparatingGap(), NormalisedFarkasDual(), SignedDistanceDual()], ids=label
)
def test_the_vacuous_point_of_a_free_normal_is_shut_out_by_the_smallest_margin(evaluator, member):
    rows = evaluator(member, CAR, 4, 1)
    overlapping = (ConvexPolygon.rectangle(0, 1, 0, 1), np.zeros((1, 3)))
    nothing = np.zeros(rows.lower.size)
    assert rows.violation(nothing, *overlapping, np.zeros(1)) == 0.0
    assert rows.violation(nothing, *overlapping, np.array([member.smallest_margin])) > 4e-4


@pytest.mark.parametrize("member", [FarkasDual(), VertexExclusion(), SharedVertexExclusion()], ids=label)
def test_multipliers_without_a_scale_may_not_vanish(evaluator, member):
    rows = evaluator(member, CAR, 3, 1)
    nothing = np.zeros(rows.lower.size)
    assert rows.violation(nothing, TRIANGLE, np.zeros((1, 3)), np.zeros(1)) == pytest.approx(1e-4)


SIZES = [
    (SeparatingLine(), lambda B, O: (3, B + O + 1)),
    (UnitNormalLine(), lambda B, O: (2, B + O)),
    (SweptLine(), lambda B, O: (3, 3 * B + O + 1)),
    (SweptUnitNormalLine(), lambda B, O: (2, 3 * B + O)),
    (SeparatingGap(), lambda B, O: (4, B + O + 2)),
    (VertexExclusion(), lambda B, O: (2 * B * O, B + O)),
    (SharedVertexExclusion(), lambda B, O: (B + O, B + O)),
    *((FarkasDual(copies=n), lambda B, O, n=n: (n * (B + O), 3 * n)) for n in (1, 4)),
    *((NormalisedFarkasDual(copies=n), lambda B, O, n=n: (n * (B + O), 4 * n)) for n in (1, 4)),
    *((SignedDistanceDual(copies=n), lambda B, O, n=n: (n * (B + O), 4 * n)) for n in (1, 4)),
    (MinEdgeDistance(), lambda B, O: (0, 1)),
    (TriangleArea(), lambda B, O: (0, B + O)),
    (SoftSignedDistance(), lambda B, O: (B + O + 1, 4)),
    (SoftUnitNormalLine(), lambda B, O: (3, B + O + 1)),
    (SoftSweptUnitNormalLine(), lambda B, O: (3, 3 * B + O + 1)),
]


@pytest.mark.parametrize(("member", "size"), SIZES, ids=[label(member) for member, _ in SIZES])
@pytest.mark.parametrize(("n_body", "n_obstacle"), [(4, 4), (3, 5), (6, 3)])
def test_variables_and_rows_are_as_many_as_the_pages_say(evaluator, member, size, n_body, n_obstacle):
    angles = 2 * np.pi * np.arange(n_body) / n_body
    body = ConvexPolygon.from_vertices(np.column_stack([np.cos(angles), np.sin(angles)]))
    built = evaluator(member, body, n_obstacle, 3 if member.holds == "interval" else 1)
    variables, rows = size(n_body, n_obstacle)
    assert built.lower.size == built.upper.size == built.auxiliary.numel() == variables
    assert built.expression.numel() == built.lbg.size == built.ubg.size == rows
    assert (built.lbg <= built.ubg).all()


@pytest.mark.parametrize("member", [*MEMBERS, *SOFT], ids=label)
def test_derivatives_match_central_differences(evaluator, member):
    rng = np.random.default_rng(1)
    built = evaluator(member, CAR, 3, 1 if member.holds == "knots" else 3)
    poses_symbol, margins_symbol = built.parameters[-2:]
    z = ca.vertcat(built.auxiliary, ca.vec(poses_symbol), margins_symbol)
    others = built.parameters[:-2]
    g = ca.Function("g", [z, *others], [built.expression])
    J = ca.Function("J", [z, *others], [ca.jacobian(built.expression, z)])
    H = [ca.Function("H", [z, *others], [ca.hessian(row, z)[0]]) for row in ca.vertsplit(built.expression)[::3]]
    numbers = built.arguments(TRIANGLE, None, None)[:-2]
    for _ in range(5):
        point, step = rng.normal(size=z.numel()), 1e-5
        ends = [(point + step * e, point - step * e) for e in np.eye(z.numel())]
        numeric = np.column_stack(
            [np.array(g(up, *numbers) - g(down, *numbers)).ravel() / (2 * step) for up, down in ends]
        )
        np.testing.assert_allclose(np.array(J(point, *numbers)), numeric, atol=1e-7)
        slopes = np.array([np.array(J(up, *numbers) - J(down, *numbers)) / (2 * step) for up, down in ends])
        for index, hessian in enumerate(H):
            np.testing.assert_allclose(np.array(hessian(point, *numbers)), slopes[:, 3 * index], atol=1e-6)


@pytest.mark.parametrize("member", ATTAINING, ids=label)
@pytest.mark.parametrize("obstacle", [TRIANGLE, PENTAGON], ids=["triangle", "pentagon"])
@pytest.mark.parametrize("pose", [(0.0, 0.0, 0.0), (-1.0, 2.0, 0.7), (9.0, -3.0, -2.5), (-3.0, 1.0, 1.6)])
def test_the_largest_margin_the_rows_allow_is_the_distance(evaluator, member, obstacle, pose):
    count = 1 if member.holds == "knots" else 3
    built = evaluator(member, CAR, len(obstacle.vertices), count)
    distance = CAR.transformed(*pose).to_shapely().distance(obstacle.to_shapely())
    assert distance > 0.1, "the case is meant to be disjoint"
    poses = np.tile(pose, (count, 1))
    assert largest_margin(built, obstacle, poses) == pytest.approx(distance, abs=1e-6)


@pytest.mark.parametrize("member", [FarkasDual(), FarkasDual(copies=4), SharedVertexExclusion()], ids=label)
@pytest.mark.parametrize("obstacle", [TRIANGLE, PENTAGON], ids=["triangle", "pentagon"])
@pytest.mark.parametrize("pose", [(0.0, 0.0, 0.0), (-1.0, 2.0, 0.7), (9.0, -3.0, -2.5), (-3.0, 1.0, 1.6)])
def test_without_a_scale_every_margin_below_the_distance_is_allowed_and_none_above(
    evaluator, line_auxiliary, member, obstacle, pose
):
    """The best multipliers of a direction are its support multipliers, by duality; a larger scale changes no sign."""
    built = evaluator(member, CAR, len(obstacle.vertices), 1)
    distance = CAR.transformed(*pose).to_shapely().distance(obstacle.to_shapely())
    poses = np.array([pose])
    large = 1e4 * built.start(obstacle, poses)
    assert built.violation(large, obstacle, poses, np.array([distance - 1e-6])) < 1e-9
    for direction in np.linspace(0, 2 * np.pi, 180):
        aux = 1e4 * line_auxiliary(member, CAR, obstacle, poses[0], direction)
        assert built.violation(aux, obstacle, poses, np.array([distance + 1e-6])) > 1e-3


def largest_margin(built, obstacle, poses):
    """Maximise the margin over the auxiliary variables, from the closed-form start with a worse margin."""
    margin = ca.SX.sym("margin")
    *symbols, poses_symbol, margins_symbol = built.parameters
    rows = ca.substitute(built.expression, margins_symbol, ca.repmat(margin, built.n_poses, 1))
    p = ca.vertcat(*(ca.vec(symbol) for symbol in [*symbols, poses_symbol]))
    numbers = built.arguments(obstacle, poses, None)[:-1]
    start = built.start(obstacle, poses) + 0.05  # not the solution itself
    nlp = Nlp(
        ca.vertcat(built.auxiliary, margin),
        p,
        -margin,
        rows,
        np.r_[built.lower, -np.inf],
        np.r_[built.upper, np.inf],
        built.lbg,
        built.ubg,
        np.r_[start, 0.0],
        np.concatenate([np.ravel(number, "F") for number in numbers]),
        (),
        (),
    )
    report = Ipopt(tolerance=1e-10).solve(nlp)
    assert report.status.success, report
    return report.x[-1]
