"""A straight line from start to goal in state space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from tightspot.errors import InputError, Problem
from tightspot.geometry.transforms import nearest_angle
from tightspot.guesses.base import Guess, GuessResult, known
from tightspot.scenarios.scenario import Scenario
from tightspot.trajectory import Trajectory
from tightspot.vehicles.base import VehicleModel


@dataclass(frozen=True)
class LinearInterpolation(Guess):
    """States interpolated from start to goal, inputs zero. Ignores dynamics and obstacles.

    Attributes:
        duration: Guessed final time, s.
        steps: Number of intervals.
    """

    name: ClassVar[str] = "linear"
    collision_free: ClassVar[bool] = False
    duration: float = 40.0
    steps: int = 20

    def __post_init__(self) -> None:
        if not (np.isfinite(self.duration) and self.duration > 0):
            raise InputError(Problem("guess.duration", f"{self.duration} s must be positive and finite"))
        if self.steps < 1:
            raise InputError(Problem("guess.steps", f"{self.steps} is too few; give at least 1 interval"))

    def make(self, scenario: Scenario, vehicle: VehicleModel, *, margin: float) -> GuessResult:
        start, goal = known(scenario.start), known(scenario.goal)
        goal[2] = nearest_angle(goal[2], start[2])
        trajectory = Trajectory(
            np.linspace(0.0, self.duration, self.steps + 1),
            np.linspace(start, goal, self.steps + 1),
            np.zeros((self.steps, vehicle.n_inputs)),
            vehicle.state_names,
            vehicle.input_names,
        )
        return GuessResult(trajectory, f"Straight line in state space, {self.duration:g} s.")
