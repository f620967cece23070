"""The paper's simplified-model guess: no obstacles, speed and steering as inputs (eq. 26)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from tightspot.geometry.transforms import nearest_angle
from tightspot.guesses.base import Guess, GuessResult, as_single_track, known
from tightspot.scenarios.scenario import Scenario
from tightspot.solvers import Ipopt, Solver
from tightspot.trajectory import Trajectory
from tightspot.transcription import EnergyForm, Objective, Settings, TimeGrid, transcribe
from tightspot.vehicles.base import BodyPart, MathNamespace, MotionBounds, VehicleModel
from tightspot.vehicles.single_track import SingleTrack

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ReducedSingleTrack(VehicleModel):
    """The single-track car with state (x, y, theta) and inputs (v, delta), of the paper's section 7.3."""

    car: SingleTrack

    name = "reduced single-track"
    state_names = ("x", "y", "theta")
    state_units = ("m", "m", "rad")
    input_names = ("v", "delta")
    input_units = ("m/s", "rad")

    @property
    def parts(self) -> tuple[BodyPart, ...]:
        return self.car.parts

    @property
    def state_bounds(self) -> tuple[Array, Array]:
        return np.full(3, -np.inf), np.full(3, np.inf)

    @property
    def input_bounds(self) -> tuple[Array, Array]:
        low, high = self.car.state_bounds
        return low[3:], high[3:]

    def dynamics(self, state: Sequence[Any], control: Sequence[Any], ns: MathNamespace) -> list[Any]:
        return self.car.dynamics([*state, *control], [0.0, 0.0], ns)[:3]

    def frames(self, state: Sequence[Any], ns: MathNamespace) -> list[tuple[Any, Any, Any]]:
        return [(state[0], state[1], state[2])]

    def motion_bounds(self, before: Array, after: Array, controls: Array) -> list[MotionBounds]:
        first, last = np.hstack([before, controls]), np.hstack([after, controls])
        return self.car.motion_bounds(first, last, np.zeros_like(controls))

    def to_dict(self) -> dict[str, Any]:
        return {"model": "reduced_single_track", "car": self.car.to_dict()}


@dataclass(frozen=True)
class SimplifiedModel(Guess):
    """Solution of ``min t_f (p integral v^2 dtau + r)`` for the reduced car in W without obstacles, eq. (26).

    The reduced problem starts from linear interpolation with zero inputs. Its speeds and steering angles become
    states, and their differences, clipped into the limits, the inputs.

    Attributes:
        steps: Number of intervals.
        speed_weight: p.
        time_weight: r.
        duration: Final time of the linear interpolation, s.
        substeps: RK4 steps an interval.
        heading_limit: Bound of |theta|, rad; the paper has pi.
        solver: For the reduced problem.
    """

    name: ClassVar[str] = "simplified"
    collision_free: ClassVar[bool] = False
    steps: int = 20
    speed_weight: float = 1.0
    time_weight: float = 1.0
    duration: float = 40.0
    substeps: int = 4
    heading_limit: float = np.inf
    solver: Solver = field(default_factory=lambda: Ipopt(time_limit=20.0))

    def make(self, scenario: Scenario, vehicle: VehicleModel, *, margin: float) -> GuessResult:
        car = as_single_track(vehicle, self.name)
        settings = Settings(self.objective, substeps=self.substeps, heading_limit=self.heading_limit)
        return self.solve_reduced(scenario, car, settings, sees_obstacles=False)

    @property
    def objective(self) -> Objective:
        """That of eq. (26a)."""
        return Objective(self.time_weight, (self.speed_weight, 0.0), EnergyForm.TIME_SCALED)

    def solve_reduced(
        self, scenario: Scenario, car: SingleTrack, settings: Settings, *, sees_obstacles: bool
    ) -> GuessResult:
        """The reduced problem from linear interpolation, with separation rows for all obstacle parts or for none."""
        reduced = ReducedSingleTrack(car)
        start, goal = known(scenario.start), known(scenario.goal)
        goal[2] = nearest_angle(goal[2], start[2])
        line = Trajectory(
            np.linspace(0.0, self.duration, self.steps + 1),
            np.linspace(start[:3], goal[:3], self.steps + 1),
            np.zeros((self.steps, 2)),
            reduced.state_names,
            reduced.input_names,
        )
        active = np.full((self.steps, len(car.parts), len(scenario.obstacle_parts)), sees_obstacles)
        grid = TimeGrid.uniform(self.steps)
        transcription = transcribe(
            scenario, reduced, line, settings, grid=grid, active=active, start=start[:3], goal=goal[:3]
        )
        report = self.solver.solve(transcription.nlp)
        which = "with obstacles" if sees_obstacles else "without obstacles"
        if not report.status.success:
            reason = f"The simplified model {which} has no solution: {report.status.sentence}"
            return GuessResult(None, reason, report.to_dict())
        trajectory = full_trajectory(transcription.trajectory(report.x), car, start, goal)
        return GuessResult(trajectory, f"Solution of the simplified model {which}.", report.to_dict())


def full_trajectory(reduced: Trajectory, car: SingleTrack, start: Array, goal: Array) -> Trajectory:
    """The reduced solution with v and delta as states at the knots and their rates as inputs, within the limits."""
    between = (reduced.inputs[1:] + reduced.inputs[:-1]) / 2
    rates = np.vstack([start[3:5], between, goal[3:5]])
    inputs = np.diff(rates, axis=0) / np.diff(reduced.t)[:, None]
    low, high = car.input_bounds
    states = np.hstack([reduced.states, rates])
    return Trajectory(reduced.t, states, np.clip(inputs, low, high), car.state_names, car.input_names)
