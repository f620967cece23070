"""What a motion costs: numbers by which manoeuvres are compared, none of which says what is best."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot.verification.plan_file import Plan
from tightspot.verification.tables.findings import Place
from tightspot.verification.tables.steps import Steps

Array = NDArray[np.float64]

SHORTEST_LEG = 0.01
"""A change of direction for less than this, m, is no gear change."""


@dataclass(frozen=True)
class Scores:
    """A motion's numbers; ``None`` where a table has not the columns for them.

    Attributes:
        duration: s.
        path_length: Of the way of the rear-axle midpoint, m.
        gear_changes: Changes between forward and reverse; less than 1 cm there and back is none.
        integral_a2_v2omega2: Integral of ``a^2 + (v omega)^2`` over time, m^2/s^3 (radians count as 1).
        integral_delta2: Integral of ``delta^2`` over time, rad^2 s.
    """

    duration: float | None
    path_length: float
    gear_changes: int
    integral_a2_v2omega2: float | None
    integral_delta2: float | None

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self)

    def summary(self) -> list[str]:
        """Lines for people."""
        values = {
            "duration": (self.duration, "s"),
            "path length": (self.path_length, "m"),
            "integral of a^2 + (v omega)^2": (self.integral_a2_v2omega2, "m^2/s^3"),
            "integral of delta^2": (self.integral_delta2, "rad^2 s"),
        }
        lines = [
            f"score: {name} {'not known from this table' if value is None else f'{value:.4f} {unit}'}"
            for name, (value, unit) in values.items()
        ]
        return [*lines[:2], f"score: gear changes {self.gear_changes}", *lines[2:]]


def table_scores(steps: Steps, place: Place) -> Scores:
    """The scores of a table: integrals by the trapezium rule over the rows.

    Without a column a (omega), the differences of v (delta) are taken, constant between rows; then the integrals of
    a^2 and of (v omega)^2, v linear between rows, are exact.
    """
    h, table = steps.h, steps.table
    v, a, delta, omega = (table.get(name) for name in ("v", "a", "delta", "omega"))
    effort = bend = None
    if h is not None and v is not None:
        turning = _weighted(omega, delta, v, h)
        effort = None if turning is None else _squared(a, v, h) + turning
    if h is not None and delta is not None:
        bend = _trapezium(delta**2, h)
    duration = None if place.t is None else float(place.t[-1] - place.t[0])
    changes = gear_changes(steps.along, SHORTEST_LEG + 4 * steps.xy)
    return Scores(duration, float(place.driven[-1]), changes, effort, bend)


def plan_scores(plan: Plan) -> Scores:
    """The scores of a plan of the single-track model: its inputs are constant between knots, so all is exact."""
    trajectory = plan.trajectory
    h, knots = np.diff(trajectory.t), plan.replay.knots
    names = trajectory.state_names
    v, delta = knots[:, names.index("v")], knots[:, names.index("delta")]
    a, omega = trajectory.column("a"), trajectory.column("omega")
    effort = float((h * a**2).sum()) + float((omega**2 * _square(v, h)).sum())
    way = _ways(v, h)
    return Scores(
        trajectory.duration,
        float(np.abs(way).sum()),
        gear_changes(way, SHORTEST_LEG),
        effort,
        float(_square(delta, h).sum()),
    )


def gear_changes(way: Array, shortest: float) -> int:
    """Changes of direction in a sequence of signed ways (m), each of which leads farther than ``shortest``."""
    changes, gear, position, extreme = 0, 0, 0.0, 0.0
    for step in way.tolist():
        position += step
        if gear == 0 and abs(position) > shortest:
            gear, extreme = (1 if position > 0 else -1), position
        elif gear * position > gear * extreme:
            extreme = position
        elif gear * (extreme - position) > shortest:
            changes, gear, extreme = changes + 1, -gear, position
    return changes


def _squared(a: Array | None, v: Array, h: Array) -> float:
    return _trapezium(a**2, h) if a is not None else float((np.diff(v) ** 2 / h).sum())


def _weighted(omega: Array | None, delta: Array | None, v: Array, h: Array) -> float | None:
    if omega is not None:
        return _trapezium((v * omega) ** 2, h)
    if delta is None:
        return None
    return float(((np.diff(delta) / h) ** 2 * _square(v, h)).sum())


def _trapezium(values: Array, h: Array) -> float:
    return float((0.5 * h * (values[1:] + values[:-1])).sum())


def _square(values: Array, h: Array) -> Array:
    """Integrals of the squares of what is linear between knots."""
    before, after = values[:-1], values[1:]
    return np.asarray(h * (before**2 + before * after + after**2) / 3)


def _ways(v: Array, h: Array) -> Array:
    """Signed ways of speeds that are linear between knots: two on an interval in which the sign changes."""
    before, after = v[:-1], v[1:]
    turning = before * after < 0
    share = np.where(turning, before / np.where(turning, before - after, 1.0), 1.0)
    first = np.where(turning, 0.5 * before * share * h, 0.5 * (before + after) * h)
    second = np.where(turning, 0.5 * after * (1 - share) * h, 0.0)
    return np.column_stack([first, second]).ravel()
