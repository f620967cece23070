"""Paths of hybrid A*: judged by shapely, by integration, and where none exists."""

from __future__ import annotations

import itertools
import threading
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.geometry import ConvexPolygon
from tightspot.search import (
    COARSE,
    MEDIUM,
    Direction,
    HybridAStarOptions,
    SearchStatus,
    search,
)
from tightspot.vehicles import BodyPart, Limits, SingleTrack, vehicle

PAPER = vehicle("paper")
ROAD = ConvexPolygon.rectangle(-5, 20, -4, 4)
SCENES = ("vertical", "parallel", "oblique")


def slot(width: float, road: float = 8.0):
    """A slot between two obstacles below a road, the start on the road, the goal in the slot."""
    left, right = 6.3 - width / 2, 6.3 + width / 2
    obstacles = [ConvexPolygon.rectangle(0, left, -8, -2), ConvexPolygon.rectangle(right, 15, -8, -2)]
    workspace = ConvexPolygon.rectangle(-2, 15, -8, road)
    return workspace, obstacles, PAPER, np.zeros(3), np.array([6.3, -6.7, np.pi / 2])


def gate(gap: float):
    """A wall across a road with a gap in its middle."""
    walls = [ConvexPolygon.rectangle(8, 9, -4, -gap / 2), ConvexPolygon.rectangle(8, 9, gap / 2, 4)]
    return ROAD, walls, PAPER, np.zeros(3), np.array([12.0, 0, 0])


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("direction", list(Direction))
def test_paths_are_free_and_drivable(name, direction, scene, clearance_along, driven):
    workspace, obstacles, car, start, goal = scene(name)
    options = HybridAStarOptions(directions=(direction,))
    result = search(workspace, obstacles, car, start, goal, options)
    path = result.path
    assert result.status is SearchStatus.FOUND, result.explain()
    assert path is not None

    clearance, excess = clearance_along(path, car, workspace, obstacles)
    tolerance = 1.1e-3 * 2.097
    assert clearance >= result.attempts[-1].margin - tolerance
    assert excess <= tolerance

    assert np.abs(path.curvature).max() <= 0.95 / car.min_turning_radius + 1e-12
    end = driven(start, path.arcs)
    assert end[:2] == pytest.approx(goal[:2], abs=1e-4)
    assert (path.poses[0] == start).all()
    assert (path.poses[-1, :2] == goal[:2]).all()
    assert path.poses[-1, 2] == pytest.approx(end[2], abs=1e-9)
    assert np.hypot(*np.diff(path.poses[:, :2], axis=0).T).max() <= 0.1 + 1e-9
    assert set(path.gear) <= {1, -1}
    assert path.gear_changes <= 2
    assert path.length < 17


@pytest.mark.parametrize("name", SCENES)
def test_poses_satisfy_the_car_s_kinematics_between_samples(name, scene):
    path = search(*scene(name)).path
    steps = np.diff(path.poses, axis=0)
    turn = steps[:, 2]
    chord = np.hypot(steps[:, 0], steps[:, 1])
    middle = path.poses[:-1, 2] + turn / 2
    forward = np.cos(middle) * steps[:, 0] + np.sin(middle) * steps[:, 1]
    sideways = -np.sin(middle) * steps[:, 0] + np.cos(middle) * steps[:, 1]
    assert np.abs(sideways).max() < 1e-9
    assert (np.sign(forward) == path.gear[1:]).all()
    way = chord / np.sinc(turn / 2 / np.pi)
    assert turn == pytest.approx(path.gear[1:] * way * path.curvature[1:], abs=1e-9)


def test_tight_end_is_where_the_car_has_less_room():
    workspace, obstacles, car, road, parked = slot(2.6)
    enter = search(workspace, obstacles, car, road, parked)
    leave = search(workspace, obstacles, car, parked, road)
    assert enter.attempts[0].direction is Direction.BACKWARD
    assert leave.attempts[0].direction is Direction.FORWARD
    assert leave.path.length == pytest.approx(enter.path.length)
    away = search(workspace, obstacles, car, road, parked, HybridAStarOptions(directions=(Direction.FORWARD,)))
    assert enter.expansions < away.expansions


def test_finer_resolutions_open_narrower_slots(clearance_along):
    scene = slot(2.2, road=3.0)
    options = HybridAStarOptions(margins=(0.02,))
    result = search(*scene, options)
    assert result.status is SearchStatus.FOUND
    assert result.attempts[0].outcome is SearchStatus.EXHAUSTED
    assert [attempt.resolution for attempt in result.attempts[:2]] == [COARSE, MEDIUM]
    clearance, _ = clearance_along(result.path, PAPER, scene[0], scene[1])
    assert clearance >= 0.02 - 2.3e-3


def test_smaller_margins_are_tried_when_the_larger_block_the_goal():
    result = search(*slot(2.25, road=5.0), HybridAStarOptions(margins=(0.1, 0.05)))
    assert result.attempts[0].outcome is SearchStatus.GOAL_BLOCKED
    assert result.attempts[0].clearance == pytest.approx((2.25 - 2.097) / 2)
    assert result.attempts[-1].margin == 0.05
    assert sum(attempt.margin == 0.1 for attempt in result.attempts) == 1


