"""The checker's own motion of the single-track model: by quadrature, with a proved error bound.

The input is constant on an interval, so v and delta are linear in time and the rest are integrals::

    theta(t) = theta_0 + int v tan(delta) / L
    x(t) = x_0 + int v cos(theta)        y(t) = y_0 + int v sin(theta)

Each is computed by n-point Gauss-Legendre quadrature on panels of half length w.

**Bound of the remainder.** Let g be analytic with ``|g| <= M`` in the ellipse with the panel's ends as foci
and half axes ``w (r + 1/r) / 2`` and ``w (r - 1/r) / 2``. Its Chebyshev series cut at degree m errs by at
most ``2 M r^-m / (r - 1)`` on the panel (Bernstein; Trefethen, Approximation Theory and Approximation
Practice, th. 8.2). Gauss-Legendre is exact to degree m = 2n-1 and its weights are positive with sum 2w, so
the quadrature errs by at most ::

    2 (2w) 2 M r^-(2n-1) / (r - 1).

With d the half major and b the half minor axis, ``|v| <= |v_mid| + |a| d`` and ``|tan(delta)| <=
tan(|delta_mid| + |omega| d)`` in the ellipse (tan's power series has no negative coefficient), and
``|cos(theta)|, |sin(theta)| <= cosh(b max|theta'|)``. Those of v and delta hold in the disc of radius d about
the panel's middle, hence for every shorter panel from its beginning, too, which lies in it with its ellipse.

Errors add up along the horizon: those of theta enter x and y through ``|v|``. Rounding is bounded beside it,
coarsely.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tightspot.trajectory import Trajectory
from tightspot.vehicles import SingleTrack

Array = NDArray[np.float64]

_POINTS = 12
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(_POINTS)
_RATIO = 4.0
_MAJOR, _MINOR = (_RATIO + 1 / _RATIO) / 2, (_RATIO - 1 / _RATIO) / 2
_REMAINDER = 4 * _RATIO ** -(2 * _POINTS - 1) / (_RATIO - 1)
_EPS = float(np.finfo(float).eps)
MAX_PANELS = 400_000
_BLOCK = 10_000
_STEEPEST = 1.5


class IntegrationError(Exception):
    """The motion is outside what the checker can follow; the text says why."""


@dataclass(frozen=True, eq=False)
class CheckedMotion:
    """States at chosen times, from the checker's own integration.

    Attributes:
        times: s, ascending, all knots among them, shape (K,).
        states: Shape (K, n_x).
        position_error: Bound of the distance of (x, y) from the exact solution, m, shape (K,).
        heading_error: The same for theta, rad, shape (K,).
    """

    times: Array
    states: Array
    position_error: Array
    heading_error: Array


@dataclass(frozen=True, eq=False)
class _Panels:
    """Pieces of the horizon and their coefficients; every array has shape (p,).

    Attributes:
        grid: Ends of the panels, s, shape (p+1,).
        v: Speed at the beginning, m/s.
        delta: Steering angle at the beginning, rad.
        a: Acceleration, m/s^2.
        omega: Steering rate, rad/s.
        L: Wheelbase, m.
    """

    grid: Array
    v: Array
    delta: Array
    a: Array
    omega: Array
    L: float

    @property
    def half(self) -> Array:
        """Half lengths w, s."""
        return 0.5 * np.diff(self.grid)

    def part(self, block: slice) -> _Panels:
        """Some of the panels; their grid is left out."""
        return replace(
            self, v=self.v[block], delta=self.delta[block], a=self.a[block], omega=self.omega[block], grid=self.grid[:0]
        )

    def yaw_rate(self, tau: Array) -> Array:
        """theta' at times tau (p, ...) after the panels' beginnings, rad/s."""
        v, delta, a, omega = (
            column.reshape(-1, *[1] * (tau.ndim - 1)) for column in (self.v, self.delta, self.a, self.omega)
        )
        return np.asarray((v + a * tau) * np.tan(delta + omega * tau) / self.L)


def single_track_motion(vehicle: SingleTrack, trajectory: Trajectory, times: Array) -> CheckedMotion:
    """The motion at the knots and at ``times``.

    Raises:
        IntegrationError: The steering angle comes near 90 deg, a number overflows or the horizon is too long.
    """
    knots = _linear_states(trajectory)
    wanted = np.union1d(trajectory.t, times)
    panels = _panels(vehicle.wheelbase, trajectory, knots, wanted)
    theta, x, y = _integrals(panels, trajectory.states[0])
    position_error, heading_error = _errors(panels, trajectory.steps, np.abs([theta, x, y]).max(axis=1))
    at = np.searchsorted(panels.grid, wanted)
    k = np.clip(np.searchsorted(trajectory.t, wanted, side="right") - 1, 0, trajectory.steps - 1)
    linear = knots[k] + trajectory.inputs[k] * (wanted - trajectory.t[k])[:, None]
    states = np.column_stack([x[at], y[at], theta[at], linear])
    if not np.isfinite([states.sum(), position_error[-1], heading_error[-1]]).all():
        raise IntegrationError("the motion leaves the finite numbers")
    return CheckedMotion(wanted, states, position_error[at], heading_error[at])


def _linear_states(trajectory: Trajectory) -> Array:
    """(v, delta) at the knots, shape (N+1, 2)."""
    steps = trajectory.inputs * np.diff(trajectory.t)[:, None]
    return np.asarray(trajectory.states[0, 3:] + np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)]))


def _panels(L: float, trajectory: Trajectory, knots: Array, wanted: Array) -> _Panels:
    """Panels that end at the wanted times and are short enough for the remainder's bound to be tiny."""
    t, inputs = trajectory.t, trajectory.inputs
    steering = np.maximum(np.abs(knots[:-1, 1]), np.abs(knots[1:, 1]))
    speed = np.maximum(np.abs(knots[:-1, 0]), np.abs(knots[1:, 0]))
    if not np.isfinite(knots).all() or steering.max() > _STEEPEST:
        raise IntegrationError(f"the steering angle reaches {steering.max():.4g} rad, too near 90 deg")
    swing = np.minimum(0.25, 0.5 * (np.pi / 2 - steering))
    turning = speed * np.tan(steering) / L
    pieces = np.diff(t) / 2 * np.maximum(_MAJOR * np.abs(inputs[:, 1]) / swing, _MINOR * turning)
    pieces = np.maximum(1, np.ceil(pieces))
    if not pieces.sum() + wanted.size < MAX_PANELS:
        raise IntegrationError(f"the horizon of {trajectory.duration:g} s needs too many panels")
    ends = zip(t[:-1], t[1:], pieces.astype(int), strict=True)
    grid = np.unique(np.concatenate([wanted, *(np.linspace(a, b, n + 1)[1:-1] for a, b, n in ends)]))
    k = np.searchsorted(t, grid[:-1], side="right") - 1
    start = knots[k] + inputs[k] * (grid[:-1] - t[k])[:, None]
    return _Panels(grid, start[:, 0], start[:, 1], inputs[k, 0], inputs[k, 1], L)


