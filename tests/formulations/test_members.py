"""Every member of the family: names, counts, derivatives, and exactness against shapely's distance."""

import casadi as ca
import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.formulations import FORMULATIONS, SeparatingLine, SweptLine, UnitNormalLine, formulation
from tightspot.geometry import ConvexPolygon
from tightspot.solvers import Ipopt, Nlp

MEMBERS = [member() for member in FORMULATIONS.values()]
each_member = pytest.mark.parametrize("member", MEMBERS, ids=lambda member: member.name)

CAR = ConvexPolygon.rectangle(-0.9, 3.7, -1.0, 1.0)
TRIANGLE = ConvexPolygon.from_vertices([(4.5, 0.5), (7.0, -1.0), (6.5, 3.0)])
PENTAGON = ConvexPolygon.from_vertices([(-3, -4), (0, -5), (2, -4), (1.5, -2.5), (-2, -2.2)])


@pytest.mark.parametrize(
    "name", [*FORMULATIONS, "SeparatingLine", "unit_normal_line", "Swept Line", "SWEPT-LINE"]
)
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


@each_member
def test_members_state_their_facts(member):
    assert FORMULATIONS[member.name] is type(member)
    assert member.holds in ("knots", "interval")
    assert member.is_exact
    assert member.expresses_margin
    assert member.equation
    assert member == type(member)(), "members are values"


def test_only_a_free_normal_needs_a_smallest_margin():
    """At margin 0 the rows of (17) hold for lam = 0 whatever the polygons do."""
    assert SeparatingLine.smallest_margin > 0
    assert UnitNormalLine.smallest_margin == SweptLine.smallest_margin == 0


def test_the_vacuous_point_of_a_free_normal_is_shut_out_by_the_smallest_margin(evaluator):
    rows = evaluator(SeparatingLine(), 4, 4, 1)
    overlapping = (CAR, ConvexPolygon.rectangle(0, 1, 0, 1), np.zeros((1, 3)))
    nothing = np.zeros(3)
    assert rows.violation(nothing, *overlapping, np.zeros(1)) == 0.0
    assert rows.violation(nothing, *overlapping, np.array([SeparatingLine.smallest_margin])) > 4e-4


@pytest.mark.parametrize(
    ("member", "variables", "rows", "poses"),
    [
        (SeparatingLine(), 3, lambda n_body, n_obstacle: n_body + n_obstacle + 1, 1),
        (UnitNormalLine(), 2, lambda n_body, n_obstacle: n_body + n_obstacle, 1),
        (SweptLine(), 2, lambda n_body, n_obstacle: 3 * n_body + n_obstacle, 3),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
@pytest.mark.parametrize(("n_body", "n_obstacle"), [(4, 4), (3, 5), (6, 3)])
def test_variables_and_rows_are_as_many_as_the_design_says(
    evaluator, member, variables, rows, poses, n_body, n_obstacle
):
    built = evaluator(member, n_body, n_obstacle, poses)
    assert built.lower.size == built.upper.size == built.auxiliary.numel() == variables
    assert built.expression.numel() == built.lbg.size == built.ubg.size == rows(n_body, n_obstacle)
    assert (built.lbg <= built.ubg).all()


@each_member
def test_derivatives_match_central_differences(evaluator, member):
    rng = np.random.default_rng(1)
    built = evaluator(member, 4, 3, 1 if member.holds == "knots" else 3)
    poses_symbol, margins_symbol = built.parameters[-2:]
    z = ca.vertcat(built.auxiliary, ca.vec(poses_symbol), margins_symbol)
    others = built.parameters[:-2]
    g = ca.Function("g", [z, *others], [built.expression])
    J = ca.Function("J", [z, *others], [ca.jacobian(built.expression, z)])
    H = [
        ca.Function("H", [z, *others], [ca.hessian(row, z)[0]]) for row in ca.vertsplit(built.expression)[::3]
    ]
    numbers = built.arguments(CAR, TRIANGLE, None, None)[:-2]
    for _ in range(5):
        point, step = rng.normal(size=z.numel()), 1e-5
        ends = [(point + step * e, point - step * e) for e in np.eye(z.numel())]
        numeric = np.column_stack(
            [np.array(g(up, *numbers) - g(down, *numbers)).ravel() / (2 * step) for up, down in ends]
        )
        np.testing.assert_allclose(np.array(J(point, *numbers)), numeric, atol=1e-8)
        slopes = np.array([np.array(J(up, *numbers) - J(down, *numbers)) / (2 * step) for up, down in ends])
        for index, hessian in enumerate(H):
            np.testing.assert_allclose(np.array(hessian(point, *numbers)), slopes[:, 3 * index], atol=1e-7)


@each_member
@pytest.mark.parametrize("obstacle", [TRIANGLE, PENTAGON], ids=["triangle", "pentagon"])
@pytest.mark.parametrize("pose", [(0.0, 0.0, 0.0), (-1.0, 2.0, 0.7), (9.0, -3.0, -2.5), (-3.0, 1.0, 1.6)])
def test_the_largest_margin_the_rows_allow_is_the_distance(evaluator, member, obstacle, pose):
    count = 1 if member.holds == "knots" else 3
    built = evaluator(member, len(CAR.vertices), len(obstacle.vertices), count)
    distance = CAR.transformed(*pose).to_shapely().distance(obstacle.to_shapely())
    assert distance > 0.1, "the case is meant to be disjoint"
    poses = np.tile(pose, (count, 1))
    assert largest_margin(built, CAR, obstacle, poses) == pytest.approx(distance, abs=1e-6)


def largest_margin(built, body, obstacle, poses):
    """Maximise the margin over the auxiliary variables, from the closed-form start with a worse margin."""
    margin = ca.SX.sym("margin")
    *symbols, poses_symbol, margins_symbol = built.parameters
    rows = ca.substitute(built.expression, margins_symbol, ca.repmat(margin, built.n_poses, 1))
    p = ca.vertcat(*(ca.vec(symbol) for symbol in [*symbols, poses_symbol]))
    numbers = built.arguments(body, obstacle, poses, None)[:-1]
    start = built.start(body, obstacle, poses) + 0.05  # not the solution itself
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