@pytest.mark.parametrize(("gap", "is_proof"), [(0.5, True), (2.0, False)])
def test_a_walled_in_goal_is_exhausted_and_says_what_was_tried(gap, is_proof):
    options = HybridAStarOptions(margins=(0.05, 0.0), resolutions=(COARSE,))
    result = search(*gate(gap), options)
    assert result.status is SearchStatus.EXHAUSTED
    assert result.path is None
    assert result.is_proof is is_proof
    assert [attempt.outcome for attempt in result.attempts] == [SearchStatus.EXHAUSTED] * 2
    assert "margin 0.05 m" in result.explain()
    assert "There is no path within the search's resolution" in result.explain()
    assert (result.expansions == 0) is is_proof


def test_a_gap_a_little_wider_than_the_car_is_passed():
    result = search(*gate(2.2), HybridAStarOptions(margins=(0.05,)))
    assert result.status is SearchStatus.FOUND
    assert result.path.length == pytest.approx(12)


@pytest.mark.parametrize(
    ("start", "goal", "status", "blocking", "words"),
    [
        ((0, -2, 0), (6.3, -6.7, np.pi / 2), SearchStatus.START_BLOCKED, 0, "start blocked by obstacle 0"),
        ((0, 0, 0), (7.0, -6.7, np.pi / 2), SearchStatus.GOAL_BLOCKED, 1, "goal blocked by obstacle 1"),
        ((0, 0, 0), (14.5, 0, 0), SearchStatus.GOAL_BLOCKED, -1, "the workspace's border"),
    ],
)
def test_blocked_ends_are_named(start, goal, status, blocking, words):
    workspace, obstacles, car, _, _ = slot(2.5)
    result = search(workspace, obstacles, car, start, goal)
    assert result.status is status
    assert result.attempts[-1].blocking == blocking
    assert result.attempts[-1].clearance < 0
    assert result.is_proof
    assert words in result.explain()


def test_limits_are_reported():
    few = search(*gate(2.0), HybridAStarOptions(max_expansions=20, margins=(0.0,)))
    assert few.status is SearchStatus.LIMIT_REACHED
    assert {attempt.expansions for attempt in few.attempts} == {20}
    short = search(*gate(2.0), HybridAStarOptions(time_limit=1e-4))
    assert short.status is SearchStatus.TIME_LIMIT


def l_shaped() -> SingleTrack:
    """A body of two parts like an L: a narrow beam of 4 m, and a block to the right of its rear."""
    beam = BodyPart("beam", ConvexPolygon.rectangle(-0.5, 4.0, -0.4, 0.4))
    block = BodyPart("block", ConvexPolygon.rectangle(-0.5, 0.8, -1.6, -0.3))
    limits = Limits(speed=(-1.0, 1.0), acceleration=(-1.0, 1.0), steering=0.6, steering_rate=0.5)
    return SingleTrack("L", 2.0, (beam, block), limits)


def test_a_body_of_two_parts_passes_where_its_bounding_box_cannot(clearance_along):
    truck = l_shaped()
    box = SingleTrack.rectangular("box", wheelbase=2.0, length=4.5, width=3.2, rear_overhang=0.5, limits=truck.limits)
    post = ConvexPolygon.rectangle(3.0, 3.4, -1.5, -0.6)
    scene = ConvexPolygon.rectangle(-8, 6, -6, 6), [post]
    parked, away = (0.0, 0.0, 0.0), (-5.0, 2.0, 0.0)
    assert search(*scene, box, away, parked).status is SearchStatus.GOAL_BLOCKED
    result = search(*scene, truck, away, parked)
    assert result.status is SearchStatus.FOUND
    clearance, excess = clearance_along(result.path, truck, *scene)
    assert clearance >= result.attempts[-1].margin - 3e-3
    assert excess <= 3e-3


def test_a_part_on_another_frame_is_refused():
    trailer = BodyPart("trailer", ConvexPolygon.rectangle(-1, 0, -1, 1), frame=1)
    car = SimpleNamespace(parts=(*PAPER.parts, trailer), min_turning_radius=3.3)
    with pytest.raises(InputError, match="trailer turns on its own"):
        search(ROAD, [], car, (0, 0, 0), (5, 0, 0))


def test_a_thousand_obstacles_far_away_cost_no_pair_tests(scene):
    _, obstacles, car, start, goal = scene("vertical")
    wide = ConvexPolygon.rectangle(-2, 215, -8, 200)
    crowd = [
        ConvexPolygon.rectangle(20 + 5 * i, 21 + 5 * i, 20 + 5 * j, 21 + 5 * j)
        for i, j in itertools.product(range(34), range(34))
    ]
    few = search(wide, obstacles, car, start, goal)
    many = search(wide, [*obstacles, *crowd], car, start, goal)
    assert many.status is SearchStatus.FOUND
    assert many.attempts[0].pair_tests == few.attempts[0].pair_tests
    assert many.attempts[0].pose_checks == few.attempts[0].pose_checks


