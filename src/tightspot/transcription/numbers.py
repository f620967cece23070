"""The numbers of a nonlinear program: bounds, starting point and parameters, for symbols that are built already."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tightspot.geometry.polygon import ConvexPolygon
from tightspot.geometry.transforms import seen_from
from tightspot.solvers.nlp import Nlp, RowBlock
from tightspot.trajectory import Trajectory
from tightspot.transcription.builder import Symbols
from tightspot.transcription.moving import MotionArrays
from tightspot.vehicles.base import BodyPart, VehicleModel

if TYPE_CHECKING:
    from tightspot.transcription.transcribe import Settings

Array = NDArray[np.float64]


def with_numbers(
    symbols: Symbols,
    vehicle: VehicleModel,
    workspace: ConvexPolygon,
    named: Sequence[tuple[str, ConvexPolygon]],
    settings: Settings,
    start: Array,
    goal: Array,
    guess: Trajectory,
    moving: MotionArrays,
) -> Nlp:
    """The program from start (n_x,) to goal (n_x,), NaN meaning free, started at the guess on the program's grid.

    ``named`` are all obstacle parts with their names, those that move last.
    """
    obstacles = [polygon for _, polygon in named]
    count = symbols.x.numel()
    lower, upper, first = np.full(count, -np.inf), np.full(count, np.inf), np.zeros(count)
    low, high = state_bounds(vehicle, settings)
    for stage in symbols.stages:
        last = stage.k == len(symbols.stages) - 1
        given = start if stage.k == 0 else goal if last else np.full(low.size, np.nan)
        lower[stage.state], upper[stage.state] = (np.where(np.isnan(given), bound, given) for bound in (low, high))
        first[stage.state] = guess.states[stage.k]
        if not last:
            lower[stage.control], upper[stage.control] = vehicle.input_bounds
            first[stage.control] = guess.inputs[stage.k]
    lower[symbols.shared], upper[symbols.shared] = settings.final_time_bounds
    first[symbols.shared] = guess.duration
    steps = len(symbols.stages) - 1
    pieces, whole = settings.pieces(steps), settings.whole(steps)
    final_time = float(np.clip(guess.duration, *settings.final_time_bounds))
    frames = dict(zip(moving.obstacles, moving.frames(final_time), strict=True))
    for (k, part, obstacle), place in symbols.lines.items():
        body, polygon = vehicle.parts[part], obstacles[obstacle]
        sizes = len(body.polygon.vertices), len(polygon.vertices)
        lower[place], upper[place] = settings.formulation.auxiliary_bounds(*sizes)
        poses = _guess_poses(vehicle, body, guess, k, pieces[k] if whole[k] else 0)
        if obstacle in frames:
            after = sum(pieces[: k + 1]) + k + 1
            poses = seen_from(poses, frames[obstacle][after - poses.shape[1] : after])
        first[place] = settings.formulation.start(poses, body.polygon, polygon)[0]
    return Nlp(
        symbols.x, symbols.p, symbols.f, symbols.g, lower, upper, symbols.lbg, symbols.ubg,
        np.clip(first, lower, upper), _parameters(workspace, obstacles, settings, moving), symbols.stages,
        _named(symbols, [name for name, _ in named]), symbols.shared,
    )  # fmt: skip


def _named(symbols: Symbols, names: Sequence[str]) -> tuple[RowBlock, ...]:
    """The blocks with the obstacles' names: "body against wall/0"."""
    return tuple(
        replace(block, detail=f"{block.detail} against {names[block.key[1]]}") if block.kind == "separation" else block
        for block in symbols.blocks
    )


def state_bounds(vehicle: VehicleModel, settings: Settings) -> tuple[Array, Array]:
    """The vehicle's, with the settings' bound of the heading."""
    low, high = (bound.copy() for bound in vehicle.state_bounds)
    low[2], high[2] = max(low[2], -settings.heading_limit), min(high[2], settings.heading_limit)
    return low, high


def _parameters(
    workspace: ConvexPolygon, obstacles: Sequence[ConvexPolygon], settings: Settings, moving: MotionArrays
) -> Array:
    objective = settings.objective
    end = settings.margin if settings.end_margin is None else settings.end_margin
    margins = [settings.margin, end, settings.workspace_margin]
    p = [np.array([objective.time_weight, *objective.input_weights, *margins, settings.penalty_weight])]
    for polygon in obstacles:
        p += [polygon.vertices.ravel("F"), polygon.A.ravel("F"), polygon.b]
    normals = workspace.A.ravel("F")
    return np.concatenate([*p, normals[normals != 0], workspace.b, *moving.numbers()])


def _guess_poses(vehicle: VehicleModel, part: BodyPart, guess: Trajectory, k: int, pieces: int) -> Array:
    """The guess's poses of a part on interval [t_k, t_{k+1}], (1, P, 3); without pieces the last one alone."""
    if pieces == 0:
        states = guess.states[k + 1 : k + 2]
    else:
        weights = np.linspace(0.0, 1.0, pieces + 1)[:, None]
        states = (1 - weights) * guess.states[k] + weights * guess.states[k + 1]
    x, y, theta = vehicle.frames(list(states.T), np)[part.frame]
    return np.column_stack([x, y, theta])[None]
