"""Whatever problem the stagewise solver is given, it ends in a status within its limits, and "solved" is no lie."""

from itertools import pairwise

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from tightspot.errors import InputError
from tightspot.formulations import SoftSweptUnitNormalLine, SoftUnitNormalLine, SweptUnitNormalLine, UnitNormalLine
from tightspot.geometry import ConvexPolygon, clearance, transform
from tightspot.guesses import LinearInterpolation
from tightspot.scenarios import Obstacle, Scenario
from tightspot.solvers import Stagewise
from tightspot.transcription import Objective, Settings, TimeGrid, stage_problem
from tightspot.vehicles import vehicle

CAR = vehicle("paper")
MARGIN = 0.02
MEMBERS = [UnitNormalLine(), SweptUnitNormalLine(), SoftUnitNormalLine(), SoftSweptUnitNormalLine()]
ITERATIONS = 200
FIELDS = (
    "states", "inputs", "lines", "widths", "start", "goal", "state_low", "state_high", "input_low", "input_high",
    "obstacle_vertices", "part_vertices", "part_radii", "pair_origins", "pair_sides", "wall_lines", "pair_demands",
    "wall_demands", "input_weights", "parameters", "pair_penalties", "penetrations",
)  # fmt: skip
hostile = st.sampled_from([np.nan, np.inf, -np.inf, 1e300, -1e300, 1e-300, 0.0, 1e9])
number = st.floats(-6, 12)
boxes = st.lists(st.tuples(number, number, st.floats(0.05, 4), st.floats(0.05, 4)), max_size=3)


@st.composite
def problems(draw):
    corners = draw(boxes)
    if corners and draw(st.booleans()):
        corners = [*corners, corners[0]]  # the same place twice
    goal = draw(st.sampled_from([(0.0, 0.0, 0.0), (9.0, 1.0, 0.0), (4.0, -2.0, 1.2), (60.0, 0.0, 0.0)]))
    scenario = Scenario(
        name="anything",
        workspace=ConvexPolygon.rectangle(-10, 25, -10, 10),
        obstacles=tuple(
            Obstacle(f"box {i}", ConvexPolygon.rectangle(x, x + w, y, y + h).vertices)
            for i, (x, y, w, h) in enumerate(corners)
        ),
        start=[0, 0, 0, 0, 0],
        goal=[*goal, 0, 0],
    )
    guess = LinearInterpolation().make(scenario, CAR, margin=0.0).trajectory
    weights = draw(st.sampled_from([(1.0, 1.0), (0.0, 1.0), (1.0, 0.0)]))
    member = draw(st.sampled_from(MEMBERS))
    options = Settings(Objective(weights[0], (weights[1], weights[1])), member, margin=MARGIN)
    return stage_problem(scenario, CAR, guess, options, grid=TimeGrid.uniform(draw(st.sampled_from([1, 2, 8]))))


def check(problem, report):
    """Limits are kept; a success is one by geometry alone and within the bounds."""
    assert report.iterations <= ITERATIONS
    assert report.status.sentence
    if not report.status.success:
        return
    assert report.violation <= 1e-6
    for values, low, high in (
        (report.states[1:-1], problem.state_low, problem.state_high),
        (report.inputs, problem.input_low, problem.input_high),
    ):
        assert (values >= low - 1e-6).all()
        assert (values <= high + 1e-6).all()
    np.testing.assert_allclose(report.states[[0, -1]], [problem.start, problem.goal], atol=1e-6)
    for index, (first, last) in enumerate(pairwise(problem.obstacle_first)):
        body = transform(problem.part_vertices, report.states[1:-1, :3])
        inner = clearance(body, problem.obstacle_vertices[first:last])
        mine = (problem.pairs[:, 2] == index) & (problem.pairs[:, 0] < problem.steps - 1)
        allowed = report.penetrations[mine]
        assert (allowed >= -1e-6).all()
        assert (inner >= MARGIN - allowed - 1e-6).all()


@settings(max_examples=40, deadline=None)
@given(problems())
def test_solved_means_solved(problem):
    check(problem, Stagewise(max_iterations=ITERATIONS, time_limit=5.0).solve_stages(problem))


@settings(max_examples=60, deadline=None)
@given(problems(), st.sampled_from(FIELDS), hostile, st.integers(0, 10**6))
def test_a_hostile_number_anywhere(problem, field, value, place):
    array = getattr(problem, field).copy()
    if not array.size:
        return
    array.flat[place % array.size] = value
    spoiled = problem.replaced(**{field: array})
    try:
        report = Stagewise(max_iterations=ITERATIONS, time_limit=5.0).solve_stages(spoiled)
    except InputError:
        return
    assert report.iterations <= ITERATIONS
    if report.status.success:
        assert np.isfinite(report.x).all()
        assert report.violation <= 1e-6
