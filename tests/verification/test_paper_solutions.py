"""The paper's Table II solved again, and what its solutions do between their samples.

The settings are those that reproduce the table: 20 steps, RK4 with 4 substeps, formulation (17) at the knots with a
gap of 2 mm, the recovered wheelbase. Each solution is found from nine sketched poses; the problem has many others.
"""

from typing import NamedTuple

import numpy as np
import pytest
import shapely

from tightspot.formulations import SeparatingLine
from tightspot.scenarios.library import builtin
from tightspot.solvers import Ipopt
from tightspot.trajectory import Trajectory
from tightspot.transcription import EnergyForm, Objective, Settings, TimeGrid, transcribe
from tightspot.vehicles import vehicle
from tightspot.verification import verify

CAR = vehicle("paper-recovered")
STEPS = 20
SETTINGS = Settings(
    objective=Objective(0.0095, (5.255 * STEPS, 2 * 5.255 * STEPS), EnergyForm.NORMALISED),
    formulation=SeparatingLine(),
    margin=2e-3,
    end_margin=2e-3,
    substeps=4,
    heading_limit=np.pi,
)


class Row(NamedTuple):
    """A row of the table as reproduced, a sketched path that leads there, and the depth between the samples, m."""

    scene: str
    objective: float
    final_time: float
    effort: float
    guessed_time: float
    sketch: list[tuple[float, float, float]]
    depth: float


OBLIQUE = [(1.41, 0, 0), (4.79, 0.04, 0.03), (8.85, 0.38, 0.15), (12.27, 1.15, 0.29), (13.88, 1.66, 0.33)]
OBLIQUE += [(13.11, 1.39, 0.35), (10.47, 0.21, 0.5), (7.37, -1.89, 0.68), (4.97, -4.04, 0.77)]
SHORTEST = [(1.07, 0.02, 0.04), (3.94, 0.47, 0.29), (7.09, 2.09, 0.66), (8.96, 3.93, 0.87), (9.38, 4.45, 0.9)]
SHORTEST += [(8.55, 3.34, 0.96), (7.11, 0.66, 1.21), (6.38, -2.76, 1.49), (6.3, -5.5, 1.57)]
SECOND = [(0.67, 0.01, 0.02), (2.76, 0.2, 0.18), (5.62, 1.17, 0.49), (7.93, 2.88, 0.77), (9.09, 4.17, 0.89)]
SECOND += [(9.32, 4.45, 0.9), (8.83, 3.82, 0.93), (7.4, 1.36, 1.17), (6.36, -3.52, 1.51)]
THIRD = [(0.39, 0, 0.01), (2.01, 0.1, 0.12), (4.7, 0.75, 0.36), (7.33, 2.2, 0.64), (9.02, 3.7, 0.8)]
THIRD += [(9.73, 4.45, 0.83), (9.82, 4.56, 0.83), (9.13, 3.75, 0.9), (6.86, -0.84, 1.32)]
LONGEST = [(-0.73, 0, -0.01), (-0.51, 0, 0), (2.11, 0.25, 0.19), (5.71, 1.47, 0.46), (8.4, 3.12, 0.62)]
LONGEST += [(9.8, 4.16, 0.65), (10.3, 4.54, 0.64), (10.74, 4.85, 0.6), (10.79, 4.88, 0.62)]
PARALLEL = [(1.79, -0.03, -0.03), (5.6, -0.25, -0.06), (9.69, -0.12, 0.18), (13.29, 1.62, 0.77)]
PARALLEL += [(14.71, 3.92, 1.25), (14.62, 3.64, 1.24), (13.3, 0.74, 1.06), (10.25, -2.99, 0.65), (6.39, -4.3, -0.01)]

ROWS = {
    "oblique 0.856": Row("oblique", 0.8561, 70.19, 0.0317, 70.0, OBLIQUE, 0.0),
    "vertical 0.942": Row("vertical", 0.942, 72.88, 0.033, 70.0, SHORTEST, 0.02),
    "vertical 1.012": Row("vertical", 1.0117, 80.28, 0.0363, 80.0, SECOND, 0.06),
    "vertical 1.190": Row("vertical", 1.1894, 97.18, 0.0439, 100.0, THIRD, 0.18),
    "vertical 1.907": Row("vertical", 1.9071, 171.31, 0.0498, 170.0, LONGEST, 0.25),
    "parallel 1.221": Row("parallel", 1.2208, 93.96, 0.0425, 90.0, PARALLEL, 0.6),
}


