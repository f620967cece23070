"""From the solution of one program to the start of the next, on another mesh: variables and multipliers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tightspot.geometry.transforms import nearest_angle
from tightspot.scenarios.scenario import Scenario
from tightspot.solvers.base import SolveReport, WarmStart
from tightspot.solvers.nlp import Nlp, RowBlock
from tightspot.solvers.stage_problem import StageProblem
from tightspot.solvers.stage_report import StageReport
from tightspot.transcription.grid import TimeGrid
from tightspot.transcription.transcribe import Transcription

Array = NDArray[np.float64]
Index = NDArray[np.intp]

PUSH = 1e-2
_DIGITS = np.array([2**40, 2**20, 1])  # a pair (interval, part, obstacle part) as one number, in the same order


def parents(old: TimeGrid, new: TimeGrid) -> Index:
    """For each interval of the new grid the interval of the old one that holds its middle, (N_new,)."""
    return _holding(old, (new.fractions[:-1] + new.fractions[1:]) / 2)


def _holding(grid: TimeGrid, fractions: Array) -> Index:
    """For each fraction the interval that holds it."""
    return np.minimum(np.maximum(grid.fractions.searchsorted(fractions, side="right") - 1, 0), grid.steps - 1)


def carry_over(old: Transcription, report: SolveReport, new: Transcription) -> WarmStart:
    """A start for ``new`` from the solution of ``old``; both have the same vehicle and horizon.

    States, inputs and t_f are those of ``new.nlp.x0``: the trajectory that ``new`` was transcribed from. Every pair
    takes its auxiliary variables from the interval that its own one was cut from, if the pair was in the old program
    with as many variables; otherwise it keeps its closed-form start.

    Multipliers go the same way. Those of the dynamics are the costate, a function of time that a finer mesh samples
    more often: they are copied. Those of bounds and of path rows add up to an integral over time: an interval that is
    cut in n gives each piece its share of the width. Rows and bounds that were not there before start at 0. The start
    is pushed away from its bounds by :data:`PUSH`, since another mesh has another active set.
    """
    x = new.nlp.x0.copy()
    lam_x, lam_g = np.zeros(x.size), np.zeros(new.nlp.n_rows)
    parent = parents(old.grid, new.grid)
    share = new.grid.widths / old.grid.widths[parent]
    for (k, part, obstacle), place in new.lines.items():
        source = old.lines.get((int(parent[k]), part, obstacle))
        if source is not None and source.stop - source.start == place.stop - place.start:
            x[place] = report.x[source]
            lam_x[place] = report.lam_x[source] * share[k]
    _bounds(old, report, new, parent, share, lam_x)
    _rows(old.nlp, report, new.nlp, parent, share, lam_g)
    return WarmStart(x, lam_x, lam_g, push=PUSH)


def carry_lines(grid: TimeGrid, report: StageReport, problem: StageProblem) -> StageProblem:
    """The problem with the lines of an earlier solve on another mesh, where the pair had one.

    Args:
        grid: Of the earlier solve.
        report: Of the earlier solve.
        problem: The new one, with closed-form lines.
    """
    if report.lines is None or report.pairs is None or not len(report.pairs):
        return problem
    parent = _holding(grid, problem.widths.cumsum() - problem.widths / 2)
    old = report.pairs @ _DIGITS
    wanted = parent[problem.pairs[:, 0]] * _DIGITS[0] + problem.pairs[:, 1:] @ _DIGITS[1:]
    place = np.minimum(old.searchsorted(wanted), len(old) - 1)
    same = old[place] == wanted
    return problem.replaced(lines=np.where(same[:, None], report.lines[place], problem.lines))


def moved_ends(report: StageReport, scenario: Scenario) -> StageProblem | None:
    """The problem of an earlier solve from its solution, with the scenario's start and goal in place of its own.

    ``None`` if the obstacles are others: then every pair needs its place anew. W, margins and mesh are the earlier
    solve's.
    """
    problem = report.problem
    if problem is None or report.states is None or report.inputs is None or report.lines is None:
        return None
    if not np.array_equal(scenario.obstacle_polygons.vertices, problem.obstacle_vertices):
        return None
    states, ends = report.states.copy(), []
    for end, knot in ((scenario.start, 0), (scenario.goal, -1)):
        state = np.array(end)
        state[2] = nearest_angle(state[2], states[knot, 2])
        states[knot] = np.where(np.isnan(state), states[knot], state)
        ends.append(state)
    return problem.replaced(
        start=ends[0],
        goal=ends[1],
        states=states,
        inputs=report.inputs,
        final_time=report.final_time,
        lines=report.lines,
    )


def _bounds(
    old: Transcription, report: SolveReport, new: Transcription, parent: Index, share: Array, lam_x: Array
) -> None:
    """Multipliers of the bounds of t_f, of the inputs, and of the states at knots that both grids have."""
    lam_x[new.nlp.shared] = report.lam_x[old.nlp.shared]
    for k, stage in enumerate(new.nlp.stages):
        if k < parent.size:
            lam_x[stage.control] = report.lam_x[old.nlp.stages[parent[k]].control] * share[k]
        same = np.flatnonzero(np.abs(old.grid.fractions - new.grid.fractions[k]) < 1e-12)
        if same.size:
            lam_x[stage.state] = report.lam_x[old.nlp.stages[same[0]].state]


def _rows(old: Nlp, report: SolveReport, new: Nlp, parent: Index, share: Array, lam_g: Array) -> None:
    sources = {(block.kind, block.knot, block.key): block for block in old.blocks}
    for block in new.blocks:
        k = block.knot - 1
        source = sources.get((block.kind, int(parent[k]) + 1, block.key))
        if source is not None and _size(source) == _size(block):
            scale = 1.0 if block.kind == "dynamics" else share[k]
            lam_g[block.rows] = report.lam_g[source.rows] * scale


def _size(block: RowBlock) -> int:
    return int(block.rows.stop - block.rows.start)
