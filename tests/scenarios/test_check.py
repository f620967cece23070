"""Start and goal of a vehicle among obstacles: what is refused, and whether the remedies cure."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from shapely import Polygon
from shapely.affinity import rotate, translate

from tightspot.errors import SceneError
from tightspot.scenarios import Scenario, check, clearance, clearances, workspace_excess
from tightspot.scenarios.clearances import surely_free
from tightspot.vehicles import vehicle

PAPER = vehicle("paper")  # body x in [-0.929, 3.699], y in [-1.0485, 1.0485]


def scene(obstacles: list[Any], start: tuple[float, ...] = (0, 0, 0), **more: Any) -> Scenario:
    names = ("x", "y", "theta", "v", "delta")
    return Scenario.from_dict(
        {
            "workspace": {"x": [-20, 20], "y": [-20, 20]},
            "obstacles": [{"name": f"o{i}", "vertices": ring} for i, ring in enumerate(obstacles)],
            "start": dict(zip(names, start, strict=False)),
            "goal": {"x": 10, "y": -10, "theta": 1.0},
            **more,
        }
    )


def box(x: float, y: float, width: float = 2.0, height: float = 2.0) -> list[list[float]]:
    return [[x, y], [x + width, y], [x + width, y + height], [x, y + height]]


def test_a_free_scene_passes():
    check(scene([box(-2, 3)]), PAPER, 0.05)
    check(scene([]), PAPER, 0.05)


def test_an_overlap_names_obstacle_depth_and_a_way_out(problems):
    found = problems(lambda: check(scene([box(5, 5), box(3.5, -1)]), PAPER, 0.05))
    assert list(found) == ["start"]
    assert "overlaps obstacle 'o1' by 0.199 m" in found["start"]
    assert "it would fit if moved by (-0.250, +0.000) m" in found["start"]


@pytest.mark.parametrize("margin", [0.05, 0.3])
@pytest.mark.parametrize("obstacles", [[box(3, 0.2)], [box(3, 0.2), box(-2, -3)], [box(-1.5, 0.9), box(1, -2.9)]])
def test_the_remedy_cures_all_obstacles_at_once(obstacles, margin):
    bad = scene(obstacles)
    with pytest.raises(SceneError) as caught:
        check(bad, PAPER, margin)
    step = re.search(r"moved by \((\S+), (\S+)\) m", caught.value.problems[0].message)
    assert step
    x, y = map(float, step.groups())
    check(bad.with_(start=bad.start + np.array([x, y, 0, 0, 0])), PAPER, margin)


def test_no_way_out_is_said(problems):
    found = problems(lambda: check(scene([box(-25, -25, 50, 50)]), PAPER, 0.05))
    assert "it fits nowhere in the workspace" in found["start"]


def test_too_near_tells_the_distance_and_the_margin_that_would_do(problems):
    tight = scene([box(3.709, -1)])
    found = problems(lambda: check(tight, PAPER, 0.05))
    assert "0.010 m from obstacle 'o0', nearer than the margin of 0.05 m" in found["start"]
    assert "or with a margin of 0.01 m" in found["start"]
    check(tight, PAPER, 0.0099)


def test_exactly_the_margin_is_enough():
    check(scene([box(4.0, -1)]), PAPER, 4.0 - 3.699)


def test_out_of_the_workspace_says_by_how_much_and_on_which_side(problems):
    found = problems(lambda: check(scene([], start=(16.5, 0, 0)), PAPER, 0.05))
    assert "0.199 m out of the workspace on its right (+x) side" in found["start"]
    assert "it would fit if moved by (-0.200, +0.000) m" in found["start"]
    slanted = [[-20, -20], [20, -20], [20, 1], [-20, 2]]
    found = problems(lambda: check(scene([], start=(0, 0.8, 0), workspace=slanted), PAPER, 0.05))
    assert "out of the workspace on its (0.02, 1.00) side" in found["start"]


def test_states_beyond_the_limits_are_refused(problems):
    found = problems(lambda: check(scene([], start=(0, 0, 0, 9, -0.9)), PAPER, 0.05))
    assert set(found) == {"start.v", "start.delta"}
    assert "9 m/s is outside the limits [-1.389, 1.389] of vehicle 'paper'" in found["start.v"]
    free = scene([]).with_(goal=np.array([10, -10, 1.0, np.nan, np.nan]))
    check(free, PAPER, 0.05)


def test_start_and_goal_are_judged_together(problems):
    both = scene([box(0, 0), box(9, -10)], start=(0, 0, 0, 5))
    assert set(problems(lambda: check(both, PAPER, 0.05))) == {"start", "start.v", "goal"}


@pytest.mark.parametrize("margin", [-0.1, np.nan, np.inf])
def test_a_margin_is_a_length(problems, margin):
    assert "margin" in problems(lambda: check(scene([]), PAPER, margin))


def test_parts_matter_not_their_bounding_box():
    tooth = [[[2.0, -0.1], [2.5, -0.1], [2.5, 0.1], [2.0, 0.1]]]
    between_the_tines = scene(tooth, vehicle="forklift", goal={"x": 8, "y": 8, "theta": 0})
    check(between_the_tines, vehicle("forklift"), 0.1)
    with pytest.raises(SceneError, match="left tine"):
        check(scene([box(2.5, 0.25)]), vehicle("forklift"), 0.05)


def test_clearances_agree_with_shapely():
    rng = np.random.default_rng(5)
    rings = [rng.uniform(-8, 8, 2) + rng.uniform(0.3, 1.5) * np.array(box(0, 0)) for _ in range(12)]
    scenario = scene([ring.tolist() for ring in rings])
    for _ in range(20):
        pose = np.array([*rng.uniform(-6, 6, 2), rng.uniform(-4, 4), 0, np.nan])
        footprint = Polygon(PAPER.parts[0].polygon.vertices)
        body = translate(rotate(footprint, pose[2], origin=(0, 0), use_radians=True), *pose[:2])
        distances = {f"o{i}": body.distance(Polygon(ring)) for i, ring in enumerate(rings)}
        found = clearances(scenario, PAPER, pose)
        assert len(found) == len(rings)
        for item in found:
            assert max(item.value, 0) == pytest.approx(distances[item.obstacle], abs=1e-9)
        assert clearance(scenario, PAPER, pose).value == min(item.value for item in found)
        inside = Polygon(scenario.workspace.vertices).contains(body)
        assert (workspace_excess(scenario, PAPER, pose)[0] <= 0) == inside


def test_moving_along_the_normal_by_the_depth_parts_body_and_obstacle():
    overlapping = scene([box(3.0, -1)])
    found = clearance(overlapping, PAPER, overlapping.start)
    x, y = -found.value * found.normal
    moved = overlapping.start + np.array([x, y, 0, 0, 0])
    assert clearance(overlapping, PAPER, moved).value == pytest.approx(0, abs=1e-12)


def test_without_obstacles_the_clearance_is_infinite():
    assert clearance(scene([]), PAPER, np.zeros(5)).value == np.inf


def test_a_crowd_of_obstacles_is_judged_quickly(problems):
    crowd = scene([box(0.003 * i, 0.5) for i in range(500)])
    assert len(problems(lambda: check(crowd, PAPER, 0.05))) >= 1


def test_within_reach_nothing_is_left_out():
    rng = np.random.default_rng(3)
    for _ in range(60):
        rings = [np.array(box(0, 0, *rng.uniform(0.2, 3, 2))) for _ in range(6)]
        turned = [rotate(Polygon(ring), rng.uniform(0, 360)) for ring in rings]
        placed = [translate(ring, *rng.uniform(-5, 7, 2)).exterior.coords[:4] for ring in turned]
        there = scene([list(map(list, ring)) for ring in placed], (0.0, 0.0, rng.uniform(-3, 3)))
        reach = float(rng.uniform(0.0, 1.0))
        everything = {found.obstacle: found.value for found in clearances(there, PAPER, there.start)}
        near = {found.obstacle: found.value for found in clearances(there, PAPER, there.start, reach=reach)}
        wanted = {name: value for name, value in everything.items() if value <= reach}
        assert wanted.items() <= near.items() <= everything.items()


@pytest.mark.parametrize("margin", [0.0, 0.05, 0.5])
@pytest.mark.parametrize("seed", range(60))
def test_what_is_seen_at_a_glance_to_be_free_is_free(seed, margin):
    rng = np.random.default_rng(seed)
    obstacles = [box(*rng.uniform(-8, 8, 2), *rng.uniform(0.5, 4, 2)) for _ in range(rng.integers(0, 4))]
    some = scene(obstacles)
    states = np.zeros((2, 5))
    states[:, :3] = rng.uniform([-17, -17, -np.pi], [17, 17, np.pi], (2, 3))
    free = []
    for x, y, theta in states[:, :3]:
        body = translate(rotate(Polygon(PAPER.parts[0].polygon.vertices), theta, (0, 0), use_radians=True), x, y)
        inside = np.abs(np.array(body.exterior.coords)).max() <= 20 + 1e-9
        free.append(inside and all(body.distance(Polygon(ring)) >= margin - 1e-9 for ring in obstacles))
    if surely_free(some, PAPER, states, margin, 1e-9):
        assert all(free)
    if not obstacles:
        assert surely_free(some, PAPER, states, margin, 1e-9) is all(free)