def _integrals(panels: _Panels, start: Array) -> tuple[Array, Array, Array]:
    """theta, x, y at the panels' ends, each of shape (p+1,)."""
    w = panels.half
    tau = w[:, None] * (1 + _NODES)
    theta = _running_sum(start[2], w * (panels.yaw_rate(tau) @ _WEIGHTS))
    heading = theta[:-1, None] + _turns_within(panels, tau)
    speed = panels.v[:, None] + panels.a[:, None] * tau
    x = _running_sum(start[0], w * ((speed * np.cos(heading)) @ _WEIGHTS))
    y = _running_sum(start[1], w * ((speed * np.sin(heading)) @ _WEIGHTS))
    return theta, x, y


def _turns_within(panels: _Panels, tau: Array) -> Array:
    """Turns since the panels' beginnings at times tau (p, n), rad; in blocks that keep memory small."""
    turns = np.empty_like(tau)
    for block in (slice(i, i + _BLOCK) for i in range(0, len(tau), _BLOCK)):
        half = 0.5 * tau[block]
        inner = half[:, :, None] * (1 + _NODES)
        turns[block] = half * (panels.part(block).yaw_rate(inner) @ _WEIGHTS)
    return turns


def _errors(panels: _Panels, steps: int, largest: Array) -> tuple[Array, Array]:
    """Bounds of the errors of (x, y) and of theta at the panels' ends, each of shape (p+1,).

    Rounding: a panel's terms are exact to some 100 eps, v and delta lose a few eps at every knot; the running
    sums lose one eps of their largest value (``largest``: theta, x, y) at every panel.
    """
    w, major = panels.half, _MAJOR * panels.half
    speed = np.abs(panels.v + panels.a * w) + np.abs(panels.a) * major
    tangent = np.tan(np.abs(panels.delta + panels.omega * w) + np.abs(panels.omega) * major)
    yaw_rate = speed * tangent / panels.L
    rounding = (100 + 8 * steps) * _EPS * 2 * w
    turn = _REMAINDER * 2 * w * yaw_rate + rounding * speed * (1 + tangent**2) / panels.L + 2 * _EPS * largest[0]
    heading = _running_sum(0.0, turn)
    shift = (
        _REMAINDER * 2 * w * speed * np.cosh(_MINOR * w * yaw_rate) + rounding * speed + 2 * _EPS * largest[1:].max()
    )
    # The factor 2 > sqrt(2) is for x and y together; the heading's error moves the point across only.
    return _running_sum(0.0, 2 * shift + 2 * w * speed * heading[1:]), heading


def _running_sum(first: float, increments: Array) -> Array:
    return np.asarray(first + np.concatenate([[0.0], np.cumsum(increments)]))
