"""Assorted guesses: of all kinds, as many as wanted, the same for the same seed."""

from __future__ import annotations

import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.geometry import ConvexPolygon, clearance, transform
from tightspot.guesses import HybridAStar, ReedsShepp, assorted
from tightspot.scenarios import Obstacle, Scenario
from tightspot.scenarios.library import builtin
from tightspot.search import Path, blocked_shares


def bar(x: float, wide: float = 6.0) -> Scenario:
    """A wall of some width ahead of a car that wants to pass it."""
    wall = Obstacle("wall", np.array([(x, -wide), (x + 1, -wide), (x + 1, wide), (x, wide)]))
    return Scenario(
        name="bar",
        workspace=ConvexPolygon.rectangle(-6, 26, -12, 12),
        obstacles=(wall,),
        start=[0, 0, 0, 0, 0],
        goal=[18, 0, 0, 0, 0],
        vehicle="paper",
    )


@pytest.mark.parametrize("count", [1, 2, 12])
def test_as_many_as_wanted_each_from_start_to_goal(count):
    scene = builtin("parallel")
    car = scene.vehicle_model()
    results = assorted(scene, car, count, 1)
    assert len(results) == count
    assert len({result.report["variant"] for result in results}) == count
    for result in results:
        np.testing.assert_allclose(result.trajectory.poses[0], scene.start[:3], atol=1e-9)
        assert np.abs(result.trajectory.poses[-1, :2] - scene.goal[:2]).max() < 1e-6
        assert result.reason.endswith(".")


def test_there_are_searched_ones_words_and_bent_ones():
    scene = builtin("garage")
    names = [result.report["variant"] for result in assorted(scene, scene.vehicle_model(), 18, 0)]
    assert "default" in names
    assert any(name.startswith("Reeds-Shepp") for name in names)
    assert sum("bent" in name for name in names) >= 9


def test_seeds_decide_and_threads_do_not():
    scene = builtin("parallel")
    car = scene.vehicle_model()
    one, two, other = (assorted(scene, car, 9, seed, threads=threads) for seed, threads in ((4, 1), (4, 3), (5, 1)))
    for a, b in zip(one, two, strict=True):
        np.testing.assert_array_equal(a.trajectory.states, b.trajectory.states)
    ways = [np.concatenate([result.trajectory.states.ravel() for result in results[-4:]]) for results in (one, other)]
    assert ways[0].shape != ways[1].shape or np.abs(ways[0] - ways[1]).max() > 1e-3


def test_a_known_first_guess_is_not_searched_again():
    scene = builtin("vertical")
    car = scene.vehicle_model()
    first = HybridAStar().make(scene, car, margin=0.05)
    results = assorted(scene, car, 6, 0, margin=0.05, first=first)
    assert any(result.details is first.details for result in results)


def test_where_there_is_no_way_there_is_one_result_that_says_why():
    scene = bar(6.0, wide=12.0)
    (result,) = assorted(scene, scene.vehicle_model(), 5, margin=0.0)
    assert result.trajectory is None
    assert "no path" in result.reason


@pytest.mark.parametrize("count", [0, -1, 2.5, float("nan")])
def test_a_count_must_be_a_whole_number(count):
    scene = builtin("oblique")
    with pytest.raises(InputError, match="count"):
        assorted(scene, scene.vehicle_model(), count)


def test_the_least_blocked_words_come_first_and_hopeless_ones_not_at_all():
    scene = bar(8.0, wide=0.4)
    car = scene.vehicle_model()
    results = ReedsShepp().least_blocked(scene, car, 50, margin=0.0, most=0.5)
    obstacle = scene.obstacle_parts[0][1].vertices

    def blocked(path: Path) -> float:
        near = np.full(len(path.poses), np.inf)
        for part in car.parts:
            body = transform(part.polygon.vertices, path.poses)
            near = np.minimum(near, clearance(body, obstacle))
            outside = scene.workspace.b - body @ scene.workspace.A.T
            near = np.minimum(near, np.where(outside.min(axis=(1, 2)) < -1e-6, -1.0, np.inf))
        return float(np.mean(near <= 0))

    shares = [blocked(result.details.sample(0.25)) for result in results]
    assert len(shares) >= 2
    assert shares == sorted(shares)
    assert max(shares) <= 0.5
    everything = ReedsShepp().least_blocked(scene, car, 1000, margin=0.0, most=1.0)
    assert len(everything) == everything[0].report["words"]
    assert {result.report["word"] for result in everything} >= {result.report["word"] for result in results}


def test_a_path_is_blocked_where_the_body_is_too_near():
    scene = bar(8.0)
    car = scene.vehicle_model()
    obstacles = [polygon for _, polygon in scene.obstacle_parts]
    through = Path.from_arcs(np.zeros(3), [(18.0, 0.0)])
    away = Path.from_arcs(np.zeros(3), [(-1.0, 0.0)])
    first, second = blocked_shares(scene.workspace, obstacles, car, [through, away], 0.0)
    corners = np.vstack([part.polygon.vertices for part in car.parts])
    length = np.ptp(corners[:, 0]) + 1.0
    assert first == pytest.approx(length / 18, abs=0.03)
    assert second == 0
    assert blocked_shares(scene.workspace, obstacles, car, [through], 0.5)[0] > first
