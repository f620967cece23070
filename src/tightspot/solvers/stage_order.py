"""Between the order of a :class:`StageProblem` and that of the :class:`Nlp` that says the same."""

from __future__ import annotations

from dataclasses import dataclass, replace
from threading import Lock
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tightspot.solvers.stage_problem import StageProblem

Array = NDArray[np.float64]
Index = NDArray[np.intp]


class CorePoint(NamedTuple):
    """What the core returns.

    Attributes:
        v: Variables, in the core's order.
        z: Multipliers of the rows ``c >= 0``, not negative.
        lam: Of the dynamics, N n_x.
        bounds: Of states, inputs and t_f, in CasADi's sign: what bounds and fixed values add to the Lagrangian's
            gradient.
        rows: c at v.
        demands: The clearance demanded in each row, cover included.
        defects: ``F_k - x_{k+1}``, N n_x.
    """

    v: Array
    z: Array
    lam: Array
    bounds: Array
    rows: Array
    demands: Array
    defects: Array


class NlpPoint(NamedTuple):
    """The same for the Nlp: variables, rows, multipliers of bounds and rows in CasADi's signs."""

    x: Array
    g: Array
    lam_x: Array
    lam_g: Array


@dataclass(frozen=True, eq=False)
class StageOrder:
    """Positions in the Nlp's vectors.

    Attributes:
        problem: The arrays.
        states: Of each state, (N + 1, n_x).
        inputs: Of each input, (N, n_u).
        lines: Of each pair's first auxiliary variable, (n,); a soft pair's last one is the penetration.
        time: Of t_f.
        rows: Of each of the core's rows, (m,).
        signs: 1 where the Nlp's row is the core's, -1 where it is its negative, (m,).
        pair_of_row: The pair of each row, -1 for walls, (m,).
        place_of_row: ``interval * parts + part`` of each row, (m,).
        units: Of each pair's row ``|lam|^2 <= 1``, (n,), if the form has one.
        dynamics: (N, n_x).
        n_rows: Number of rows of g.
    """

    problem: StageProblem
    states: Index
    inputs: Index
    lines: Index
    time: int
    rows: Index
    signs: Array
    pair_of_row: Index
    place_of_row: Index
    units: Index
    dynamics: Index
    n_rows: int

    def point(self, core: CorePoint) -> NlpPoint:
        """The Nlp's vectors."""
        problem = self.problem
        states, inputs, final_time, lines, penetrations = problem.unpack(core.v)
        x = np.empty(self.time + 1)
        x[self.states], x[self.inputs], x[self.time] = states, inputs, final_time
        self._write_lines(x, lines, states, final_time)
        x[self.lines[problem.soft] + problem.form.size] = penetrations[problem.soft]
        lam_x = np.zeros(x.size)
        n = states.size + inputs.size
        lam_x[self.states] = core.bounds[: states.size].reshape(states.shape)
        lam_x[self.inputs] = core.bounds[states.size : n].reshape(inputs.shape)
        lam_x[self.time] = core.bounds[n]
        g, lam_g = np.empty(self.n_rows), np.empty(self.n_rows)
        g[self.rows], lam_g[self.rows] = self.signs * core.rows, -self.signs * core.z
        shape = self.dynamics.shape
        g[self.dynamics], lam_g[self.dynamics] = core.defects.reshape(shape), core.lam.reshape(shape)
        if self.units.size:
            g[self.units] = 1.0
            lam_g[self.units] = self._unit_multipliers(core)
        return NlpPoint(x, g, lam_x, lam_g)

    def _write_lines(self, x: Array, lines: Array, states: Array, final_time: float) -> None:
        form = self.problem.form
        phi, mu = lines.T
        if form.vector:
            x[self.lines], x[self.lines + 1], x[self.lines + 2] = np.cos(phi), np.sin(phi), mu
        elif form.in_body:
            pose = self.problem.poses_at_ends(states, final_time)
            x[self.lines] = phi - pose[:, 2]
            x[self.lines + 1] = mu - np.cos(phi) * pose[:, 0] - np.sin(phi) * pose[:, 1]
        else:
            x[self.lines], x[self.lines + 1] = phi, mu

    def _unit_multipliers(self, core: CorePoint) -> Array:
        """Of ``|lam|^2 <= 1``: what makes the Lagrangian stationary along lam.

        The multipliers of a pair's rows add up to 0 along mu, and to 0 across lam; along lam they add up to
        ``sum_j z_j n.O_j - sum_i z_i n.V_i``, whose negative is twice the multiplier. By the rows' values that is
        the sum of z times demand plus slack, so it is not negative.
        """
        mine = self.pair_of_row >= 0
        weighted = core.z[mine] * (core.rows[mine] + core.demands[mine])
        return np.bincount(self.pair_of_row[mine], weighted, minlength=self.units.size) / 2


def order_of(problem: StageProblem) -> StageOrder:
    """The positions of a problem's variables and rows; they are kept for problems of the same structure."""
    with _LOCK:
        known = _KNOWN.pop(structure := _structure(problem), None)
        if known is not None:
            _KNOWN[structure] = known
    if known is not None:
        return replace(known, problem=problem)
    order = _order_of(problem)
    with _LOCK:
        _KNOWN[structure] = order
        while len(_KNOWN) > _MOST_KNOWN:
            del _KNOWN[next(iter(_KNOWN))]
    return order


