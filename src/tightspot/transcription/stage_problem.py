"""The same program as :func:`tightspot.transcription.transcribe` writes, as plain arrays for the stagewise solver."""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem
from tightspot.formulations import (
    Formulation,
    SeparatingLine,
    SoftSweptUnitNormalLine,
    SoftUnitNormalLine,
    SweptLine,
    SweptUnitNormalLine,
    UnitNormalLine,
)
from tightspot.geometry.stack import PolygonStack
from tightspot.geometry.transforms import nearest_angle
from tightspot.scenarios.scenario import Scenario
from tightspot.solvers.stage_core import compiled
from tightspot.solvers.stage_lines import start_lines
from tightspot.solvers.stage_problem import LineForm, StageProblem
from tightspot.trajectory import Trajectory
from tightspot.transcription.grid import TimeGrid
from tightspot.transcription.motions import ObstacleMotion
from tightspot.transcription.moving import MotionArrays, with_moving
from tightspot.transcription.objective import EnergyForm
from tightspot.transcription.sampling import resample
from tightspot.transcription.transcribe import Settings, _misfits, _with_usable_margins
from tightspot.vehicles.base import VehicleModel
from tightspot.vehicles.single_track import SingleTrack

Array = NDArray[np.float64]

_FORMS: dict[type[Formulation], LineForm] = {
    UnitNormalLine: LineForm(in_body=True, body_first=True),
    SeparatingLine: LineForm(vector=True, body_first=True),
    SweptUnitNormalLine: LineForm(),
    SweptLine: LineForm(vector=True),
    SoftUnitNormalLine: LineForm(),
    SoftSweptUnitNormalLine: LineForm(),
}
_SOFT = (SoftUnitNormalLine, SoftSweptUnitNormalLine)


def fits_stages(vehicle: VehicleModel, formulation: Formulation) -> bool:
    """True if the stagewise solver has the vehicle's model compiled in and can write the formulation's lines."""
    return type(vehicle) is SingleTrack and type(formulation) in _FORMS


def stage_problem(
    scenario: Scenario,
    vehicle: VehicleModel,
    guess: Trajectory,
    settings: Settings,
    *,
    grid: TimeGrid,
    active: NDArray[np.bool_] | None = None,
    walls: NDArray[np.bool_] | None = None,
    start: Array | None = None,
    goal: Array | None = None,
    motions: Sequence[ObstacleMotion] = (),
) -> StageProblem:
    """The arguments of :func:`tightspot.transcription.transcribe`, and the same program, without any symbols.

    Raises:
        InputError: An argument does not fit the others, or the stagewise solver does not know the vehicle's model or
            the formulation (see :func:`fits_stages`).
        BuildError: The compiled core is missing.
    """
    obstacles = with_moving(scenario.obstacle_polygons, motions)
    shape = (grid.steps, len(vehicle.parts))
    active = np.ones((*shape, len(obstacles)), bool) if active is None else active
    walls = np.ones((*shape, len(scenario.workspace.b)), bool) if walls is None else walls
    start = np.array(scenario.start if start is None else start, float)
    goal = np.array(scenario.goal if goal is None else goal, float)
    problems = _misfits(vehicle, guess, settings, {"start": start, "goal": goal})
    for name, mask, last in (("active", active, len(obstacles)), ("walls", walls, len(scenario.workspace.b))):
        if mask.shape != (*shape, last):
            problems.append(Problem(name, f"has shape {mask.shape}, but this problem needs {(*shape, last)}"))
    if not fits_stages(vehicle, settings.formulation):
        sentence = f"the stagewise solver takes neither {type(vehicle).__name__} with {settings.formulation.name}"
        problems.append(Problem("solver", f"{sentence}; choose single-track with a line formulation, or ipopt"))
    if isinstance(settings.formulation, _SOFT) and settings.penalty_weight == 0:
        sentence = f"0 leaves the penetrations of {settings.formulation.name} free; give a positive weight"
        problems.append(Problem("penalty_weight", sentence))
    if problems:
        raise InputError(problems)
    guess = resample(guess, grid)
    goal[2] = nearest_angle(goal[2], guess.states[-1, 2])
    start[2] = nearest_angle(start[2], guess.states[0, 2])
    settings = _with_usable_margins(settings)
    moving = MotionArrays.of(motions, len(obstacles) - len(motions), vehicle, settings, grid)
    return _arrays(scenario, vehicle, obstacles, guess, settings, grid, active, walls, start, goal, moving)


