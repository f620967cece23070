"""The first mesh and the choice of pairs, held to what they say of themselves."""

from __future__ import annotations

import numpy as np
import pytest

from tightspot.campaigns.speed.scaling import crowded
from tightspot.formulations import SeparatingLine, SweptLine
from tightspot.geometry import clearance
from tightspot.geometry.transforms import transform
from tightspot.planner.mesh import (
    COVER,
    EASY,
    FEWEST,
    MOST,
    MOST_POSES,
    ROOMY,
    SLIGHT,
    STILL,
    covers_of,
    gear_changes,
    path_length,
    poses_for,
    poses_on,
    steps_for,
    travels_of,
)
from tightspot.planner.pairs import Room
from tightspot.scenarios import builtin
from tightspot.trajectory import Trajectory
from tightspot.transcription import TimeGrid
from tightspot.vehicles import vehicle
from tightspot.verification import replay
from tightspot.verification.sampled import by_interval, sampled_clearance


def drive(inputs: list[tuple[float, float]], step: float = 1.0) -> Trajectory:
    """The exact motion of the paper's car from rest at the origin."""
    t = step * np.arange(len(inputs) + 1)
    car = vehicle("paper")
    rough = Trajectory(t, np.zeros((len(t), 5)), np.array(inputs))
    return Trajectory(t, replay(car, rough).knots, np.array(inputs))


def back_and_forth() -> Trajectory:
    return drive([(0.5, 0.0), (-0.5, 0.0), (-0.5, 0.0), (0.5, 0.0), (0.5, 0.0), (-0.5, 0.0)])


def test_gear_changes_count_changes_of_direction_not_stops() -> None:
    assert gear_changes(back_and_forth()) == 2
    assert gear_changes(drive([(0.5, 0.0), (-0.5, 0.0), (0.0, 0.05), (0.5, 0.0), (-0.5, 0.0)])) == 0


def test_path_length_is_the_distance_driven() -> None:
    assert path_length(drive([(0.5, 0.0), (-0.5, 0.0)])) == pytest.approx(0.5)


def test_steps_grow_with_length_and_gears_within_bounds() -> None:
    short, long = drive([(0.5, 0.0), (-0.5, 0.0)]), drive([(1.0, 0.0), *[(0.0, 0.0)] * 80, (-1.0, 0.0)])
    assert steps_for(short) == FEWEST
    assert steps_for(long) == MOST
    assert FEWEST <= steps_for(back_and_forth()) <= MOST


def test_poses_keep_the_cover_small_at_half_the_speed_limit() -> None:
    car, guess, steps = vehicle("paper"), drive([(1.0, 0.0), *[(0.0, 0.0)] * 15, (-1.0, 0.0)]), 40
    assert poses_for(SeparatingLine(), guess, car, steps) == 1
    poses = poses_for(SweptLine(), guess, car, steps)
    speed = car.limits.speed[1] / 2
    between = path_length(guess) / speed / steps / poses
    rho = car.parts[0].polygon.radius
    bound = car.acceleration_bound(0, rho, [0, 0, 0, speed, 0], [1.0, car.limits.steering_rate], 0.0, np)
    assert bound * between**2 / 8 <= COVER * 1.001


def test_covers_bound_what_the_motion_needs_between_the_knots() -> None:
    """Against the deviation of every vertex from its chord, on a fine replay."""
    car = vehicle("paper")
    motion = drive([(1.0, 0.08), (0.0, 0.08), (-0.5, -0.08), (-0.5, -0.05), (-1.0, 0.0)], step=0.8)
    covers = covers_of(motion, car)
    played = replay(car, motion)
    corners = car.parts[0].polygon.vertices
    weights = np.linspace(0, 1, 41)
    for k, (before, after) in enumerate(zip(motion.t[:-1], motion.t[1:], strict=True)):
        V = transform(corners, played.at(before + weights * (after - before))[:, :3])
        chord = (1 - weights)[:, None, None] * V[:1] + weights[:, None, None] * V[-1:]
        off = np.linalg.norm(V - chord, axis=2).max()
        assert off <= covers[k] < 12 * off + 0.02


def test_interior_poses_stand_where_the_cover_would_cost_room() -> None:
    covers = np.array([0.04, 0.19, 0.19, 3.0, 3.0])
    spare = np.array([-2 * SLIGHT, 0.0, 0.19 + EASY + 0.01, 0.0, 9.0])
    driven = np.ones(5)
    assert poses_on(SweptLine(), covers, spare, driven) == (1, 2, 1, MOST_POSES, 1)
    assert poses_on(SeparatingLine(), covers, spare, driven) == (1,) * 5


