"""The checker's own motion of any vehicle model: the modified midpoint rule, extrapolated (Gragg, Bulirsch,
Stoer).

Unlike the quadrature for the single-track model, its error is an estimate: the difference between the last
two columns of the extrapolation table, summed over the horizon with a safety factor.

Reference:
    E. Hairer, S. P. Norsett, G. Wanner: Solving Ordinary Differential Equations I, section II.9.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tightspot.trajectory import Trajectory
from tightspot.vehicles import VehicleModel
from tightspot.verification.quadrature import CheckedMotion, IntegrationError

Array = NDArray[np.float64]

_SEQUENCE = (2, 4, 6, 8, 10)
_LONGEST_PANEL = 0.2
_SAFETY = 100.0
_ROUNDING = 32 * float(np.finfo(float).eps)
MAX_PANELS = 100_000


def general_motion(vehicle: VehicleModel, trajectory: Trajectory, times: Array) -> CheckedMotion:
    """The motion at the knots and at ``times``.

    Raises:
        IntegrationError: A number overflows or the horizon is too long.
    """
    t = trajectory.t
    wanted = np.union1d(t, times)
    if trajectory.duration / _LONGEST_PANEL + wanted.size > MAX_PANELS:
        raise IntegrationError(f"the horizon of {trajectory.duration:g} s needs too many panels")
    count = max(2, math.ceil(trajectory.duration / _LONGEST_PANEL) + 1)
    grid = np.union1d(wanted, np.linspace(t[0], t[-1], count))
    interval = np.clip(np.searchsorted(t, grid[:-1], side="right") - 1, 0, trajectory.steps - 1)
    states, errors = np.empty((grid.size, vehicle.n_states)), np.zeros((grid.size, 3))
    states[0] = trajectory.states[0]
    for row, k in enumerate(interval.tolist()):
        try:
            states[row + 1], step_error = _step(
                vehicle, states[row].tolist(), trajectory.inputs[k].tolist(), float(grid[row + 1] - grid[row])
            )
        except (OverflowError, ValueError):
            raise IntegrationError("the motion leaves the finite numbers") from None
        errors[row + 1] = errors[row] + _SAFETY * step_error[:3] + _ROUNDING * np.abs(states[row + 1, :3])
    if not np.isfinite(states).all():
        raise IntegrationError("the motion leaves the finite numbers")
    at = np.searchsorted(grid, wanted)
    return CheckedMotion(wanted, states[at], np.hypot(errors[at, 0], errors[at, 1]), errors[at, 2])


def _step(vehicle: VehicleModel, state: list[float], control: list[float], H: float) -> tuple[Array, Array]:
    """One step of length H: the extrapolated state and the estimate of its error."""
    row: list[Array] = []
    previous: list[Array] = []
    for j, n in enumerate(_SEQUENCE):
        row = [_midpoint(vehicle, state, control, H, n)]
        for i in range(1, j + 1):
            ratio = (n / _SEQUENCE[j - i]) ** 2
            row.append(row[i - 1] + (row[i - 1] - previous[i - 1]) / (ratio - 1))
        previous = row
    return row[-1], np.abs(row[-1] - row[-2])


def _midpoint(vehicle: VehicleModel, state: list[float], control: list[float], H: float, n: int) -> Array:
    """Gragg's modified midpoint rule with n substeps."""
    h = H / n

    def slope(at: Sequence[float]) -> Array:
        return np.array(vehicle.dynamics(at, control, math), dtype=float)

    before = np.array(state)
    now = before + h * slope(state)
    for _ in range(n - 1):
        before, now = now, before + 2 * h * slope(now.tolist())
    return np.asarray(0.5 * (before + now + h * slope(now.tolist())))