_LOCK = Lock()
_KNOWN: dict[tuple[object, ...], StageOrder] = {}  # by structure, the last one used last
_MOST_KNOWN = 8


def _structure(problem: StageProblem) -> tuple[object, ...]:
    """All that the positions depend on."""
    counts = (problem.pieces, problem.part_first, problem.obstacle_first, problem.pairs, problem.walls)
    tables = (problem.pair_demands, problem.wall_demands, problem.pair_penalties)
    used = (np.isnan(table[:, 0]) for table in tables)
    sizes = (problem.start.size, problem.input_weights.size)
    return (problem.form, sizes, *((array.shape, array.tobytes()) for array in (*counts, *used)))


def _order_of(problem: StageProblem) -> StageOrder:
    n_x, n_u, steps = problem.start.size, problem.input_weights.size, problem.steps
    interval, auxiliary = problem.pairs[:, 0], problem.form.size + problem.soft
    # Knot k's variables are x_k, u_k, then the lines of the interval that ends there.
    until = np.concatenate([[0], np.cumsum(auxiliary)])
    of_interval = until[np.searchsorted(interval, np.arange(steps + 1))]
    knot = np.arange(steps + 1) * (n_x + n_u) + np.concatenate([[0], of_interval[:-1]])
    states = knot[:, None] + np.arange(n_x)
    inputs = knot[:-1, None] + n_x + np.arange(n_u)
    first_line = knot[1:] + n_x + np.where(np.arange(1, steps + 1) < steps, n_u, 0)
    lines = first_line[interval] + until[:-1] - of_interval[interval]
    time = int(states[-1, -1]) + 1 + int(of_interval[-1] - of_interval[-2])
    return _with_rows(problem, states, inputs, lines, time)


def _with_rows(problem: StageProblem, states: Index, inputs: Index, lines: Index, time: int) -> StageOrder:
    n_x, steps, parts = problem.start.size, problem.steps, problem.part_radii.size
    corners = np.diff(problem.part_first)
    starts = np.concatenate([[0], np.cumsum(problem.pieces + 1)[:-1]])
    pair_samples = np.add.reduceat(~np.isnan(problem.pair_demands[:, 0]), starts, dtype=np.intp)
    wall_samples = np.add.reduceat(~np.isnan(problem.wall_demands[:, 0]), starts, dtype=np.intp)
    # Blocks in the core's order: for every interval and part its walls, then its pairs.
    of_wall = problem.walls[:, 0] * parts + problem.walls[:, 1]
    wall_counts = np.bincount(of_wall, minlength=steps * parts)
    place = np.arange(steps * parts)
    wall_sizes = wall_counts * wall_samples[place // parts] * corners[place % parts]
    of_pair = problem.pairs[:, 0] * parts + problem.pairs[:, 1]
    obstacle_sizes = np.diff(problem.obstacle_first)[problem.pairs[:, 2]]
    body_sizes = pair_samples[problem.pairs[:, 0]] * corners[problem.pairs[:, 1]] + problem.soft
    keys = np.concatenate([2 * place, np.repeat(2 * of_pair + 1, 2)])
    sizes = np.concatenate([wall_sizes, np.column_stack([obstacle_sizes, body_sizes]).ravel()])
    about = np.concatenate([np.full(place.size, -1), np.repeat(np.arange(of_pair.size), 2)])
    negative = np.concatenate([np.ones(place.size, bool), np.tile([True, False], of_pair.size)])
    order = np.argsort(keys, kind="stable")
    keys, sizes, about, negative = keys[order], sizes[order], about[order], negative[order]
    interval = keys // (2 * parts)
    # The Nlp has a row |lam|^2 <= 1 after each pair and the dynamics after each interval.
    unit = int(problem.form.vector)
    ends_pair = (about >= 0) & ~negative
    begin = np.cumsum(sizes) - sizes + n_x * interval + unit * (np.cumsum(ends_pair) - ends_pair)
    if problem.form.body_first:
        obstacle, body = np.flatnonzero((about >= 0) & negative), np.flatnonzero(ends_pair)
        begin[obstacle], begin[body] = begin[obstacle] + sizes[body], begin[obstacle]
    within = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    rows = np.repeat(begin, sizes) + within
    last_block = (about >= 0) & negative if problem.form.body_first else ends_pair
    pair_ends = (begin + sizes)[last_block]
    rows_of_interval = np.bincount(interval, sizes + unit * ends_pair, minlength=steps).astype(np.intp)
    dynamics = np.cumsum(rows_of_interval) + n_x * np.arange(steps)
    return StageOrder(
        problem,
        states,
        inputs,
        lines,
        time,
        rows,
        signs=np.where(np.repeat(negative, sizes), -1.0, 1.0),
        pair_of_row=np.repeat(about, sizes),
        place_of_row=np.repeat(keys // 2, sizes),
        units=pair_ends if unit else pair_ends[:0],
        dynamics=dynamics[:, None] + np.arange(n_x),
        n_rows=int(rows.size + n_x * steps + unit * pair_ends.size),
    )
