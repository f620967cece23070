"""Does the table describe a vehicle whose wheels do not slip? Each column against how the poses move.

Every check adds up what the rows say wrongly over stretches of 1, 2, 4, ... rows and compares the sum with what an
honest table may show: what happens between the samples (:mod:`tightspot.verification.tables.steps`), rounding, and
:class:`Tolerances` on top. An honest table passes; what is left over lasts, and is no rounding.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tightspot.verification.tables.findings import Finding, Place, not_judged
from tightspot.verification.tables.reasons import slip_hint, speed_hint, steering_hint
from tightspot.verification.tables.steps import Steps, largest_rate, trapezium_error
from tightspot.verification.tables.windows import Stretch, worst_absolute_sum, worst_sum

Array = NDArray[np.float64]

GROUP = "kinematics"
_NO_HEADINGS = "the headings are the directions of motion themselves"


@dataclass(frozen=True)
class Tolerances:
    """What is allowed beyond sampling and rounding; for plans the checks of the dynamics allow as much.

    Attributes:
        absolute: On any stretch, m, rad, m/s.
        relative: Times the length driven or the change of the quantity on the stretch.
        bounds: Limits may be exceeded by this beyond rounding, in their units.
    """

    absolute: float = 5e-3
    relative: float = 5e-3
    bounds: float = 1e-6


def consistency(steps: Steps, place: Place, tolerances: Tolerances) -> list[Finding]:
    """The five checks, in a fixed order; those that the table does not allow are not judged.

    Args:
        steps: Of the table.
        place: To say where.
        tolerances: See there.
    """
    return [
        _side_slip(steps, place, tolerances),
        _speed(steps, place, tolerances),
        _heading(steps, place, tolerances),
        _rate(steps, place, tolerances, "delta", "omega"),
        _rate(steps, place, tolerances, "v", "a"),
    ]


def _side_slip(steps: Steps, place: Place, tolerances: Tolerances) -> Finding:
    if steps.derived_heading:
        return not_judged("side slip", GROUP, _NO_HEADINGS)
    xy = np.sqrt(2) * steps.xy
    allowance = steps.across_error + xy * np.abs(steps.turn)
    allowance += (steps.rounding("theta") + tolerances.relative) * steps.length
    found = worst_absolute_sum(steps.across, allowance, 2 * xy + tolerances.absolute)
    passed = found.ratio <= 1
    speed = "" if steps.h is None else f", {found.value / _span(steps, found):.3g} m/s on average,"
    sentence = f"side slip: {found.value:.4f} m sideways{_over(steps, found)}{speed} {place.words(found.middle)}"
    sentence += f" (at most {found.limit:.4f} m fit)" + ("" if passed else slip_hint(steps))
    return _finding(steps, "side slip", found, "m", sentence)


def _speed(steps: Steps, place: Place, tolerances: Tolerances) -> Finding:
    name, v, h = "speed against motion", steps.table.get("v"), steps.h
    if v is None or h is None:
        return not_judged(name, GROUP, "there is no column of speeds" if v is None else "there are no times")
    r, xy, a = steps.rounding("v"), np.sqrt(2) * steps.xy, largest_rate(steps.table, "a", steps.vehicle)
    change = steps.along - 0.5 * h * (v[1:] + v[:-1])
    allowance = steps.along_error + trapezium_error(v, a, h, r) + xy * np.abs(steps.turn) + r * h
    allowance += steps.rounding("t") * np.abs(np.diff(v)) + tolerances.relative * steps.length
    ends = 2 * (xy + steps.rounding("t") * float(np.abs(v).max())) + tolerances.absolute
    found = worst_absolute_sum(change, allowance, ends)
    sentence = f"{name}: the way differs by {found.value:.4f} m from what the speeds add up to{_over(steps, found)}"
    sentence += f" {place.words(found.middle)} (at most {found.limit:.4f} m fit)"
    return _finding(steps, name, found, "m", sentence + ("" if found.ratio <= 1 else speed_hint(steps)))


def _heading(steps: Steps, place: Place, tolerances: Tolerances) -> Finding:
    name, delta, v = "heading against steering", steps.table.get("delta"), steps.table.get("v")
    if delta is None or steps.derived_heading:
        return not_judged(name, GROUP, "there is no column of steering angles" if delta is None else _NO_HEADINGS)
    L, tan = steps.vehicle.wheelbase, np.tan(delta)
    slope = steps.rounding("delta") * float(1 + np.abs(tan).max() ** 2) / L
    if v is not None and steps.h is not None:
        h, g = steps.h, v * tan / L
        change = steps.turn - 0.5 * h * (g[1:] + g[:-1])
        blur = steps.rounding("v") * np.abs(tan).max() / L + slope * steps.speed
        allowance = trapezium_error(g, steps.turn_change, h, 0.0) + h * blur
        allowance += steps.rounding("t") * np.abs(np.diff(g))
        ends = 2 * steps.rounding("t") * float(np.abs(g).max())
    else:
        change = steps.turn - 0.5 * steps.along * (tan[1:] + tan[:-1]) / L
        allowance, ends = _heading_by_way(steps, tan, slope)
    allowance = allowance + tolerances.relative * np.abs(steps.turn)
    found = worst_absolute_sum(change, allowance, ends + 2 * steps.rounding("theta") + tolerances.absolute)
    sentence = f"{name}: the heading differs by {found.value:.4f} rad from what the steering angles add up to"
    sentence += f"{_over(steps, found)} {place.words(found.middle)} (at most {found.limit:.4f} rad fit)"
    return _finding(steps, name, found, "rad", sentence + ("" if found.ratio <= 1 else steering_hint(steps)))


def _heading_by_way(steps: Steps, tan: Array, slope: float) -> tuple[Array, float]:
    """Allowances where the way takes the place of speed and time: the curvature tan(delta)/L is along it."""
    L, xy = steps.vehicle.wheelbase, np.sqrt(2) * steps.xy
    change = np.abs(np.diff(tan)) / L
    allowance = steps.length * (0.5 * change + _bend(tan) / L) + slope * steps.length + xy * change
    allowance += steps.curvature * steps.hidden + 0.5 * np.abs(steps.turn) ** 3
    if steps.h is not None:
        rate = largest_rate(steps.table, "omega", steps.vehicle)
        steepest = rate * (1 + np.tan(steps.vehicle.limits.steering) ** 2) / L
        allowance += steepest * steps.speed * steps.h**2 / 4
    return allowance, 2 * xy * float(np.abs(tan).max()) / L


def _rate(steps: Steps, place: Place, tolerances: Tolerances, value: str, rate: str) -> Finding:
    """A column against the column of its changes: the mean change lies between those of the two rows.

    So it does whether the rates hold from their row on, until their row, or are samples of a smooth curve; for its
    bend a quarter of the second differences is added.
    """
    words = {"delta": ("steering", "steering rate", "rad"), "v": ("speed", "acceleration", "m/s")}
    what, how, unit = words[value]
    name, f, g, h = f"{what} against {how}", steps.table.get(value), steps.table.get(rate), steps.h
    if f is None or g is None or h is None:
        why = "there are no times" if h is None else "the table has not both columns"
        return not_judged(name, GROUP, why)
    bend = _bend(g)
    high, low = np.maximum(g[1:], g[:-1]) + bend, np.minimum(g[1:], g[:-1]) - bend
    change, t = np.diff(f), steps.rounding("t")
    allowance = steps.rounding(rate) * h + t * np.abs(np.diff(g)) + tolerances.relative * np.abs(change)
    ends = 2 * (steps.rounding(value) + t * float(np.abs(g).max())) + tolerances.absolute
    found = max(_excesses(change, h * high, h * low, allowance, ends), key=lambda stretch: stretch.ratio)
    found = found._replace(value=max(0.0, found.value))
    sentence = f"{name}: the {what} changes by {found.value:.4f} {unit} more or less than its rate says"
    sentence += f"{_over(steps, found)} {place.words(found.middle)} (at most {found.limit:.4f} {unit} fit)"
    return _finding(steps, name, found, unit, sentence)


def _bend(values: Array) -> Array:
    """How far a smooth curve may leave the values at both ends of an interval: a quarter of the second differences."""
    differences = 0.25 * np.abs(np.pad(np.diff(values, 2), 1))
    return np.asarray(np.maximum(differences[1:], differences[:-1]))


def _excesses(change: Array, high: Array, low: Array, allowance: Array, ends: float) -> Iterator[Stretch]:
    yield worst_sum(change - high, allowance, ends)
    yield worst_sum(low - change, allowance, ends)


def _over(steps: Steps, found: Stretch) -> str:
    """How long the stretch is."""
    return f" within {_span(steps, found):.2f} {'m' if steps.h is None else 's'}"


def _span(steps: Steps, found: Stretch) -> float:
    measure = steps.length if steps.h is None else steps.h
    return float(measure[found.first : found.last].sum())


def _finding(steps: Steps, name: str, found: Stretch, unit: str, sentence: str) -> Finding:
    passed, span = bool(found.ratio <= 1), _span(steps, found)
    return Finding(name, GROUP, passed, sentence, found.value, found.limit, unit, found.middle, span, "derived")
