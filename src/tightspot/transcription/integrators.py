"""Explicit integration of a vehicle's dynamics under an input that is constant on the step."""

from __future__ import annotations

from typing import Any

import casadi as ca

from tightspot.vehicles.base import VehicleModel


def vector_field(vehicle: VehicleModel, state: Any, control: Any) -> Any:
    """``f(xi, u)`` as a CasADi column."""
    return ca.vertcat(*vehicle.dynamics(ca.vertsplit(state), ca.vertsplit(control), ca))


def rk4(vehicle: VehicleModel, state: Any, control: Any, step: Any, substeps: int = 1) -> Any:
    """Classical Runge-Kutta scheme of order 4 over ``step`` seconds in ``substeps`` equal substeps.

    Args:
        vehicle: Its dynamics.
        state: CasADi column (n_x, 1).
        control: CasADi column (n_u, 1), constant.
        step: Duration, s; may be an expression (a free final time).
        substeps: Number of substeps; the error falls with its fourth power.

    Returns:
        The state after the step.
    """
    h = step / substeps
    for _ in range(substeps):
        k1 = vector_field(vehicle, state, control)
        k2 = vector_field(vehicle, state + h / 2 * k1, control)
        k3 = vector_field(vehicle, state + h / 2 * k2, control)
        k4 = vector_field(vehicle, state + h * k3, control)
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return state
