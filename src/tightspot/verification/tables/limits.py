"""The vehicle's limits: in the columns, and in what happens between the rows whatever the columns say."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from tightspot.verification.tables.consistency import Tolerances
from tightspot.verification.tables.findings import Finding, Place, not_judged
from tightspot.verification.tables.means import Change, speed_changes, steering_changes
from tightspot.verification.tables.steps import Steps
from tightspot.verification.tables.windows import Stretch, worst_absolute_sum, worst_sum

Array = NDArray[np.float64]

GROUP = "limits"
_UNITS = {"v": "m/s", "a": "m/s^2", "delta": "rad", "omega": "rad/s"}
_WORDS = {"v": "speed", "a": "acceleration", "delta": "steering", "omega": "steering rate"}


def limits(steps: Steps, place: Place, tolerances: Tolerances) -> list[Finding]:
    """Each column against its limits, then the means between the rows; in a fixed order.

    Between the rows, the mean speed, acceleration and steering rate over an interval are values that the motion takes
    on; so is a steering angle for the mean curvature. If they break a limit, the motion does.
    """
    bounds = _bounds(steps)
    columns = [_column(steps, place, tolerances, name, *bounds[name]) for name in _WORDS]
    return [
        *columns,
        _speed_between(steps, place, tolerances, *bounds["v"]),
        _change_between(steps, place, tolerances, "a", *bounds["a"]),
        _steering_between(steps, place, tolerances),
        _change_between(steps, place, tolerances, "omega", *bounds["omega"]),
    ]


def _bounds(steps: Steps) -> dict[str, tuple[float, float]]:
    own = steps.vehicle.limits
    return {
        "v": own.speed,
        "a": own.acceleration,
        "delta": (-own.steering, own.steering),
        "omega": (-own.steering_rate, own.steering_rate),
    }


def _column(steps: Steps, place: Place, tolerances: Tolerances, name: str, low: float, high: float) -> Finding:
    column, word, unit = steps.table.get(name), _WORDS[name], _UNITS[name]
    if column is None:
        return not_judged(word, GROUP, "there is no such column" + ("" if steps.h is None else "; see between rows"))
    excess = np.maximum(low - column, column - high)
    row = int(excess.argmax())
    allowed = steps.rounding(name) + tolerances.bounds
    passed, beyond = bool(excess[row] <= allowed), max(0.0, float(excess[row]))
    how = f"{column[row]:.4g} {unit} {place.words(row)}, limits {low:.4g} to {high:.4g}"
    sentence = f"{word}: {'nearest to a limit is' if passed else 'beyond a limit is'} {how}"
    return Finding(word, GROUP, passed, sentence, beyond, allowed, unit, float(row), None, "column")


def _speed_between(steps: Steps, place: Place, tolerances: Tolerances, low: float, high: float) -> Finding:
    name, h = "speed between rows", steps.h
    if h is None:
        return not_judged(name, GROUP, "there are no times")
    xy = np.sqrt(2) * steps.xy
    ends = 2 * (xy + steps.rounding("t") * max(-low, high)) + tolerances.absolute * 0.1
    blur = xy * np.abs(steps.turn)
    found = max(
        (worst_sum(steps.along, high * h + blur, ends), worst_sum(-steps.along, -low * h + blur, ends)),
        key=lambda stretch: stretch.ratio,
    )
    return _mean(name, found, float(h[found.first : found.last].sum()), "m/s", place)


def _change_between(steps: Steps, place: Place, tolerances: Tolerances, name: str, low: float, high: float) -> Finding:
    """Acceleration or steering rate from the column that it changes, else from how the poses move."""
    word, unit = f"{_WORDS[name]} between rows", _UNITS[name]
    changed, h = steps.table.get("v" if name == "a" else "delta"), steps.h
    if h is None:
        return not_judged(word, GROUP, "there are no times")
    if changed is None and steps.derived_heading and name == "omega":
        return not_judged(word, GROUP, "the headings are the directions of motion themselves")
    if changed is None:
        changes = speed_changes(steps, h) if name == "a" else steering_changes(steps, h)
        return _from_means(word, changes, low, high, unit, place)
    change = np.diff(changed)
    rounding = steps.rounding("v" if name == "a" else "delta")
    ends = 2 * (rounding + steps.rounding("t") * max(-low, high)) + tolerances.bounds
    found = max(
        (worst_sum(change, high * h, ends), worst_sum(-change, -low * h, ends)), key=lambda stretch: stretch.ratio
    )
    return _mean(word, found, float(h[found.first : found.last].sum()), unit, place)


def _steering_between(steps: Steps, place: Place, tolerances: Tolerances) -> Finding:
    """Turning more than the largest steering angle allows on the way that was driven."""
    name = "steering between rows"
    longest = steps.length + steps.hidden + 2 * np.sqrt(2) * steps.xy
    allowance = steps.curvature * longest * (1 + tolerances.relative)
    found = worst_absolute_sum(steps.turn, allowance, 2 * steps.heading_blur + 0.1 * tolerances.absolute)
    length = float(steps.length[found.first : found.last].sum())
    sentence = f"{name}: turns by {found.value:.4f} rad on {length:.3f} m {place.words(found.middle)}"
    sentence += f" (at most {found.limit:.4f} rad are possible)"
    passed = bool(found.ratio <= 1)
    return Finding(name, GROUP, passed, sentence, found.value, found.limit, "rad", found.middle, length, "derived")


def _mean(name: str, found: Stretch, span: float, unit: str, place: Place) -> Finding:
    """A finding about a mean: the sum over a stretch divided by its duration."""
    value, limit, passed = max(0.0, found.value / span), found.limit / span, bool(found.ratio <= 1)
    sentence = f"{name}: {value:.4g} {unit} on average over {span:.3g} s {place.words(found.middle)}"
    sentence += f" (at most {limit:.4g} fits)"
    return Finding(name, GROUP, passed, sentence, value, limit, unit, found.middle, span, "derived")


def _from_means(name: str, changes: Iterator[Change], low: float, high: float, unit: str, place: Place) -> Finding:
    """A rate from means over neighbouring stretches."""
    worst: tuple[float, float, float, float] | None = None
    for change in changes:
        allowed = np.where(change.value > 0, high, -low) * change.time + change.blur
        ratio = np.abs(change.value) / allowed
        k = int(ratio.argmax())
        if worst is None or ratio[k] > worst[0]:
            rate, limit = np.abs(change.value[k]) / change.time[k], allowed[k] / change.time[k]
            worst = float(ratio[k]), float(rate), float(limit), float(change.row[k])
    if worst is None:
        return not_judged(name, GROUP, "it cannot be told from so short a way")
    ratio_, value, limit, row = worst
    sentence = f"{name}: {value:.4g} {unit} as the poses move, {place.words(row)} (at most {limit:.4g} fits)"
    return Finding(name, GROUP, bool(ratio_ <= 1), sentence, value, limit, unit, row, None, "derived")
