"""The paper's simplified collision-free guess: the simplified model among the obstacles (eq. 27)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from tightspot.formulations import FarkasDual, Formulation
from tightspot.guesses.base import GuessResult, as_single_track
from tightspot.guesses.simplified import SimplifiedModel
from tightspot.scenarios.scenario import Scenario
from tightspot.transcription import Settings
from tightspot.vehicles.base import VehicleModel


@dataclass(frozen=True)
class CollisionFreeModel(SimplifiedModel):
    """Solution of ``min t_f (p integral v^2 dtau + r)`` for the reduced car in W with separation rows, eq. (27).

    The problem of :class:`SimplifiedModel` and its start, linear interpolation with zero inputs, which as a rule goes
    through the obstacles; so the solver may end in a point that is not feasible, and then there is no guess. The
    formulation decides where separation holds: at the knots for the paper's (18).

    Attributes:
        formulation: How separation is written; the paper takes (18).
    """

    name: ClassVar[str] = "collision-free"
    collision_free: ClassVar[bool] = True
    formulation: Formulation = field(default_factory=FarkasDual)

    def make(self, scenario: Scenario, vehicle: VehicleModel, *, margin: float) -> GuessResult:
        car = as_single_track(vehicle, self.name)
        settings = Settings(
            self.objective,
            self.formulation,
            margin=margin,
            end_margin=0.0,
            substeps=self.substeps,
            heading_limit=self.heading_limit,
        )
        return self.solve_reduced(scenario, car, settings, sees_obstacles=True)
