"""Direct multiple shooting: the optimal control problem (2) becomes the nonlinear program (22).

The only room that knows both the horizon and a formulation.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem
from tightspot.formulations import Formulation, SweptLine
from tightspot.geometry.transforms import nearest_angle
from tightspot.scenarios.scenario import Scenario
from tightspot.solvers.nlp import Nlp
from tightspot.trajectory import Trajectory
from tightspot.transcription.builder import Shape
from tightspot.transcription.grid import TimeGrid
from tightspot.transcription.motions import ObstacleMotion
from tightspot.transcription.moving import MotionArrays, with_moving
from tightspot.transcription.numbers import with_numbers
from tightspot.transcription.objective import Objective
from tightspot.transcription.sampling import resample
from tightspot.transcription.structures import symbols_for
from tightspot.vehicles.base import VehicleModel

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Settings:
    """How the horizon is discretised and what is demanded of it.

    Attributes:
        objective: What is minimised.
        formulation: How separation is written.
        margin: Demanded clearance, m, wherever the formulation's rows hold.
        end_margin: Demanded clearance at a fixed start or goal pose, m, where nothing can be moved; ``None``:
            the same as ``margin``.
        workspace_margin: Demanded distance of the body from W's boundary at free poses, m.
        substeps: RK4 steps an interval.
        poses: Sub-intervals whose end poses carry rows, for formulations that hold on the interval; one number for
            all intervals, or one each. 0: on that interval rows at its last knot only, as a formulation that holds at
            the knots has them.
        final_time: Bounds of the free final time, s, or one number to fix it.
        penalty_weight: What the time integral of a soft formulation's penalty is multiplied with, 1/(m s); others have
            none.
        heading_limit: Bound of |theta|, rad; infinite but for reproducing the paper.
    """

    objective: Objective = field(default_factory=Objective)
    formulation: Formulation = field(default_factory=SweptLine)
    margin: float = 0.0
    end_margin: float | None = None
    workspace_margin: float = 0.0
    substeps: int = 4
    poses: int | tuple[int, ...] = 2
    final_time: float | tuple[float, float] = (0.1, 1000.0)
    penalty_weight: float = 100.0
    heading_limit: float = np.inf

    def __post_init__(self) -> None:
        poses = (self.poses,) if isinstance(self.poses, int) else self.poses
        counts = {"substeps": (self.substeps, 1), "poses": (min(poses, default=-1), 0)}
        problems = [
            Problem(name, f"{count} must be at least {least}")
            for name, (count, least) in counts.items()
            if count < least
        ]
        for name in ("margin", "end_margin", "workspace_margin"):
            value = getattr(self, name)
            if value is not None and not (np.isfinite(value) and value >= 0):
                problems.append(Problem(name, f"{value} m must be finite and not negative"))
        if not (np.isfinite(self.penalty_weight) and self.penalty_weight >= 0):
            problems.append(Problem("penalty_weight", f"{self.penalty_weight} must be finite and not negative"))
        low, high = self.final_time_bounds
        if not (0 < low <= high and np.isfinite(low)):
            problems.append(Problem("final_time", f"[{low}, {high}] s must be positive, in order and begin finite"))
        if not self.heading_limit > 0:
            problems.append(Problem("heading_limit", f"{self.heading_limit} rad must be positive"))
        if problems:
            raise InputError(problems)

    def pieces(self, steps: int) -> tuple[int, ...]:
        """Sub-intervals of each of the ``steps`` intervals: 1 where rows stand at the last knot only.

        Raises:
            InputError: ``poses`` has another length.
        """
        return tuple(max(count, 1) for count in self._poses(steps))

    def whole(self, steps: int) -> tuple[bool, ...]:
        """On which of the ``steps`` intervals rows stand at all sample poses, not at the last knot only.

        Raises:
            InputError: ``poses`` has another length.
        """
        return tuple(count > 0 for count in self._poses(steps))

    def samples(self, steps: int) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """:meth:`pieces` and :meth:`whole` as arrays, (steps,) each.

        Raises:
            InputError: ``poses`` has another length.
        """
        poses = np.array(self._poses(steps), np.int64)
        return np.maximum(poses, 1), poses > 0

    def _poses(self, steps: int) -> tuple[int, ...]:
        if self.formulation.holds == "knots":
            return (0,) * steps
        poses = (self.poses,) * steps if isinstance(self.poses, int) else self.poses
        if len(poses) != steps:
            raise InputError(Problem("poses", f"has {len(poses)} numbers for {steps} intervals; give one or {steps}"))
        return poses

    @property
    def final_time_bounds(self) -> tuple[float, float]:
        """(lowest, highest) t_f, s."""
        if isinstance(self.final_time, tuple):
            return self.final_time
        return float(self.final_time), float(self.final_time)


@dataclass(frozen=True, eq=False)
class Transcription:
    """An :class:`Nlp` and the way back from its variables to a trajectory.

    Attributes:
        nlp: The program, with its starting point from the guess.
        grid: Fractions of the horizon.
        settings: What was asked for.
        active: Which pairs are in the program, (N, parts, obstacle parts) booleans, by interval.
        vehicle: Whose dynamics.
        lines: Where each pair's auxiliary variables are in x, by (interval, part, obstacle part).
    """

    nlp: Nlp
    grid: TimeGrid
    settings: Settings
    active: NDArray[np.bool_]
    vehicle: VehicleModel
    lines: Mapping[tuple[int, int, int], slice]

    def trajectory(self, x: Array) -> Trajectory:
        """The trajectory that the variables x describe."""
        stages = self.nlp.stages
        final_time = float(x[self.nlp.shared][0])
        return Trajectory(
            final_time * self.grid.fractions,
            np.array([x[stage.state] for stage in stages]),
            np.array([x[stage.control] for stage in stages[:-1]]),
            self.vehicle.state_names,
            self.vehicle.input_names,
        )


def transcribe(
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
) -> Transcription:
    """Write the planning problem as a nonlinear program, started at the guess.

    Variables, stage after stage: state xi_k, input u_k, auxiliary variables of the pairs that hold at knot k (on
    interval [t_{k-1}, t_k]); last t_f. Rows: ``F(xi_k, u_k, h_k) - xi_{k+1} = 0`` with RK4; eq. (13) for W; the
    formulation's rows. Start and goal are bounds on xi_0 and xi_N; the goal's heading is the one nearest the
    guess's, modulo 2 pi. The symbols of the last few structures are kept: for another scene of the same structure only
    the numbers are new, and what a solver has built for the first serves the second.

    Args:
        scenario: Obstacles, W, start and goal, in the scenario's coordinates.
        vehicle: Dynamics, bounds and body.
        guess: Any timed trajectory; it is resampled onto the grid and clipped into the bounds.
        settings: Discretisation, objective, formulation, margins.
        grid: Knots.
        active: Pairs to include, (N, parts, obstacle parts), those that move last; all if ``None``.
        walls: Half-planes of W to include, (N, parts, edges of W); all if ``None``.
        start: Replaces the scenario's start state, (n_x,), NaN meaning free: for models with another state.
        goal: Replaces the scenario's goal state.
        motions: Obstacle parts that move, besides the scenario's. Their pairs are written in their frames: the
            formulation sees the vehicle's poses from there, which depend on t_f.

    Raises:
        InputError: If an argument does not fit the others.

    Reference: paper, section 6, eq. (22).
    """
    obstacles = with_moving(scenario.obstacle_polygons, motions)
    shapes = {
        name: (grid.steps, len(vehicle.parts), count)
        for name, count in (("active", len(obstacles)), ("walls", len(scenario.workspace.b)))
    }
    active = np.ones(shapes["active"], bool) if active is None else active
    walls = np.ones(shapes["walls"], bool) if walls is None else walls
    masks = {"active": (active, shapes["active"]), "walls": (walls, shapes["walls"])}
    start = np.array(scenario.start if start is None else start, float)
    goal = np.array(scenario.goal if goal is None else goal, float)
    problems = _misfits(vehicle, guess, settings, {"start": start, "goal": goal})
    for name, (mask, shape) in masks.items():
        if mask.shape != shape:
            problems.append(Problem(name, f"has shape {mask.shape}, but this problem needs {shape}"))
    if problems:
        raise InputError(problems)
    onto_grid = resample(guess, grid)
    goal[2] = nearest_angle(goal[2], onto_grid.states[-1, 2])
    start[2] = nearest_angle(start[2], onto_grid.states[0, 2])
    settings = _with_usable_margins(settings)
    structure = Shape(
        obstacles=tuple(len(polygon.vertices) for polygon in obstacles),
        walls_pattern=scenario.workspace.A != 0,
        active=active,
        walls=walls,
        fixed_poses=(not np.isnan(start[:3]).any(), not np.isnan(goal[:3]).any()),
        moving=len(motions),
    )
    moving = MotionArrays.of(motions, len(obstacles) - len(motions), vehicle, settings, grid)
    symbols = symbols_for(vehicle, settings, grid, structure)
    named = [*scenario.obstacle_parts, *((motion.name, motion.polygon) for motion in motions)]
    nlp = with_numbers(symbols, vehicle, scenario.workspace, named, settings, start, goal, onto_grid, moving)
    return Transcription(nlp, grid, settings, active, vehicle, symbols.lines)


def _misfits(vehicle: VehicleModel, guess: Trajectory, settings: Settings, ends: dict[str, Array]) -> list[Problem]:
    """What does not fit the vehicle's states and inputs."""
    problems = []
    if (guess.state_names, guess.input_names) != (vehicle.state_names, vehicle.input_names):
        names = (*vehicle.state_names, *vehicle.input_names)
        problems.append(Problem("guess", f"has other columns than the vehicle's {names}"))
    for name, state in ends.items():
        if state.shape != (vehicle.n_states,):
            problems.append(
                Problem(name, f"has shape {state.shape}; needs one number for each of {vehicle.state_names}")
            )
    weights = settings.objective.input_weights
    if len(weights) != vehicle.n_inputs:
        sentence = f"needs {vehicle.n_inputs} numbers, one for each of {vehicle.input_names}"
        problems.append(Problem("objective.input_weights", sentence))
    return problems


def _with_usable_margins(settings: Settings) -> Settings:
    smallest = settings.formulation.smallest_margin
    end = settings.margin if settings.end_margin is None else settings.end_margin
    if settings.margin >= smallest and settings.end_margin is not None and end >= smallest:
        return settings
    return replace(settings, margin=max(settings.margin, smallest), end_margin=max(end, smallest))
