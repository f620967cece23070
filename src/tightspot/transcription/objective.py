"""The time-energy objective of the paper's eq. (25), in the form printed and in the form that was solved."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any

import casadi as ca
import numpy as np

from tightspot.errors import InputError, Problem
from tightspot.transcription.grid import TimeGrid


class EnergyForm(Enum):
    """What multiplies the integral of the input energy over normalised time tau in [0, 1].

    ``TIME_SCALED``: t_f, as printed in eq. (25), so the energy is the integral over time.
    ``NORMALISED``: 1, as the paper's table was computed (NOTES.md, "Settings that reproduce Table II").
    """

    TIME_SCALED = "time-scaled"
    NORMALISED = "normalised"


@dataclass(frozen=True)
class Objective:
    """``J = r t_f + c * integral_0^1 |u(tau)|_P^2 dtau`` with c = t_f (printed) or c = 1.

    Inputs are constant on each interval, so the integral is the sum of ``w_k |u_k|_P^2`` with the intervals'
    fractions w_k of the horizon, exactly.

    Attributes:
        time_weight: r, 1/s for a cost without unit.
        input_weights: Diagonal of P, one an input.
        energy: Which form.

    Reference: paper eq. (25), r = 1, P = diag(1, 2).
    """

    time_weight: float = 1.0
    input_weights: tuple[float, ...] = (1.0, 2.0)
    energy: EnergyForm = EnergyForm.TIME_SCALED

    def __post_init__(self) -> None:
        problems = []
        if not (np.isfinite(self.time_weight) and self.time_weight >= 0):
            problems.append(Problem("objective.time_weight", f"{self.time_weight} must be finite and not negative"))
        if not all(np.isfinite(weight) and weight >= 0 for weight in self.input_weights):
            problems.append(Problem("objective.input_weights", f"{self.input_weights} must be finite and not negative"))
        if not problems and self.time_weight == 0 and not any(self.input_weights):
            problems.append(Problem("objective", "all weights are 0; there is nothing to minimise"))
        if problems:
            raise InputError(problems)

    def expression(self, inputs: list[Any], final_time: Any, grid: TimeGrid, time_weight: Any, weights: Any) -> Any:
        """J as a CasADi expression; the weights are symbols so that one built problem serves all values."""
        energy = 0
        for width, u in zip(grid.widths, inputs, strict=True):
            energy += float(width) * ca.dot(weights, u * u)
        scale = final_time if self.energy is EnergyForm.TIME_SCALED else 1.0
        return time_weight * final_time + scale * energy

    def value(self, t: Any, inputs: Any) -> float:
        """J of a trajectory: knot times (N+1,) and inputs (N, n_u)."""
        t, inputs = np.asarray(t, float), np.asarray(inputs, float)
        duration = t[-1] - t[0]
        energy = float((t[1:] - t[:-1]) @ (inputs**2 @ np.array(self.input_weights)))
        if self.energy is EnergyForm.NORMALISED:
            energy /= duration
        return float(self.time_weight * duration + energy)
