"""Several guesses for one scene: free, distinct, the same for the same seed."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.geometry import ConvexPolygon, clearance, transform
from tightspot.guesses import HybridAStar, variants
from tightspot.guesses.several import alike, path_cost
from tightspot.scenarios import Obstacle, Scenario
from tightspot.scenarios.library import builtin
from tightspot.search import Path


@pytest.fixture(scope="module", params=["parallel", "loading-dock"])
def found(request):
    scene = builtin(request.param)
    car = scene.vehicle_model()
    return scene, car, variants(scene, car, 5, seed=2)


def test_they_are_free_of_collisions_and_lead_to_the_goal(found):
    scene, car, results = found
    assert len(results) == 5
    for result in results:
        trajectory = result.trajectory
        np.testing.assert_allclose(trajectory.poses[0], scene.start[:3], atol=1e-9)
        assert np.abs(trajectory.poses[-1, :2] - scene.goal[:2]).max() < 1e-9
        for part in car.parts:
            bodies = transform(part.polygon.vertices, trajectory.poses)
            for _, obstacle in scene.obstacle_parts:
                assert clearance(bodies, obstacle.vertices).min() > 0.05 - 2.5e-3


def test_no_two_are_alike_and_the_cheapest_comes_first(found):
    _, car, results = found
    paths = [result.details.path for result in results]
    assert not any(alike(a, b, 0.5) for a, b in itertools.combinations(paths, 2))
    costs = [result.report["cost"] for result in results]
    assert costs == sorted(costs)
    assert costs == [pytest.approx(path_cost(path, car)) for path in paths]
    assert len({result.report["variant"] for result in results}) == len(results)


def test_the_default_is_among_them_at_its_own_cost(found):
    scene, car, results = found
    default = next(result for result in results if result.report["variant"] == "default")
    alone = HybridAStar().make(scene, car, margin=scene.margin)
    np.testing.assert_array_equal(default.trajectory.states, alone.trajectory.states)
    assert default.report["cost"] == pytest.approx(alone.details.attempts[-1].cost)


def test_threads_and_repetition_change_nothing_and_seeds_do():
    scene = builtin("oblique")
    car = scene.vehicle_model()
    one, two, other = variants(scene, car, 7, 1), variants(scene, car, 7, 1, threads=2), variants(scene, car, 7, 2)
    assert [result.report["variant"] for result in one] == [result.report["variant"] for result in two]
    for a, b in zip(one, two, strict=True):
        np.testing.assert_array_equal(a.trajectory.states, b.trajectory.states)
    assert any(a.report["cost"] != b.report["cost"] for a, b in zip(one, other, strict=False))


def test_both_sides_of_a_block_are_found():
    block = Obstacle("block", np.array([(9, -2), (11, -2), (11, 2), (9, 2)]))
    scene = Scenario(
        name="island",
        workspace=ConvexPolygon.rectangle(-4, 24, -10, 10),
        obstacles=(block,),
        start=[0, 0, 0, 0, 0],
        goal=[18, 0, 0, 0, 0],
        vehicle="paper",
    )
    results = variants(scene, scene.vehicle_model(), 6, seed=0)
    at_block = [np.interp(10.0, result.trajectory.states[:, 0], result.trajectory.states[:, 1]) for result in results]
    assert min(at_block) < -2
    assert max(at_block) > 2


def test_where_there_is_no_way_there_is_one_result_that_says_why():
    wall = Obstacle("wall", np.array([(5, -4), (6, -4), (6, 4), (5, 4)]))
    scene = Scenario(
        name="divided",
        workspace=ConvexPolygon.rectangle(-2, 14, -4, 4),
        obstacles=(wall,),
        start=[0, 0, 0, 0, 0],
        goal=[8, 0, 0, 0, 0],
        vehicle="forklift",
    )
    (result,) = variants(scene, scene.vehicle_model(), 4, margin=0.0)
    assert result.trajectory is None
    assert "no path" in result.reason


def test_a_start_at_the_goal_has_one_guess_at_least():
    scene = builtin("vertical")
    there = Scenario(
        name="there",
        workspace=scene.workspace,
        obstacles=scene.obstacles,
        start=scene.goal,
        goal=scene.goal,
        vehicle="paper",
    )
    results = variants(there, there.vehicle_model(), 3)
    assert results[0].report["cost"] == 0
    assert len(results) <= 3


@pytest.mark.parametrize(
    ("wrong", "words"),
    [({"count": 0}, "count"), ({"count": 1.5}, "count"), ({"threads": 0}, "threads"), ({"seed": -3}, "seed")],
)
def test_arguments_out_of_range_are_named(wrong, words):
    scene = builtin("vertical")
    with pytest.raises(InputError, match=words):
        variants(scene, scene.vehicle_model(), **({"count": 2} | wrong))


def test_paths_that_differ_in_gears_or_place_are_not_alike():
    start = np.zeros(3)
    straight = Path.from_arcs(start, [(10.0, 0.0)])
    bent = Path.from_arcs(start, [(10.0, 0.1)])
    back = Path.from_arcs(start, [(11.0, 0.0), (-1.0, 0.0)])
    assert alike(straight, straight, 0.1)
    assert not alike(straight, bent, 0.5)
    assert not alike(straight, back, 2.0)
    still = Path.from_arcs(start, np.zeros((0, 2)))
    assert alike(still, still, 0.1)
    assert not alike(still, straight, 0.1)
