"""Separating lines in closed form, from which stagewise solves start."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tightspot.solvers.base import Array
from tightspot.solvers.stage_core import compiled
from tightspot.solvers.stage_problem import StageProblem


class StartLines(NamedTuple):
    """Separating lines in closed form.

    Attributes:
        lines: (phi, mu) of each pair, midway between the obstacle and the body, (n, 2).
        origins: Points next to the body to measure mu from, m, (n, 2).
        overlaps: How far the body reaches beyond the obstacle's edge of the line, m, 0 if it does not, (n,).
    """

    lines: Array
    origins: Array
    overlaps: Array

    def beside_obstacles(self) -> Array:
        """The lines, those of overlapping pairs at the obstacle's edge."""
        return self.lines + np.column_stack([np.zeros_like(self.overlaps), self.overlaps / 2])


def start_lines(
    states: Array,
    pieces: NDArray[np.int64],
    pairs: NDArray[np.int64],
    part_vertices: Array,
    part_first: NDArray[np.int64],
    obstacle_vertices: Array,
    obstacle_first: NDArray[np.int64],
    *,
    whole: NDArray[np.bool_],
    moving: NDArray[np.int64] | None = None,
    frames: Array | None = None,
) -> StartLines:
    """Lines of pairs to start from.

    As :func:`tightspot.formulations.lines.line_of_guess`: the best normal at the interval's middle pose, and the offset
    midway between the obstacle and the body at all the interval's poses, interpolated between the knots, or at the last
    one alone where it is not ``whole``, (N,). The arrays are those of a :class:`StageProblem`, the states the guess's.
    Obstacles that move (``moving``, (M,)) have lines and points in their frames, whose poses at each sample are
    ``frames``, (M, S, 3).
    """
    polygons = (part_vertices, part_first, obstacle_vertices, obstacle_first)
    moving = np.zeros(0, np.int64) if moving is None else moving
    frames = np.zeros((0, 0, 3)) if frames is None else frames
    return StartLines(*compiled().stagewise_start_lines(states, pieces, whole, *polygons, pairs, moving, frames))


def with_states(problem: StageProblem, states: Array, inputs: Array, final_time: float) -> StageProblem:
    """The problem, starting from other states, inputs and t_f, with the lines that separate best there."""
    first = np.concatenate([[0], np.cumsum(problem.pieces + 1)[:-1]])
    whole = ~np.isnan(problem.pair_demands[first, 0])
    polygons = (problem.part_vertices, problem.part_first, problem.obstacle_vertices, problem.obstacle_first)
    moving, frames = problem.motion_obstacles, problem.frames(final_time)
    found = start_lines(states, problem.pieces, problem.pairs, *polygons, whole=whole, moving=moving, frames=frames)
    soft = problem.soft
    return problem.replaced(
        states=states,
        inputs=inputs,
        final_time=final_time,
        lines=np.where(soft[:, None], found.beside_obstacles(), found.lines),
        penetrations=np.where(soft, found.overlaps, 0.0),
        pair_origins=found.origins,
    )