def test_rows_stand_at_the_knot_only_where_there_is_room_or_rest() -> None:
    covers, spare = np.full(4, 0.04), np.array([ROOMY + 0.01, ROOMY - 0.01, 0.0, 0.0])
    travels = np.array([1.0, 1.0, STILL / 2, 2 * STILL])
    assert poses_on(SweptLine(), covers, spare, travels) == (0, 1, 0, 1)
    must_give_way = spare - [0, 0, 0, 2 * SLIGHT]
    assert poses_on(SweptLine(), covers, must_give_way, travels) == (1, 1, 0, 1)


def test_no_body_point_travels_further_than_its_bound() -> None:
    car = vehicle("paper")
    motion = drive([(1.0, 0.08), (0.0, 0.08), (-0.5, -0.08), (-0.5, -0.05), (-1.0, 0.0)], step=0.8)
    travels, played, corners = travels_of(motion, car), replay(car, motion), car.parts[0].polygon.vertices
    for k, (before, after) in enumerate(zip(motion.t[:-1], motion.t[1:], strict=True)):
        V = transform(corners, played.at(np.linspace(before, after, 41))[:, :3])
        path = np.linalg.norm(np.diff(V, axis=0), axis=2).sum(axis=0).max()
        assert path <= travels[k] <= 3 * path + 0.1


def test_sampled_clearance_is_the_distance_of_every_pair() -> None:
    scene, car = builtin("vertical"), vehicle("paper")
    states = np.array([[0.0, 0.0, 0.0, 0.0, 0.0], [6.3, -6.7, np.pi / 2, 0.0, 0.0], [2.0, -4.0, 0.3, 0.0, 0.0]])
    found = sampled_clearance(states, scene, car)
    for state, row in zip(states, found, strict=True):
        body = car.parts[0].polygon.transformed(*state[:3])
        for (_, obstacle), value in zip(scene.obstacle_parts, row[0], strict=True):
            assert value == pytest.approx(float(clearance(body.vertices, obstacle.vertices)), abs=1e-12)
    assert found[2].min() < 0 < found[0].min()


def test_pairs_are_near_where_the_guess_is_near() -> None:
    scene, car = builtin("vertical"), vehicle("paper")
    guess = Trajectory(np.array([0.0, 40.0]), np.array([scene.start, scene.goal]), np.zeros((1, 2)))
    room = Room.of_guess(guess, TimeGrid.uniform(10), scene, car)
    assert room.obstacles.shape == (10, 1, 2)
    assert (room.obstacles[-1] < 0.2).all(), "in the slot both obstacles are near"
    assert room.walls.shape == (10, 1, 4)
    rear = room.walls[-1, 0][int(np.argmin(scene.workspace.A[:, 1]))]
    assert rear == pytest.approx(8 - 6.7 - 0.929), "in the slot the rear is near the lower edge of W"


def test_replayed_room_names_the_intervals() -> None:
    scene, car = builtin("vertical"), vehicle("paper")
    motion = replay(car, drive([(1.0, 0.0), *[(0.0, 0.0)] * 11, (-1.0, 0.0)]))
    room = Room.of_replay(motion, scene)
    assert room.obstacles.shape == (13, 1, 2)
    times = np.linspace(0, 13, 13 * 64 + 1)
    finer = by_interval(sampled_clearance(motion.at(times), scene, car), 64)
    assert (finer <= room.obstacles + 1e-12).all()
    assert (room.obstacles - finer).max() < 0.05
    nose = motion.knots[:, 0] + 3.699
    outside = (room.walls < 0).any(axis=(1, 2))
    assert outside.tolist() == (nose[1:] > 15.0).tolist(), "straight ahead the nose leaves W at x = 15"


def test_far_obstacles_are_told_by_bounds_and_near_ones_by_interval() -> None:
    scene, car = crowded(200), vehicle("paper")
    guess = Trajectory(np.array([0.0, 40.0]), np.array([scene.start, scene.goal]), np.zeros((1, 2)))
    room = Room.of_guess(guess, TimeGrid.uniform(10), scene, car)
    dense = room.obstacles
    assert dense.shape == (10, 1, 200)
    assert 0 < room.near.size < 100
    assert (room.far[:, room.near] == np.inf).all()
    for reach in (-0.1, 0.5, 2.0, 8.0, 30.0):
        assert np.array_equal(room.within(reach), dense < reach)
    assert np.array_equal(room.by_obstacles, dense.min(axis=(1, 2)))
    assert room.deepest == min(dense.min(), room.walls.min())
    assert np.array_equal(room.spare(0.2), np.minimum(dense.min(axis=(1, 2)) - 0.2, room.walls.min(axis=(1, 2))))
