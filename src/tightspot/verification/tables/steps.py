"""What happens from row to row, and how much of it sampling and rounding can explain.

Let the table be an honest one: samples of a motion of the single-track model within the vehicle's limits, rounded.
Consider an interval of the duration h with the mean heading m = (theta_k + theta_{k+1}) / 2 and the turn dtheta. Its
step (dx, dy) has the parts ``along = cos(m) dx + sin(m) dy`` and ``across = -sin(m) dx + cos(m) dy``. The speed changes
at most by a in a second, the turning rate ``g = v tan(delta) / L`` at most by
``R = (a tan(delta_max) + V omega (1 + tan(delta_max)^2)) / L`` with V the largest speed. So on the interval v differs
from its mean by at most a |t - t_m|, and theta from its chord by at most R (t - t_k)(t_{k+1} - t) / 2. Integrating::

    |across|                 <=  (a |dtheta| h^2 + V R h^3) / 12
    |along - int v dt|       <=  V h f^2 / 2              with f = |dtheta| / 2 + R h^2 / 8
    |int f dt - trapezium|   <=  F h^2 / 4 (1 - r^2)      for any f that changes at most by F in a second,
                                                          with r = |f_{k+1} - f_k| / (F h)

to first order in f; a tenth is added. Without times the length c of the steps takes the place of h, the largest
curvature kappa = tan(delta_max) / L that of F: ``|across| <= kappa c^2 / 4 (1 - r^2)`` with r = |dtheta| / (kappa c).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tightspot.vehicles import SingleTrack
from tightspot.verification.tables.heading import shortest_step
from tightspot.verification.tables.motion import arc_length
from tightspot.verification.tables.table import Table

Array = NDArray[np.float64]

_RESERVE = 1.1


@dataclass(frozen=True, eq=False)
class Steps:
    """A table's intervals. Arrays over intervals have the shape (N,), those over rows (N+1,).

    Attributes:
        table: Whose they are.
        vehicle: Whose limits count.
        h: Durations, s, ``None`` without times.
        turn: Changes of the heading, rad.
        along: Steps along the mean heading, m.
        across: Steps across it, to the left, m.
        length: Lengths of the arcs, m.
        speed: Bound of the absolute speed on each interval, m/s; zeros without times.
        turn_change: R, bound of the change of the turning rate, rad/s^2; zeros without times.
        across_error: What an honest table's ``across`` may be, m.
        along_error: How far an honest table's ``along`` may be from the integral of v, m.
        hidden: Length that may be driven there and back between two rows, m.
        derived_heading: Whether the headings are the directions of motion, for want of a column.
        xy: How far a position may be from what was rounded, m.
    """

    table: Table
    vehicle: SingleTrack
    h: Array | None
    turn: Array
    along: Array
    across: Array
    length: Array
    speed: Array
    turn_change: Array
    across_error: Array
    along_error: Array
    hidden: Array
    derived_heading: bool
    xy: float

    @classmethod
    def of(cls, table: Table, poses: Array, vehicle: SingleTrack) -> Steps:
        """The steps between poses (M, 3) without jumps of the heading."""
        step = np.diff(poses, axis=0)
        turn, middle = step[:, 2], 0.5 * (poses[1:, 2] + poses[:-1, 2])
        along = np.cos(middle) * step[:, 0] + np.sin(middle) * step[:, 1]
        across = np.cos(middle) * step[:, 1] - np.sin(middle) * step[:, 0]
        xy = float(np.hypot(table.rounding.get("x", 0.0), table.rounding.get("y", 0.0)))
        length, t, derived = arc_length(step), table.get("t"), table.get("theta") is None
        zero = np.zeros(length.size)
        if t is None:
            errors = _without_times(turn, along, vehicle, 2 * table.rounding.get("theta", 0.0))
            return cls(table, vehicle, None, turn, along, across, length, zero, zero, *errors, derived, xy)
        h = np.diff(t)
        a, tan = largest_rate(table, "a", vehicle), np.tan(largest_steering(table, vehicle))
        omega, L = largest_rate(table, "omega", vehicle), vehicle.wheelbase
        speed = length / h + a * h
        change = (a * tan + speed * omega * (1 + tan**2)) / L
        across_error = np.minimum(_RESERVE * (a * np.abs(turn) * h**2 + speed * change * h**3) / 12, speed * h)
        angle = np.minimum(0.5 * np.abs(turn) + change * h**2 / 8, np.pi)
        along_error = np.minimum(_RESERVE * speed * h * angle**2 / 2, speed * h)
        hidden = np.where(length <= 0.5 * a * h**2 + 2 * xy, 0.25 * a * h**2, 0.0)
        parts = turn, along, across, length, speed, change, across_error, along_error, hidden
        return cls(table, vehicle, h, *parts, derived, xy)

    @property
    def curvature(self) -> float:
        """Largest curvature of the vehicle's path, 1/m."""
        return float(np.tan(self.vehicle.limits.steering) / self.vehicle.wheelbase)

    @property
    def heading_blur(self) -> float:
        """How far a heading may be off, rad: rounding, or what it takes to see a direction in positions."""
        if not self.derived_heading:
            return self.rounding("theta")
        shortest = shortest_step(self.xy)
        return self.curvature * max(shortest, float(self.length.max())) + 6 * self.xy / shortest

    def rounding(self, name: str) -> float:
        """How far a column may be from what was rounded."""
        return float(self.table.rounding.get(name, 0.0))