def guess_of(row):
    """Straight between the sketched poses, at rest."""
    scene, s = builtin(row.scene), np.linspace(0, 1, STEPS + 1)
    poses = np.vstack([scene.start[:3], row.sketch, scene.goal[:3]])
    states = np.zeros((STEPS + 1, 5))
    states[:, :3] = np.column_stack([np.interp(s, np.linspace(0, 1, len(poses)), column) for column in poses.T])
    return Trajectory(row.guessed_time * s, states, np.zeros((STEPS, 2)))


@pytest.fixture(scope="module", params=ROWS, ids=str)
def solved(request):
    row = ROWS[request.param]
    scene = builtin(row.scene)
    problem = transcribe(scene, CAR, guess_of(row), SETTINGS, grid=TimeGrid.uniform(STEPS))
    report = Ipopt(time_limit=30.0).solve(problem.nlp)
    assert report.status.success, report.status.sentence
    return row, scene, report, problem.trajectory(report.x)


def replayed(trajectory, dt=1e-2):
    """Times and poses of eq. (23), integrated here and nowhere else."""
    times, poses, state = [0.0], [trajectory.states[0, :3]], np.array(trajectory.states[0])

    def slope(state, control):
        _, _, theta, v, delta = state
        return np.array([v * np.cos(theta), v * np.sin(theta), v * np.tan(delta) / 4.628, *control])

    for control, t, end in zip(trajectory.inputs, trajectory.t[:-1], trajectory.t[1:], strict=True):
        count = int(np.ceil((end - t) / dt))
        h = (end - t) / count
        for k in range(count):
            k1 = slope(state, control)
            k2 = slope(state + h / 2 * k1, control)
            k3 = slope(state + h / 2 * k2, control)
            k4 = slope(state + h * k3, control)
            state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
            times.append(t + (k + 1) * h)
            poses.append(state[:3])
    return np.array(times), np.array(poses)


def signed_distances(poses, obstacle):
    """Distance of the origin from the Minkowski difference's boundary, negative inside, by shapely."""
    x, y, theta = poses.T[:, :, None]
    bx, by = np.array([(-0.928, -1.0485), (3.7, -1.0485), (3.7, 1.0485), (-0.928, 1.0485)]).T
    body = np.stack([x + bx * np.cos(theta) - by * np.sin(theta), y + bx * np.sin(theta) + by * np.cos(theta)], axis=-1)
    differences = (obstacle[None, :, None, :] - body[:, None]).reshape(len(poses), -1, 2)
    hulls = shapely.convex_hull(shapely.multipoints(differences))
    origin = shapely.Point(0, 0)
    inside = shapely.intersects(hulls, origin)
    return np.where(inside, -1.0, 1.0) * shapely.distance(shapely.boundary(hulls), origin)


def test_the_table_s_row_is_reproduced(solved):
    row, _, report, trajectory = solved
    assert report.objective == pytest.approx(row.objective, rel=2e-3)
    assert trajectory.duration == pytest.approx(row.final_time, rel=2e-3)
    assert (trajectory.inputs**2).sum() == pytest.approx(row.effort, rel=1e-2)
    assert report.violation < 1e-6


def test_no_knot_collides(solved):
    """What the formulation promises, and all that it promises."""
    _, scene, _, trajectory = solved
    for _, polygon in scene.obstacle_parts:
        assert signed_distances(trajectory.poses, polygon.vertices).min() >= 2e-3 - 1e-6


def test_the_judge_finds_when_which_parts_and_how_deep(solved):
    row, scene, _, trajectory = solved
    certificate = verify(scene, CAR, trajectory, margin=0.0)
    times, poses = replayed(trajectory)
    brute = {name: signed_distances(poses, polygon.vertices) for name, polygon in scene.obstacle_parts}
    witnesses = {witness.obstacle: witness for witness in certificate.witnesses if witness.obstacle != "workspace"}
    assert set(witnesses) == {name for name, distances in brute.items() if distances.min() < 0}
    for name, witness in witnesses.items():
        assert witness.kind == "collision"
        assert witness.part == "body"
        sampled = brute[name].min()
        assert sampled - 5e-3 <= witness.clearance <= sampled + 1e-6, "as deep as the samples, or between them"
        assert witness.clearance == pytest.approx(np.interp(witness.time, times, brute[name]), abs=5e-3)
        assert np.abs(trajectory.t - witness.time).min() > 0.1, "between the knots, where nobody looked"
    deepest = max((witness.penetration for witness in witnesses.values()), default=0.0)
    assert deepest == pytest.approx(row.depth, abs=0.01)
    assert certificate.certified == (not certificate.witnesses)
    if row.depth:
        assert not certificate.certified
