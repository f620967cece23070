"""RK4: its order by the slope of its error, exactness where the dynamics are polynomial, its derivatives."""

import casadi as ca
import numpy as np
import pytest

from tightspot.transcription.integrators import rk4, vector_field
from tightspot.vehicles import vehicle

CAR = vehicle("paper")
STATE = np.array([1.0, -2.0, 0.4, 0.7, -0.3])
INPUT = np.array([0.3, 0.12])


def integrator(substeps):
    xi, u, h = ca.SX.sym("xi", 5), ca.SX.sym("u", 2), ca.SX.sym("h")
    return ca.Function("F", [xi, u, h], [rk4(CAR, xi, u, h, substeps)])


def end(substeps, state=STATE, control=INPUT, duration=2.0):
    return np.array(integrator(substeps)(state, control, duration)).ravel()


def test_the_error_falls_with_the_fourth_power_of_the_step():
    reference = end(1024)
    substeps = np.array([4, 8, 16, 32, 64])
    errors = np.array([np.abs(end(int(count)) - reference).max() for count in substeps])
    slopes = np.diff(np.log(errors)) / np.diff(np.log(1 / substeps))
    assert errors[0] < 1e-3
    np.testing.assert_allclose(slopes, 4.0, atol=0.15)


def test_speed_and_steering_are_exact_because_they_are_linear_in_time():
    np.testing.assert_allclose(end(1)[3:], STATE[3:] + 2.0 * INPUT, rtol=1e-15)


def test_constant_steering_drives_a_circle():
    speed, delta, duration = -0.8, 0.5, 9.0
    kappa = np.tan(delta) / CAR.wheelbase
    turned = speed * kappa * duration
    x, y, theta, v, steering = end(64, np.array([0, 0, 0, speed, delta]), np.zeros(2), duration)
    expected = [np.sin(turned) / kappa, (1 - np.cos(turned)) / kappa, turned]
    np.testing.assert_allclose([x, y, theta], expected, atol=1e-8)
    assert (v, steering) == (speed, delta)
    assert np.hypot(x, y - 1 / kappa) == pytest.approx(1 / kappa, abs=1e-8)


def test_a_straight_line_with_constant_acceleration_is_exact():
    result = end(1, np.array([2.0, 3.0, np.pi / 6, 0.5, 0.0]), np.array([0.2, 0.0]), 3.0)
    distance = 0.5 * 3 + 0.2 * 9 / 2
    np.testing.assert_allclose(result[:2], [2 + distance * np.sqrt(3) / 2, 3 + distance / 2], rtol=1e-14)


def test_substeps_compose():
    half = end(2, STATE, INPUT, 1.0)
    np.testing.assert_allclose(end(2, half, INPUT, 1.0), end(4), rtol=1e-14)


def test_no_time_no_motion():
    np.testing.assert_array_equal(end(3, duration=0.0), STATE)


def test_derivatives_match_central_differences():
    xi, u, h = ca.SX.sym("xi", 5), ca.SX.sym("u", 2), ca.SX.sym("h")
    z = ca.vertcat(xi, u, h)
    F = ca.Function("F", [z], [rk4(CAR, xi, u, h, 3)])
    J = ca.Function("J", [z], [ca.jacobian(F(z), z)])
    point, step = np.r_[STATE, INPUT, 1.5], 1e-5
    columns = [(np.array(F(point + step * e)) - np.array(F(point - step * e))).ravel() / (2 * step) for e in np.eye(8)]
    np.testing.assert_allclose(np.array(J(point)), np.column_stack(columns), atol=1e-9)


def test_the_vector_field_is_the_vehicle_s():
    xi, u = ca.SX.sym("xi", 5), ca.SX.sym("u", 2)
    f = ca.Function("f", [xi, u], [vector_field(CAR, xi, u)])
    np.testing.assert_allclose(np.array(f(STATE, INPUT)).ravel(), CAR.dynamics(STATE, INPUT, np), rtol=1e-15)
