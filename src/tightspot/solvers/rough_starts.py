"""Other ways to begin a stagewise solve whose start was too rough, for example a straight line through the obstacles.

Two things spoil such starts. A car that stands still cannot be steered: where v = 0 the linearised dynamics have no
sideways motion, and no Newton step finds one. And a path through an obstacle has lines that pull to opposite sides. So
each way begins with the speeds that the poses ask for, and first solves without obstacles, for a gentle drive: that is
easily found, swings out wide, and tells on which side of everything it passes. The whole problem follows from there.

The ways differ in how that first drive is made: with little weight on time, with the given final time, and from poses
that are bent aside by a few smooth waves.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tightspot.solvers.stage_problem import StageProblem

Array = NDArray[np.float64]

SPEED = {"single_track": 3}
"""Which state is the speed along the heading, by model; x, y and heading come first in all."""
LARGEST = 1e6
GENTLE = 0.01
BENDS = 4
WAVES = 3
BEND = 0.25
TURN = 0.35


class Way(NamedTuple):
    """A problem without obstacles whose solution is where the whole problem is started from."""

    name: str
    problem: StageProblem


def ways(problem: StageProblem) -> Iterator[Way]:
    """The ways to begin, the most promising first; always the same for the same problem."""
    empty = without_pairs(problem)
    yield Way("gentle drive", gentle(rolling(empty)))
    yield Way("drive in the given time", in_given_time(rolling(empty)))
    for seed in range(BENDS):
        yield Way(f"gentle drive, bent {seed + 1}", gentle(rolling(bent(empty, seed))))


def can_start_again(problem: StageProblem) -> bool:
    """False if the start's numbers are of no use."""
    numbers = (problem.states[:, :3], problem.obstacle_vertices, problem.part_vertices, problem.final_time)
    return all(bool(np.all(np.abs(number) < LARGEST)) for number in numbers) and problem.final_time > 0


def without_pairs(problem: StageProblem) -> StageProblem:
    """The same drive in the workspace, without obstacles."""
    return problem.with_pairs(slice(0))


def gentle(problem: StageProblem) -> StageProblem:
    """Time has at most a hundredth of the weight that all inputs have at their bounds."""
    return problem.replaced(time_weight=min(problem.time_weight, GENTLE * effort(problem)))


def effort(problem: StageProblem) -> float:
    """``|u|^2_P`` of all inputs at their bounds."""
    largest = np.maximum(np.abs(problem.input_low), np.abs(problem.input_high))
    return float(problem.input_weights @ np.where(largest < LARGEST, largest, 1.0) ** 2)


def in_given_time(problem: StageProblem) -> StageProblem:
    """t_f stays as the start has it."""
    return problem.replaced(time_low=problem.final_time, time_high=problem.final_time)


def rolling(problem: StageProblem) -> StageProblem:
    """With the speeds along the heading that the poses ask for, within bounds, between start and goal."""
    speed = SPEED.get(problem.model)
    if speed is None or problem.steps < 2:
        return problem
    states = problem.states.copy()
    heading = (states[1:, 2] + states[:-1, 2]) / 2
    along = np.diff(states[:, 0]) * np.cos(heading) + np.diff(states[:, 1]) * np.sin(heading)
    v = along / (problem.widths * problem.final_time)
    states[1:-1, speed] = np.clip((v[1:] + v[:-1]) / 2, problem.state_low[speed], problem.state_high[speed])
    return problem.replaced(states=states)


def bent(problem: StageProblem, seed: int) -> StageProblem:
    """The poses moved by random waves ``sin(pi w s) / w``, w = 1..3, that leave both ends alone.

    A wave's standard deviation is a quarter of the vehicle's size in position, and a third of a radian in heading.
    """
    size = BEND * float(problem.part_radii.max(initial=0.0))
    number = np.arange(1, WAVES + 1)
    share = np.concatenate([[0.0], np.cumsum(problem.widths)])
    shapes = np.sin(np.pi * share[:, None] * number)
    amounts = np.random.default_rng(seed).normal(0.0, 1.0, (WAVES, 3)) * [size, size, TURN] / number[:, None]
    states = problem.states.copy()
    moved = np.clip(states[:, :3] + shapes @ amounts, problem.state_low[:3], problem.state_high[:3])
    states[1:-1, :3] = moved[1:-1]
    return problem.replaced(states=states)
