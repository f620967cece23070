"""The planning problem as plain arrays, stage after stage: what the compiled stagewise solver takes."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot.geometry.transforms import seen_from

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class LineForm:
    """How the program that the arrays were made beside writes a separating line; x and the multipliers go by it.

    Attributes:
        vector: Variables (lam, mu) with a row ``|lam|^2 <= 1`` at the pair's end, instead of (phi, mu).
        in_body: phi and mu are those of the part's frame at the interval's end, instead of the world's.
        body_first: The body's rows come before the obstacle's.
    """

    vector: bool = False
    in_body: bool = False
    body_first: bool = False

    @property
    def size(self) -> int:
        """Number of a line's variables."""
        return 3 if self.vector else 2


@dataclass(frozen=True, eq=False)
class StageProblem:
    """Minimise ``time_weight t_f + c sum_k widths[k] |u_k|^2_P + sum_i penalty_i(t_f) sigma_i``, c = t_f or 1, under

    - ``x_{k+1} = F_k(x_k, u_k, t_f)``: ``pieces[k] * substeps[k]`` Runge-Kutta steps over ``widths[k] * t_f``;
    - bounds, start and goal;
    - walls: ``offset - n . V >= demand`` for every vertex V of a part at a sample;
    - pairs, with a line ``{q: n . q = mu}``, n = (cos phi, sin phi), each: ``n . V >= mu + demand`` for every vertex of
      the part at a sample, ``n . O_j <= mu - side`` for every vertex of the obstacle part;
    - soft pairs: ``n . V >= mu + demand - sigma`` instead, with a penetration ``sigma >= 0``, m, of the pair's own.

    Samples of interval k: x_k, the states after each of its pieces but the last, and x_{k+1}; S in all. A demand is
    ``constant + weight * cover``, where the cover is the vehicle's acceleration bound times the piece's duration
    squared over 8 (see :meth:`tightspot.vehicles.VehicleModel.acceleration_bound`).

    An obstacle part may move: its frame's pose at a sample is ``motion_poses + (t_f - motion_times) motion_slopes``.
    Its vertices, and the lines of its pairs, are in that frame.

    SI units; N intervals, n_x states, n_u inputs.

    Attributes:
        model: Name of the compiled model: ``"single_track"``.
        parameters: The model's numbers.
        widths: Fractions of the horizon, (N,).
        pieces: Sub-intervals of each interval, (N,).
        substeps: Runge-Kutta steps of each piece, (N,).
        time_weight: r.
        input_weights: Diagonal of P, (n_u,).
        time_scaled: c = t_f; otherwise c = 1.
        state_low: (n_x,), infinite where free; hold at all knots, where start and goal leave the state free.
        state_high: (n_x,).
        input_low: (n_u,).
        input_high: (n_u,).
        time_low: Bounds of t_f; equal: fixed.
        time_high: See ``time_low``.
        start: (n_x,), NaN where free.
        goal: (n_x,), NaN where free.
        part_vertices: Body-frame vertices of all parts, (.., 2).
        part_first: First vertex of each part, and the number of vertices at the end, (parts + 1,).
        part_radii: Largest distance of a vertex from its frame's origin, (parts,).
        obstacle_vertices: (.., 2).
        obstacle_first: (obstacle parts + 1,).
        pairs: (interval, part, obstacle part) of each pair, sorted, (n, 3).
        pair_origins: The point that mu is measured from, which improves conditioning only, (n, 2).
        pair_sides: (constant, weight) of the demand on the obstacle's side, (n, 2).
        pair_penalties: (constant, weight of t_f) of what 1 m of a pair's penetration costs, positive, NaN where none is
            allowed, (n, 2).
        walls: (interval, part), sorted, (w, 2).
        wall_lines: (normal, offset) of the half-planes ``normal . q <= offset``, (w, 3).
        pair_demands: (constant, weight) at each sample, NaN where no row stands, (S, 2).
        wall_demands: The same for walls, (S, 2).
        states: Starting point, (N + 1, n_x).
        inputs: (N, n_u).
        final_time: s.
        lines: (phi, mu) of each pair, mu measured from the world's origin, (n, 2).
        penetrations: m, 0 for pairs that allow none, (n,).
        form: How x and the multipliers of reports write lines.
        pair_extras: What is demanded on the body's side beyond ``pair_demands``, m, (n,); empty: nothing.
        motion_obstacles: The obstacle parts that move, (M,).
        motion_times: The final time for which poses are given, s, (M,).
        motion_poses: (x, y, theta) of each one's frame at each sample, (M, S, 3).
        motion_slopes: Their derivatives with respect to t_f, (M, S, 3).
    """

    model: str
    parameters: Array
    widths: Array
    pieces: Integers
    substeps: Integers
    time_weight: float
    input_weights: Array
    time_scaled: bool
    state_low: Array
    state_high: Array
    input_low: Array
    input_high: Array
    time_low: float
    time_high: float
    start: Array
    goal: Array
    part_vertices: Array
    part_first: Integers
    part_radii: Array
    obstacle_vertices: Array
    obstacle_first: Integers
    pairs: Integers
    pair_origins: Array
    pair_sides: Array
    pair_penalties: Array
    walls: Integers
    wall_lines: Array
    pair_demands: Array
    wall_demands: Array
    states: Array
    inputs: Array
    final_time: float
    lines: Array
    penetrations: Array
    form: LineForm
    pair_extras: Array = field(default_factory=lambda: np.zeros(0))
    motion_obstacles: Integers = field(default_factory=lambda: np.zeros(0, np.int64))
    motion_times: Array = field(default_factory=lambda: np.zeros(0))
    motion_poses: Array = field(default_factory=lambda: np.zeros((0, 0, 3)))
    motion_slopes: Array = field(default_factory=lambda: np.zeros((0, 0, 3)))

    @property
    def steps(self) -> int:
        """N."""
        return int(self.widths.size)

    @property
    def soft(self) -> NDArray[np.bool_]:
        """Which pairs may penetrate, (n,)."""
        return ~np.isnan(self.pair_penalties[:, 0])

    def starting_point(self) -> Array:
        """The core's variables: states, inputs, t_f, (phi, mu) of each pair, mu from its origin, sigma of soft ones."""
        return self.variables(self.states, self.inputs, self.final_time, self.lines, self.penetrations)

    def variables(self, states: Array, inputs: Array, final_time: float, lines: Array, penetrations: Array) -> Array:
        """The core's variables from states, inputs, t_f, world lines and every pair's penetration."""
        lines = self._shifted(lines, -1.0).ravel()
        return np.concatenate([states.ravel(), inputs.ravel(), [final_time], lines, penetrations[self.soft]])

    def unpack(self, v: Array) -> tuple[Array, Array, float, Array, Array]:
        """States, inputs, t_f, world lines and every pair's penetration from the core's variables."""
        n_x, n_u, steps, n = self.start.size, self.input_weights.size, self.steps, len(self.pairs)
        states, rest = v[: (steps + 1) * n_x].reshape(steps + 1, n_x), v[(steps + 1) * n_x :]
        inputs, rest = rest[: steps * n_u].reshape(steps, n_u), rest[steps * n_u :]
        lines, penetrations = self._shifted(rest[1 : 1 + 2 * n].reshape(n, 2), 1.0), np.zeros(n)
        if rest.size > 1 + 2 * n:
            penetrations[self.soft] = rest[1 + 2 * n :]
        return states, inputs, float(rest[0]), lines, penetrations

    def frames(self, final_time: float) -> Array:
        """Poses of the moving obstacles' frames at each sample, (M, S, 3)."""
        ahead = final_time - self.motion_times
        return np.ascontiguousarray(self.motion_poses + ahead[:, None, None] * self.motion_slopes)

    def poses_at_ends(self, states: Array, final_time: float) -> Array:
        """The vehicle's pose at the end of each pair's interval, (n, 3), in the frame of the obstacle if that moves."""
        poses = states[self.pairs[:, 0] + 1, :3]
        last = np.cumsum(self.pieces + 1) - 1
        for obstacle, frames in zip(self.motion_obstacles, self.frames(final_time), strict=True):
            mine = self.pairs[:, 2] == obstacle
            poses[mine] = seen_from(poses[mine], frames[last[self.pairs[mine, 0]]])
        return poses

    def _shifted(self, lines: Array, sign: float) -> Array:
        phi, origins = lines[:, 0], self.pair_origins
        shifted = np.array(lines, float)
        shifted[:, 1] += sign * (np.cos(phi) * origins[:, 0] + np.sin(phi) * origins[:, 1])
        return shifted

    def differs_in_ends_only(self, other: StageProblem) -> bool:
        """True if all arrays but start, goal and the starting point are the very same objects in both."""
        return all(mine is others for mine, others in zip(_REST(self), _REST(other), strict=True))

    def with_pairs(self, chosen: slice | NDArray[np.bool_]) -> StageProblem:
        """With the chosen ones of the pairs only."""
        names = ["pairs", "pair_origins", "pair_sides", "pair_penalties", "lines", "penetrations"]
        if self.pair_extras.size:
            names.append("pair_extras")
        return self.replaced(**{name: getattr(self, name)[chosen] for name in names})

    def softened(self, penalties: Array) -> StageProblem:
        """With every pair allowed to penetrate, at a cost of (constant, weight of t_f), (n, 2)."""
        return self.replaced(pair_penalties=penalties, form=LineForm())

    def replaced(self, **changes: Any) -> StageProblem:
        """A copy with other arrays."""
        if not changes.keys() <= self.__dict__.keys():
            raise TypeError(f"a StageProblem has no {', '.join(changes.keys() - self.__dict__.keys())}")
        return StageProblem.of(**(self.__dict__ | changes))

    @classmethod
    def of(cls, **arrays: Any) -> StageProblem:
        """As the constructor with all attributes, without its detours."""
        made = object.__new__(cls)
        made.__dict__.update(arrays)
        return made


_ENDS_AND_POINT = {"start", "goal", "states", "inputs", "final_time", "lines", "penetrations"}
_REST = attrgetter(*(one.name for one in fields(StageProblem) if one.name not in _ENDS_AND_POINT))
