"""Assembles the symbols of the nonlinear program, stage by stage. Its numbers come from :mod:`.numbers`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from tightspot.formulations.base import Pair, Pose, at_most
from tightspot.solvers.nlp import RowBlock, Stage, concatenate
from tightspot.transcription.grid import TimeGrid
from tightspot.transcription.integrators import rk4
from tightspot.vehicles.base import BodyPart, VehicleModel

if TYPE_CHECKING:
    from tightspot.transcription.transcribe import Settings

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Shape:
    """All that the symbols depend on beyond vehicle, settings and grid.

    Attributes:
        obstacles: Number of vertices of each obstacle part.
        walls_pattern: True where the half-planes of W have an entry other than 0, (edges, 2).
        active: Pairs in the program, (N, parts, obstacle parts).
        walls: Half-planes of W in the program, (N, parts, edges).
        fixed_poses: Whether the poses at the start and at the goal are given.
        moving: How many of the obstacle parts move; they are the last ones.
    """

    obstacles: tuple[int, ...]
    walls_pattern: NDArray[np.bool_]
    active: NDArray[np.bool_]
    walls: NDArray[np.bool_]
    fixed_poses: tuple[bool, bool]
    moving: int = 0


class Motion(NamedTuple):
    """A moving obstacle's parameters, see :class:`tightspot.transcription.moving.MotionArrays`: (S, 3), (S, 3), 1 and
    (N, parts)."""

    poses: Any
    slopes: Any
    time: Any
    extras: Any


@dataclass(frozen=True, eq=False)
class Symbols:
    """A program without its numbers and names: what an :class:`~tightspot.solvers.Nlp` of the same fields says, and
    the places of the pairs' auxiliary variables by (interval, part, obstacle part)."""

    x: Any
    p: Any
    f: Any
    g: Any
    lbg: Array
    ubg: Array
    stages: tuple[Stage, ...]
    blocks: tuple[RowBlock, ...]
    shared: slice
    lines: Mapping[tuple[int, int, int], slice]