def test_a_way_through_a_thousand_obstacles_tests_only_the_near_ones(clearance_along):
    posts = [
        ConvexPolygon.rectangle(8 * i, 8 * i + 1, 8 * j, 8 * j + 1) for i, j in itertools.product(range(32), range(32))
    ]
    workspace = ConvexPolygon.rectangle(-8, 257, -8, 257)
    result = search(workspace, posts, PAPER, (4.5, -4, 0), (116.5, 116.5, 1.5))
    assert result.status is SearchStatus.FOUND
    attempt = result.attempts[-1]
    assert attempt.pair_tests < 3 * attempt.pose_checks
    clearance, _ = clearance_along(result.path, PAPER, workspace, posts)
    assert clearance >= attempt.margin - 2.3e-3


def test_results_are_the_same_every_time_and_in_every_thread(scene):
    results = []
    threads = [threading.Thread(target=lambda: results.append(search(*scene("parallel")))) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 3
    assert all((result.path.poses == results[0].path.poses).all() for result in results)
    assert len({result.expansions for result in results}) == 1


def test_closed_poses_are_returned_on_request(scene):
    assert search(*scene("vertical")).closed_poses.shape == (0, 3)
    result = search(*scene("vertical"), HybridAStarOptions(keep_closed=True))
    assert result.closed_poses.shape == (result.expansions, 3)


def test_shortcuts_do_not_raise_the_cost(scene):
    for name in SCENES:
        plain = search(*scene(name), HybridAStarOptions(shortcuts=False, extra_expansions=0))
        cut = search(*scene(name), HybridAStarOptions(extra_expansions=0))
        assert cut.attempts[-1].cost <= plain.attempts[-1].cost + 1e-9
        assert cut.path.gear_changes <= plain.path.gear_changes


def test_a_reverse_factor_makes_the_car_prefer_driving_forwards():
    open_field = ConvexPolygon.rectangle(-40, 40, -40, 40)
    behind = (-15.0, 3.0, 0.0)
    usual = search(open_field, [], PAPER, (0, 0, 0), behind)
    dear = search(open_field, [], PAPER, (0, 0, 0), behind, HybridAStarOptions(reverse=10.0))
    assert (usual.path.arcs[:, 0] < 0).all()
    assert np.abs(dear.path.arcs[dear.path.arcs[:, 0] < 0, 0]).sum() < 5


def test_a_small_robot_is_searched_for_at_its_own_scale():
    limits = Limits(speed=(-1.0, 1.0), acceleration=(-1.0, 1.0), steering=0.6, steering_rate=0.5)
    robot = SingleTrack.rectangular(
        "robot", wheelbase=0.28, length=0.4628, width=0.2097, rear_overhang=0.0929, limits=limits
    )
    obstacles = [
        ConvexPolygon.rectangle(0, 0.5, -0.8, -0.2),
        ConvexPolygon.rectangle(0.76, 1.5, -0.8, -0.2),
    ]
    workspace = ConvexPolygon.rectangle(-0.2, 1.5, -0.8, 0.8)
    options = HybridAStarOptions(margins=(0.005,), gear_change=0.2, steering_change=0.05, spacing=0.01)
    result = search(workspace, obstacles, robot, (0, 0, 0), (0.63, -0.67, np.pi / 2), options)
    assert result.status is SearchStatus.FOUND
    assert result.expansions < 5000
    assert result.path.gear_changes <= 3


def test_a_hopeless_search_ends_after_its_first_resolution() -> None:
    asked = []

    def is_hopeless() -> bool:
        asked.append(True)
        return True

    scene = gate(2.0)  # a disc about the axle fits through, the car does not
    options = HybridAStarOptions(resolutions=(COARSE, MEDIUM), margins=(0.05, 0.02))
    result = search(*scene, options, is_hopeless=is_hopeless)
    assert result.path is None
    assert len(asked) == 1
    assert {attempt.resolution for attempt in result.attempts} == {COARSE}
    assert {attempt.margin for attempt in result.attempts} == {0.05, 0.02}


def test_what_a_closed_scene_leaves_reachable_is_kept() -> None:
    """Though it is known at once that there is no way, the poses that can be reached are looked at if they are kept."""
    wall = ConvexPolygon.rectangle(8, 8.5, -5, 5)
    scene = ConvexPolygon.rectangle(-3, 16, -5, 5), [wall], PAPER, (0, 0, 0), (12, 0, 0)
    options = HybridAStarOptions(resolutions=(COARSE,), margins=(0.05,), directions=(Direction.FORWARD,))
    quick = search(*scene, options)
    assert quick.is_proof
    assert quick.expansions == 0
    kept = search(*scene, replace(options, keep_closed=True))
    assert kept.is_proof
    assert kept.status is quick.status
    assert len(kept.closed_poses) == kept.expansions > 1000
    assert kept.closed_poses[:, 0].max() < 8 - 0.9
    ahead = kept.closed_poses[np.abs(kept.closed_poses[:, 2]) < 0.01]
    assert ahead[:, 0].max() > 8 - 3.7 - 1.0, "it gets near the wall"
