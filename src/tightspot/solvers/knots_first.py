"""A stagewise solve begun with the rows at the knots alone, where the problem has rows between them, too.

In which interval a line that is shared by all poses of an interval swings from one edge of an obstacle to the next is a
choice, and every one is a local optimum with saddle points in between. A rough start makes these choices before the
path is known. With rows at the knots only each line follows its own pose; a few digits of that solution suffice to
choose, and the solve with all rows begins there: with the same lines, with slacks of as much as rows between the knots
are violated by, and with a barrier that is small enough not to leave the valley again.
"""

from __future__ import annotations

import numpy as np

from tightspot.solvers.base import Array
from tightspot.solvers.stage_problem import Integers, StageProblem

TOLERANCE = 1e-2
"""Of the solve at the knots; with more digits it only takes longer."""
SHARE = 5
"""The solve at the knots may take the n-th part of all iterations."""
BARRIER, SLACK = 1e-2, 0.2
"""Where a rough solution at the knots begins to be one between them, too: it violates rows by about as much, m."""


def has_rows_between(problem: StageProblem) -> bool:
    """True if pairs have rows elsewhere than at the intervals' last knots, and none of them may penetrate.

    Arrays that do not fit each other have none: to say so is the solver's business.
    """
    if not (_fits(problem) and len(problem.pairs)):
        return False
    rows = ~np.isnan(problem.pair_demands[:, 0])
    rows[_ends(problem)[1]] = False
    return bool(rows.any() and not problem.soft.any())


def _fits(problem: StageProblem) -> bool:
    samples = int((problem.pieces + 1).sum())
    return (
        problem.pieces.shape == problem.substeps.shape
        and bool(np.all(problem.pieces >= 1))
        and problem.pair_demands.shape == problem.wall_demands.shape == (samples, 2)
        and problem.pair_sides.shape == (len(problem.pairs), 2)
        and problem.motion_poses.shape == problem.motion_slopes.shape
        and problem.motion_poses.shape[1:] in ((samples, 3), (0, 3))
    )


def at_knots(problem: StageProblem) -> StageProblem:
    """The same with rows at the last knot of each interval only, without covers: a relaxation, with the same variables.

    An interval is one piece with as many Runge-Kutta steps as before, so that the motion is the same.
    """
    first, last = _ends(problem)
    kept, moving = np.column_stack([first, last]).ravel(), problem.motion_poses.size > 0
    return problem.replaced(
        pieces=np.ones_like(problem.pieces),
        substeps=problem.pieces * problem.substeps,
        pair_demands=_at_last(problem.pair_demands[last]),
        wall_demands=_at_last(problem.wall_demands[last]),
        pair_sides=problem.pair_sides * [1.0, 0.0],
        motion_poses=np.ascontiguousarray(problem.motion_poses[:, kept]) if moving else problem.motion_poses,
        motion_slopes=np.ascontiguousarray(problem.motion_slopes[:, kept]) if moving else problem.motion_slopes,
    )


def begun_at(problem: StageProblem, v: Array) -> StageProblem:
    """The problem from the core's variables at the end of the solve at its knots."""
    states, inputs, final_time, lines, _ = problem.unpack(v)
    return problem.replaced(states=states, inputs=inputs, final_time=final_time, lines=lines)


def _ends(problem: StageProblem) -> tuple[Integers, Integers]:
    """The first and the last sample of each interval."""
    last: Integers = np.cumsum(problem.pieces + 1) - 1
    return last - problem.pieces, last


def _at_last(demands: Array) -> Array:
    """(constant, 0) at the second of two samples, nothing at the first, (2 N, 2)."""
    both = np.full((2 * len(demands), 2), np.nan)
    both[1::2, 0], both[1::2, 1] = demands[:, 0], 0.0
    return both
