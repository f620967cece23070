"""The first mesh and the choice of pairs, held to what they say of themselves."""

from __future__ import annotations

import numpy as np
import pytest

from tightspot.formulations import SeparatingLine, SweptLine
from tightspot.geometry import clearance
from tightspot.planner.mesh import COVER, FEWEST, MOST, gear_changes, path_length, poses_for, steps_for
from tightspot.planner.pairs import near_guess, replay_clearance, replay_outside, sampled_clearance
from tightspot.scenarios import builtin
from tightspot.trajectory import Trajectory
from tightspot.transcription import TimeGrid
from tightspot.vehicles import vehicle
from tightspot.verification import replay


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
    grid = TimeGrid.uniform(10)
    everything = near_guess(guess, grid, scene, car, 100.0)
    near = near_guess(guess, grid, scene, car, 0.5)
    assert everything.shape == (10, 1, 2)
    assert everything.all()
    assert near[-1].all(), "in the slot both obstacles are near"
    assert not near_guess(guess, grid, scene, car, -10.0).any()
    assert (near <= near_guess(guess, grid, scene, car, 1.0)).all(), "a larger reach only adds pairs"


def test_replayed_clearance_and_workspace_name_the_intervals() -> None:
    scene, car = builtin("vertical"), vehicle("paper")
    motion = replay(car, drive([(1.0, 0.0), *[(0.0, 0.0)] * 11, (-1.0, 0.0)]))
    clear = replay_clearance(motion, scene, car, 8)
    assert clear.shape == (13, 1, 2)
    finer = replay_clearance(motion, scene, car, 64)
    assert (finer <= clear + 1e-12).all()
    assert (clear - finer).max() < 0.05
    outside = replay_outside(motion, scene, car, 8)
    nose = motion.knots[:, 0] + 3.699
    assert outside.tolist() == (nose[1:] > 15.0).tolist(), "straight ahead the nose leaves W at x = 15"