class Builder:
    """Collects variables and rows in stage order. Used once."""

    def __init__(self, vehicle: VehicleModel, settings: Settings, grid: TimeGrid, shape: Shape) -> None:
        self.vehicle, self.settings, self.grid, self.shape = vehicle, settings, grid, shape
        self.x: list[Any] = []
        self.g: list[Any] = []
        self.lbg: list[Array] = []
        self.ubg: list[Array] = []
        self.blocks: list[RowBlock] = []
        self.n = self.m = 0
        self.penalty: Any = 0.0
        self.final_time = ca.SX.sym("t_f")
        self.pieces, self.whole = settings.pieces(grid.steps), settings.whole(grid.steps)
        self._parameters()
        self.lines: dict[tuple[int, int, int], slice] = {}

    def _parameters(self) -> None:
        """Numbers that may change without rebuilding: weights, margins, obstacles, W."""
        self.time_weight = ca.SX.sym("r")
        self.weights = ca.SX.sym("P", self.vehicle.n_inputs)
        self.margin, self.end_margin, self.workspace_margin = (
            ca.SX.sym(name) for name in ("margin", "end_margin", "workspace_margin")
        )
        self.penalty_weight = ca.SX.sym("penalty_weight")
        self.p = [self.time_weight, self.weights, self.margin, self.end_margin, self.workspace_margin]
        self.p.append(self.penalty_weight)
        self.obstacle_symbols = []
        for index, count in enumerate(self.shape.obstacles):
            symbols = (
                ca.SX.sym(f"O{index}", count, 2),
                ca.SX.sym(f"A{index}", count, 2),
                ca.SX.sym(f"b{index}", count),
            )
            self.obstacle_symbols.append(symbols)
            self.p += [ca.vec(symbol) for symbol in symbols]
        pattern = ca.sparsify(ca.DM(self.shape.walls_pattern.astype(float))).sparsity()
        entries = ca.SX.sym("E", pattern.nnz())
        self.wall_normals, self.wall_offsets = ca.SX(pattern, entries), ca.SX.sym("f", len(self.shape.walls_pattern))
        self.p += [entries, self.wall_offsets]
        self.motions: dict[int, Motion] = {}
        samples, parts = sum(self.pieces) + self.grid.steps, len(self.vehicle.parts)
        for index in range(len(self.shape.obstacles) - self.shape.moving, len(self.shape.obstacles)):
            motion = Motion(
                ca.SX.sym(f"Q{index}", samples, 3),
                ca.SX.sym(f"dQ{index}", samples, 3),
                ca.SX.sym(f"t_ref{index}"),
                ca.SX.sym(f"e{index}", self.grid.steps, parts),
            )
            self.motions[index] = motion
            self.p += [ca.vec(symbol) for symbol in motion]

    def build(self) -> Symbols:
        """The program's symbols."""
        steps, settings = self.grid.steps, self.settings
        states: list[Any] = []
        inputs: list[Any] = []
        stages: list[Stage] = []
        for k in range(steps + 1):
            state, state_slice = self._variables(f"xi{k}", self.vehicle.n_states)
            states.append(state)
            control_slice = slice(self.n, self.n)
            if k < steps:
                control, control_slice = self._variables(f"u{k}", self.vehicle.n_inputs)
                inputs.append(control)
            first_row = self.m
            driven = self._driven(k, states, inputs) if k > 0 else []
            auxiliary = self._path_rows(k, states, inputs, driven)
            path, first_row = slice(first_row, self.m), self.m
            if k > 0:
                self._dynamics(k, driven[-1], states[k])
                stages[-1] = _with_dynamics(stages[-1], slice(first_row, self.m))
            stages.append(Stage(k, state_slice, control_slice, auxiliary, slice(self.m, self.m), path))
        shared = slice(self.n, self.n + 1)
        self.x.append(self.final_time)
        f = settings.objective.expression(inputs, self.final_time, self.grid, self.time_weight, self.weights)
        f += self.penalty_weight * self.penalty
        return Symbols(
            ca.vertcat(*self.x), ca.vertcat(*self.p), f, ca.vertcat(*self.g), concatenate(self.lbg),
            concatenate(self.ubg), tuple(stages), tuple(self.blocks), shared, self.lines,
        )  # fmt: skip

    def _variables(self, name: str, count: int) -> tuple[Any, slice]:
        symbol = ca.SX.sym(name, count)
        place = slice(self.n, self.n + count)
        self.x.append(symbol)
        self.n += count
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

    def _path_rows(self, k: int, states: list[Any], inputs: list[Any], driven: list[Any]) -> slice:
        """W and separation rows that hold at knot k or on the interval that ends there; none at the start."""
        first = self.n
        if k > 0:
            samples = [states[k - 1], *driven[:-1], states[k]] if self.whole[k - 1] else [states[k]]
            fixed = [False] * len(samples)
            fixed[0] = self.shape.fixed_poses[0] and k == 1 and len(samples) > 1
            fixed[-1] = self.shape.fixed_poses[1] and k == self.grid.steps
            covers = [self._cover(k, part, states, inputs) for part in self.vehicle.parts]
            for part_index in range(len(self.vehicle.parts)):
                self._workspace_rows(k, part_index, samples, fixed, covers[part_index])
                for obstacle_index in np.flatnonzero(self.shape.active[k - 1, part_index]):
                    self._separation_rows(k, part_index, int(obstacle_index), samples, fixed, covers[part_index])
        return slice(first, self.n)

    def _poses(self, part: BodyPart, samples: list[Any]) -> tuple[Pose, ...]:
        return tuple(Pose(*self.vehicle.frames(ca.vertsplit(state), ca)[part.frame]) for state in samples)

    def _seen(self, k: int, poses: tuple[Pose, ...], motion: Motion) -> tuple[Pose, ...]:
        """Poses on interval [t_{k-1}, t_k], seen from a moving obstacle's frame; one alone is that at t_k."""
        last = sum(self.pieces[:k]) + k - 1
        seen = []
        for sample, pose in zip(range(last + 1 - len(poses), last + 1), poses, strict=True):
            x, y, theta = ca.horzsplit(
                motion.poses[sample, :] + (self.final_time - motion.time) * motion.slopes[sample, :]
            )
            c, s, dx, dy = ca.cos(theta), ca.sin(theta), pose.x - x, pose.y - y
            seen.append(Pose(c * dx + s * dy, c * dy - s * dx, pose.theta - theta))
        return tuple(seen)

    def _cover(self, k: int, part: BodyPart, states: list[Any], inputs: list[Any]) -> Any:
        """How far a point of the part can leave its chord between two poses of interval [t_{k-1}, t_k], m.

        A function with ``|f''| <= P`` leaves its linear interpolation over h by at most ``P h^2 / 8``.
        """
        if not self.whole[k - 1]:
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
        part, walls = self.vehicle.parts[part_index], self.shape.walls[k - 1, part_index]
        if not walls.any():
            return
        chosen = [int(edge) for edge in np.flatnonzero(walls)]
        E, f = self.wall_normals[chosen, :], self.wall_offsets[chosen]
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
    ) -> None:
        part, corners = self.vehicle.parts[part_index], self.shape.obstacles[obstacle_index]
        formulation = self.settings.formulation
        margin = self.margin + cover
        margins = tuple(self.end_margin if end else margin for end in fixed)
        symbols = self.obstacle_symbols[obstacle_index]
        poly = part.polygon
        poses = self._poses(part, samples)
        if obstacle_index in self.motions:
            motion = self.motions[obstacle_index]
            poses = self._seen(k, poses, motion)
            margins = tuple(demanded + motion.extras[k - 1, part_index] for demanded in margins)
        pair = Pair(poses, poly.vertices, poly.A, poly.b, *symbols, margins)
        count = formulation.auxiliary_bounds(len(poly.vertices), corners)[0].size
        auxiliary, place = self._variables(f"aux{k}_{part_index}_{obstacle_index}", count)
        self.lines[k - 1, part_index, obstacle_index] = place
        self.penalty += self.final_time * float(self.grid.widths[k - 1]) * formulation.penalty(auxiliary)
        for index, rows in enumerate(formulation.rows(auxiliary, pair)):
            self._rows(*rows, "separation", k, part.name, (part_index, obstacle_index, index))


def _with_dynamics(stage: Stage, rows: slice) -> Stage:
    return Stage(stage.k, stage.state, stage.control, stage.auxiliary, rows, stage.path)