def _arrays(
    scenario: Scenario,
    vehicle: VehicleModel,
    obstacles: PolygonStack,
    guess: Trajectory,
    settings: Settings,
    grid: TimeGrid,
    active: NDArray[np.bool_],
    walls: NDArray[np.bool_],
    start: Array,
    goal: Array,
    moving: MotionArrays,
) -> StageProblem:
    assert isinstance(vehicle, SingleTrack)
    pieces, whole = settings.samples(grid.steps)
    W = scenario.workspace
    pairs, pair_sides, wall_places, wall_lines, pair_demands, wall_demands = compiled().stagewise_rows(
        active, walls, W.A, W.b, pieces * whole, _clearances(settings, start, goal)
    )
    (input_low, input_high), (low, high) = vehicle.input_bounds, (bound.copy() for bound in vehicle.state_bounds)
    low[2], high[2] = max(low[2], -settings.heading_limit), min(high[2], settings.heading_limit)
    states = np.minimum(np.maximum(guess.states, low), high)
    for k, state in ((0, start), (-1, goal)):
        np.copyto(states[k], state, where=~np.isnan(state))
    time_low, time_high = settings.final_time_bounds
    steering = vehicle.limits.steering
    parts = vehicle.part_stack
    polygons = (parts.vertices, parts.first, obstacles.vertices, obstacles.first)
    final_time = float(min(max(guess.duration, time_low), time_high))
    frames = moving.frames(final_time)
    lines = start_lines(guess.states, pieces, pairs, *polygons, whole=whole, moving=moving.obstacles, frames=frames)
    extras = moving.extras[tuple(pairs.T)] / 2 if moving.obstacles.size else np.zeros(0)
    pair_sides[: extras.size, 0] += extras
    soft = isinstance(settings.formulation, _SOFT)
    penalties = np.full((len(pairs), 2), np.nan)
    if soft:
        penalties[:, 0], penalties[:, 1] = 0.0, settings.penalty_weight * grid.widths[pairs[:, 0]]
    return StageProblem.of(
        model="single_track",
        parameters=np.array([vehicle.wheelbase, steering, np.tan(steering)]),
        widths=grid.widths,
        pieces=pieces,
        substeps=-(-settings.substeps // pieces),
        time_weight=float(settings.objective.time_weight),
        input_weights=np.array(settings.objective.input_weights, float),
        time_scaled=settings.objective.energy is EnergyForm.TIME_SCALED,
        state_low=low,
        state_high=high,
        input_low=input_low,
        input_high=input_high,
        time_low=float(time_low),
        time_high=float(time_high),
        start=start,
        goal=goal,
        part_vertices=parts.vertices,
        part_first=parts.first,
        part_radii=np.array([part.polygon.radius for part in vehicle.parts]),
        obstacle_vertices=obstacles.vertices,
        obstacle_first=obstacles.first,
        pairs=pairs,
        pair_origins=lines.origins,
        pair_sides=pair_sides,
        pair_penalties=penalties,
        walls=wall_places,
        wall_lines=wall_lines,
        pair_demands=pair_demands,
        wall_demands=wall_demands,
        states=states,
        inputs=np.minimum(np.maximum(guess.inputs, input_low), input_high),
        final_time=final_time,
        lines=lines.beside_obstacles() if soft else lines.lines,
        penetrations=lines.overlaps if soft else np.zeros(len(pairs)),
        form=_FORMS[type(settings.formulation)],
        pair_extras=extras,
        motion_obstacles=moving.obstacles,
        motion_times=moving.times,
        motion_poses=moving.poses,
        motion_slopes=moving.slopes,
    )


def _clearances(settings: Settings, start: Array, goal: Array) -> Any:
    """What is demanded, as the core takes it."""
    end_margin = settings.margin if settings.end_margin is None else settings.end_margin
    given = (not any(map(isnan, end[:3].tolist())) for end in (start, goal))
    return compiled().Clearances(settings.margin, end_margin, settings.workspace_margin, *given)