def largest_rate(table: Table, name: str, vehicle: SingleTrack) -> float:
    """The largest absolute a (m/s^2) or omega (rad/s): the vehicle's limit, or the column's if it exceeds that."""
    limits = vehicle.limits
    limit = max(map(abs, limits.acceleration)) if name == "a" else limits.steering_rate
    column = table.get(name)
    return float(max(limit, np.abs(column).max())) if column is not None else float(limit)


def largest_steering(table: Table, vehicle: SingleTrack) -> float:
    """The largest absolute steering angle, rad: the vehicle's limit, or the column's if it exceeds that."""
    column = table.get("delta")
    limit = vehicle.limits.steering
    return limit if column is None else float(max(limit, np.abs(column).max()))


def trapezium_error(values: Array, rate: Array | float, h: Array, rounding: float) -> Array:
    """How far the integral of a function may be from the trapezium rule on each interval.

    Args:
        values: At the rows, (N+1,).
        rate: Bound F of its change a second, (N,) or one.
        h: Durations, s, (N,).
        rounding: Of the values.
    """
    largest = np.maximum(rate * h, 1e-300)
    share = np.clip((np.abs(np.diff(values)) - 2 * rounding) / largest, 0.0, 1.0)
    return np.asarray(0.25 * largest * h * (1 - share**2))


def _without_times(turn: Array, along: Array, vehicle: SingleTrack, rounding: float) -> tuple[Array, Array, Array]:
    """across_error, along_error and hidden from the geometry alone; a gear may change where the steps turn back."""
    curvature = np.tan(vehicle.limits.steering) / vehicle.wheelbase
    length = np.abs(along)
    around = np.pad(length, 1, mode="edge")
    near = np.maximum(np.maximum(around[:-2], around[2:]), length)
    gear = np.pad(np.sign(along), 1, mode="edge")
    turns_back = (gear[:-2] != gear[1:-1]) | (gear[2:] != gear[1:-1])
    share = np.clip((np.abs(turn) - rounding) / np.maximum(curvature * near, 1e-300), 0.0, 1.0)
    across = _RESERVE * curvature * near**2 * np.where(turns_back, 0.5, 0.25 * (1 - share**2))
    angle = np.minimum(0.5 * np.abs(turn) + 0.25 * curvature * near, np.pi)
    return across, _RESERVE * near * angle**2 / 2, np.where(turns_back, near, 0.0)
