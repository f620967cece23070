"""What a guess is: a timed trajectory from start to goal, not necessarily free of collisions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem
from tightspot.scenarios.scenario import Scenario
from tightspot.trajectory import Trajectory
from tightspot.vehicles.base import VehicleModel
from tightspot.vehicles.single_track import SingleTrack

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class GuessResult:
    """A guess's trajectory, or why there is none.

    Attributes:
        trajectory: States and inputs within the vehicle's limits on any time grid; ``None`` if there is none.
        reason: One sentence: what was found, or why nothing.
        report: What was tried, as plain data.
        details: The method's own result (for hybrid A*: its search result), for pictures and further questions.
    """

    trajectory: Trajectory | None
    reason: str
    report: dict[str, Any] = field(default_factory=dict)
    details: Any = None


class Guess(ABC):
    """One way to make an initial guess."""

    name: ClassVar[str]
    collision_free: ClassVar[bool]

    @abstractmethod
    def make(self, scenario: Scenario, vehicle: VehicleModel, *, margin: float) -> GuessResult:
        """A trajectory from the scenario's start to its goal.

        Args:
            scenario: The scene, in its own (recentred) coordinates.
            vehicle: Its limits hold for the result.
            margin: Clearance that members which see obstacles keep from them, m.

        Returns:
            A result; that nothing was found is a result, too.

        Raises:
            InputError: If the member does not work for this vehicle.
        """


def as_single_track(vehicle: VehicleModel, guess: str) -> SingleTrack:
    """The vehicle, if it is a single-track model; otherwise an :class:`InputError`."""
    if isinstance(vehicle, SingleTrack):
        return vehicle
    raise InputError(
        Problem("guess", f"{guess} is made for single-track vehicles, not for {type(vehicle).__name__}; choose another")
    )


def known(state: Array) -> Array:
    """The state with its free (NaN) entries set to 0."""
    return np.where(np.isnan(state), 0.0, state)
