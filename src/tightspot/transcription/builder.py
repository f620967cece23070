"""Assembles the nonlinear program stage by stage."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from tightspot.formulations.base import Pair, Pose, at_most
from tightspot.geometry.polygon import ConvexPolygon
from tightspot.solvers.nlp import Nlp, RowBlock, Stage, concatenate
from tightspot.trajectory import Trajectory
from tightspot.transcription.grid import TimeGrid
from tightspot.transcription.integrators import rk4
from tightspot.vehicles.base import BodyPart, VehicleModel

if TYPE_CHECKING:
    from tightspot.transcription.transcribe import Settings

Array = NDArray[np.float64]


class Builder:
    """Collects variables, rows, bounds and starting values in stage order. Used once."""

    def __init__(
        self,
        vehicle: VehicleModel,
        workspace: ConvexPolygon,
        obstacles: Sequence[ConvexPolygon],
        settings: Settings,
        grid: TimeGrid,
        active: NDArray[np.bool_],
        walls: NDArray[np.bool_],
        names: Sequence[str],
    ) -> None:
        self.names = names
        self.vehicle, self.workspace, self.obstacles = vehicle, workspace, obstacles
        self.settings, self.grid, self.active, self.walls = settings, grid, active, walls
        self.x: list[Any] = []
        self.lbx: list[Array] = []
        self.ubx: list[Array] = []
        self.x0: list[Array] = []
        self.g: list[Any] = []
        self.lbg: list[Array] = []
        self.ubg: list[Array] = []
        self.blocks: list[RowBlock] = []
        self.n = self.m = 0
        self.penalty: Any = 0.0
        self.final_time = ca.SX.sym("t_f")
        self._parameters()
        self.pieces = settings.pieces(grid.steps)
        self.lines: dict[tuple[int, int, int], slice] = {}

    def _parameters(self) -> None:
        """Numbers that may change without rebuilding: weights, margins, obstacles."""
        objective, settings = self.settings.objective, self.settings
        self.time_weight = ca.SX.sym("r")
        self.weights = ca.SX.sym("P", self.vehicle.n_inputs)
        self.margin, self.end_margin, self.workspace_margin = (
            ca.SX.sym(name) for name in ("margin", "end_margin", "workspace_margin")
        )
        self.penalty_weight = ca.SX.sym("penalty_weight")
        self.p = [self.time_weight, self.weights, self.margin, self.end_margin, self.workspace_margin]
        self.p.append(self.penalty_weight)
        end = settings.margin if settings.end_margin is None else settings.end_margin
        margins = [settings.margin, end, settings.workspace_margin]
        self.p0: list[Array] = [
            np.array([objective.time_weight, *objective.input_weights, *margins, settings.penalty_weight])
        ]
        self.obstacle_symbols = []
        for index, polygon in enumerate(self.obstacles):
            count = len(polygon.vertices)
            symbols = (
                ca.SX.sym(f"O{index}", count, 2),
                ca.SX.sym(f"A{index}", count, 2),
                ca.SX.sym(f"b{index}", count),
            )
            self.obstacle_symbols.append(symbols)
            self.p += [ca.vec(symbol) for symbol in symbols]
            self.p0 += [polygon.vertices.ravel("F"), polygon.A.ravel("F"), polygon.b]

    def build(self, start: Array, goal: Array, guess: Trajectory) -> Nlp:
        """The program from start (n_x,) to goal (n_x,), NaN meaning free, started at the guess on the grid."""
        steps, settings = self.grid.steps, self.settings
        low, high = self._state_bounds()
        states: list[Any] = []
        inputs: list[Any] = []
        stages: list[Stage] = []
        fixed_poses = (not np.isnan(start[:3]).any(), not np.isnan(goal[:3]).any())
        for k in range(steps + 1):
            fixed = start if k == 0 else goal if k == steps else np.full(low.size, np.nan)
            lower, upper = np.where(np.isnan(fixed), low, fixed), np.where(np.isnan(fixed), high, fixed)
            state, state_slice = self._variables(f"xi{k}", lower, upper, guess.states[k])
            states.append(state)
            control_slice = slice(self.n, self.n)
            if k < steps:
                control, control_slice = self._variables(f"u{k}", *self.vehicle.input_bounds, guess.inputs[k])
                inputs.append(control)
            first_row = self.m
            driven = self._driven(k, states, inputs) if k > 0 else []
            auxiliary = self._path_rows(k, states, inputs, driven, guess, fixed_poses)
            path, first_row = slice(first_row, self.m), self.m
            if k > 0:
                self._dynamics(k, driven[-1], states[k])
                stages[-1] = _with_dynamics(stages[-1], slice(first_row, self.m))
            stages.append(Stage(k, state_slice, control_slice, auxiliary, slice(self.m, self.m), path))
        low_time, high_time = settings.final_time_bounds
        shared = slice(self.n, self.n + 1)
        self._append(self.final_time, np.array([low_time]), np.array([high_time]), np.array([guess.duration]))
        f = settings.objective.expression(inputs, self.final_time, self.grid, self.time_weight, self.weights)
        f += self.penalty_weight * self.penalty
        return Nlp(
            ca.vertcat(*self.x), ca.vertcat(*self.p), f, ca.vertcat(*self.g),
            concatenate(self.lbx), concatenate(self.ubx), concatenate(self.lbg), concatenate(self.ubg),
            concatenate(self.x0), concatenate(self.p0), tuple(stages), tuple(self.blocks), shared,
        )  # fmt: skip

    def _state_bounds(self) -> tuple[Array, Array]:
        low, high = (bound.copy() for bound in self.vehicle.state_bounds)
        limit = self.settings.heading_limit
        low[2], high[2] = max(low[2], -limit), min(high[2], limit)
        return low, high

    def _append(self, symbol: Any, lower: Array, upper: Array, start: Array) -> None:
        self.x.append(symbol)
        self.lbx.append(lower)
        self.ubx.append(upper)
        self.x0.append(np.clip(start, lower, upper))
        self.n += lower.size

    def _variables(self, name: str, lower: Array, upper: Array, start: Array) -> tuple[Any, slice]:
        symbol = ca.SX.sym(name, lower.size)
        place = slice(self.n, self.n + lower.size)
        self._append(symbol, lower, upper, start)
        return symbol, place

    def _rows(
        self,
        expression: Any,
        lower: Array,
        upper: Array,
        kind: str,
        knot: int,
        detail: str = "",
        key: tuple[int, ...] = (),
    ) -> None:
        self.g.append(ca.vec(expression))
        self.lbg.append(lower)
        self.ubg.append(upper)
        self.blocks.append(RowBlock(slice(self.m, self.m + lower.size), kind, knot, detail, key))
        self.m += lower.size

    def _driven(self, k: int, states: list[Any], inputs: list[Any]) -> list[Any]:
        """States integrated from the beginning of interval [t_{k-1}, t_k] to the ends of its sub-intervals."""
        pieces = self.pieces[k - 1]
        step = self.final_time * float(self.grid.widths[k - 1]) / pieces
        substeps = -(-self.settings.substeps // pieces)
        driven = [states[k - 1]]
        for _ in range(pieces):
            driven.append(rk4(self.vehicle, driven[-1], inputs[k - 1], step, substeps))
        return driven[1:]

    def _dynamics(self, k: int, after: Any, state: Any) -> None:
        zero = np.zeros(self.vehicle.n_states)
        self._rows(after - state, zero, zero, "dynamics", k)

    def _path_rows(
        self,
        k: int,
        states: list[Any],
        inputs: list[Any],
        driven: list[Any],
        guess: Trajectory,
        fixed_poses: tuple[bool, bool],
    ) -> slice:
        """W and separation rows that hold at knot k or on the interval that ends there; none at the start."""
        first = self.n
        if k > 0:
            knots_only = self.settings.formulation.holds == "knots"
            samples = [states[k]] if knots_only else [states[k - 1], *driven[:-1], states[k]]
            fixed = [False] * len(samples)
            fixed[0] = fixed_poses[0] and k == 1 and len(samples) > 1
            fixed[-1] = fixed_poses[1] and k == self.grid.steps
            covers = [self._cover(k, part, states, inputs) for part in self.vehicle.parts]
            for part_index in range(len(self.vehicle.parts)):
                self._workspace_rows(k, part_index, samples, fixed, covers[part_index])
                for obstacle_index in np.flatnonzero(self.active[k - 1, part_index]):
                    self._separation_rows(k, part_index, int(obstacle_index), samples, fixed, covers[part_index], guess)
        return slice(first, self.n)

    def _poses(self, part: BodyPart, samples: list[Any]) -> tuple[Pose, ...]:
        return tuple(Pose(*self.vehicle.frames(ca.vertsplit(state), ca)[part.frame]) for state in samples)

    def _cover(self, k: int, part: BodyPart, states: list[Any], inputs: list[Any]) -> Any:
        """How far a point of the part can leave its chord between two poses of interval [t_{k-1}, t_k], m.

        A function with ``|f''| <= P`` leaves its linear interpolation over h by at most ``P h^2 / 8``.
        """
        if self.settings.formulation.holds == "knots":
            return 0.0
        step = self.final_time * float(self.grid.widths[k - 1])
        middle = ca.vertsplit((states[k - 1] + states[k]) / 2)
        control = ca.vertsplit(inputs[k - 1])
        bound = self.vehicle.acceleration_bound(part.frame, part.polygon.radius, middle, control, step / 2, ca)
        return bound * (step / self.pieces[k - 1]) ** 2 / 8

    def _workspace_rows(self, k: int, part_index: int, samples: list[Any], fixed: list[bool], cover: Any) -> None:
        """Eq. (13): every vertex of the part satisfies E q <= f, for the half-planes that are in the program.

        With a cover the rows stand at both ends of the interval: the cover is the interval's own.
        """
        part, walls = self.vehicle.parts[part_index], self.walls[k - 1, part_index]
        if not walls.any():
            return
        E, f = ca.DM(self.workspace.A[walls]), ca.DM(self.workspace.b[walls])
        demanded = self.workspace_margin + cover
        given_start = k == 1 and len(samples) > 1 and fixed[0]
        for index, (pose, state_fixed) in enumerate(zip(self._poses(part, samples), fixed, strict=True)):
            if index == 0 and given_start:
                continue
            pair = Pair((pose,), part.polygon.vertices, part.polygon.A, part.polygon.b, None, None, None, (0,))
            outside = pair.body_vertices(0) @ E.T - ca.repmat(f.T, len(part.polygon.vertices), 1)
            rows = at_most(outside + (0.0 if state_fixed else demanded))
            self._rows(*rows, "workspace", k, part.name, (part_index, index))

    def _separation_rows(
        self,
        k: int,
        part_index: int,
        obstacle_index: int,
        samples: list[Any],
        fixed: list[bool],
        cover: Any,
        guess: Trajectory,
    ) -> None:
        part, polygon = self.vehicle.parts[part_index], self.obstacles[obstacle_index]
        formulation = self.settings.formulation
        margin = self.margin + cover
        margins = tuple(self.end_margin if end else margin for end in fixed)
        symbols = self.obstacle_symbols[obstacle_index]
        poly = part.polygon
        pair = Pair(self._poses(part, samples), poly.vertices, poly.A, poly.b, *symbols, margins)
        lower, upper = formulation.auxiliary_bounds(len(poly.vertices), len(polygon.vertices))
        start = formulation.start(self._guess_poses(k, part, guess), poly, polygon)[0]
        auxiliary, place = self._variables(f"aux{k}_{part_index}_{obstacle_index}", lower, upper, start)
        self.lines[k - 1, part_index, obstacle_index] = place
        self.penalty += self.final_time * float(self.grid.widths[k - 1]) * formulation.penalty(auxiliary)
        detail = f"{part.name} against {self.names[obstacle_index]}"
        for index, rows in enumerate(formulation.rows(auxiliary, pair)):
            self._rows(*rows, "separation", k, detail, (part_index, obstacle_index, index))

    def _guess_poses(self, k: int, part: BodyPart, guess: Trajectory) -> Array:
        """The guess's poses of a part on interval [t_{k-1}, t_k], (1, P, 3)."""
        if self.settings.formulation.holds == "knots":
            states = guess.states[k : k + 1]
        else:
            weights = np.linspace(0.0, 1.0, self.pieces[k - 1] + 1)[:, None]
            states = (1 - weights) * guess.states[k - 1] + weights * guess.states[k]
        x, y, theta = self.vehicle.frames(list(states.T), np)[part.frame]
        return np.column_stack([x, y, theta])[None]


def _with_dynamics(stage: Stage, rows: slice) -> Stage:
    return Stage(stage.k, stage.state, stage.control, stage.auxiliary, rows, stage.path)
