"""Numbers that cannot be what their column says: times that do not increase, degrees, far too large ones."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import Problem
from tightspot.problems import shown

Array = NDArray[np.float64]

LARGEST = {"t": 1e12, "x": 1e11, "y": 1e11, "theta": 1e6}
"""Beyond these no column is believed; 1e6 for all others."""
LONGEST = 86_400.0
"""A manoeuvre does not last longer than a day, s."""
TURNS = 4 * np.pi
"""Headings beyond this are degrees unless the motion says otherwise, rad."""

_MOST = 20
_GOOD, _BAD = 0.03, 0.15


def since_1970(t: Array) -> tuple[Array, list[str]]:
    """Times that can only be milli-, micro- or nanoseconds since 1970 in seconds, and a note on that."""
    first = float(t[0]) if t.size else 0.0
    for name, factor in (("milliseconds", 1e3), ("microseconds", 1e6), ("nanoseconds", 1e9)):
        if 1e9 * factor <= first <= 5e9 * factor:
            return t / factor, [f"times are {name} since 1970"]
    return t, []


def implausible(
    values: Mapping[str, Array], explicit: Collection[str], names: Mapping[str, str], where: Sequence[str]
) -> list[Problem]:
    """What is wrong with the columns.

    Args:
        values: In SI units, by meaning.
        explicit: Columns whose unit is written in the file.
        names: Of the columns in the file.
        where: Each row's place in the file, for messages.
    """
    rows = values["x"].size
    if rows < 2:
        return [Problem("rows", f"are {rows}; a motion needs at least two")]
    problems: list[Problem] = []
    for key, column in values.items():
        beyond = np.flatnonzero(np.abs(column) > LARGEST.get(key, 1e6))
        if beyond.size:
            place = f"{where[beyond[0]]}, column {shown(names[key])}"
            problems.append(Problem(place, f"{column[beyond[0]]:g} is too large to be believed"))
    if problems:
        return problems
    if "t" in values:
        problems += _times(values["t"], names["t"], where) or _by_speeds(values, explicit, names)
    if "theta" in values and "theta" not in explicit:
        problems += _heading(values, names["theta"])
    if "delta" in values:
        problems += _steering(values["delta"], names["delta"], where)
    return problems


def _times(t: Array, name: str, where: Sequence[str]) -> list[Problem]:
    late = np.flatnonzero(np.diff(t) <= 0)
    column = f"column {shown(name)}"
    problems = [
        Problem(
            f"{where[k + 1]}, {column}",
            f"{t[k + 1]:.10g} s does not come after {t[k]:.10g} s in {where[k]}; times must increase"
            + ("" if t[k + 1] < t[k] else ": keep one of the two rows"),
        )
        for k in late[:_MOST].tolist()
    ]
    if late.size > _MOST:
        problems.append(Problem(column, f"does not increase in {late.size} rows in all"))
    if not late.size and t[-1] - t[0] > LONGEST:
        sentence = f"spans {t[-1] - t[0]:g} s, more than a day; write its unit, for example {name} [ms]"
        problems.append(Problem(column, sentence))
    return problems


def _by_speeds(values: Mapping[str, Array], explicit: Collection[str], names: Mapping[str, str]) -> list[Problem]:
    """Times are a thousand times too long if the way is a thousand times too short for the speeds; a way that is a
    hundred or a thousand times too long is in centimetres or millimetres."""
    if "v" not in values:
        return []
    speed = np.abs(values["v"])
    told = float((np.diff(values["t"]) * 0.5 * (speed[1:] + speed[:-1])).sum())
    driven = float(np.hypot(np.diff(values["x"]), np.diff(values["y"])).sum())
    if not (driven > 0 and told > 0):
        return []
    if "t" not in explicit and 900 < told / driven < 1100:
        sentence = f"looks like milliseconds by speeds and positions; write the unit, for example {names['t']} [ms]"
        return [Problem(f"column {shown(names['t'])}", sentence)]
    for unit, word, factor in (("cm", "centimetres", 100.0), ("mm", "millimetres", 1000.0)):
        if not {"x", "y"} & set(explicit) and 0.9 * factor < driven / told < 1.1 * factor:
            advice = f"write the units, for example {names['x']} [{unit}] and {names['y']} [{unit}]"
            columns = f"columns {shown(names['x'])} and {shown(names['y'])}"
            return [Problem(columns, f"look like {word} by times and speeds; {advice}")]
    return []


def _heading(values: Mapping[str, Array], name: str) -> list[Problem]:
    """Degrees are told by how the vehicle moves: along its heading."""
    theta = values["theta"]
    largest = float(theta[np.abs(theta).argmax()])
    radians = _sideways(values, theta)
    degrees = _sideways(values, np.radians(theta))
    beyond = abs(largest) > TURNS
    if (beyond and not radians < min(degrees, _BAD)) or (radians > _BAD and degrees < _GOOD and abs(largest) > np.pi):
        advice = f"{largest:g} deg = {np.radians(largest):.5g} rad; write the unit, for example {name} [deg]"
        sentence = f"{largest:g} rad looks like degrees; angles are in radians: {advice}"
        return [Problem(f"column {shown(name)}", sentence)]
    return []


def _sideways(values: Mapping[str, Array], theta: Array) -> float:
    """Share of the motion that is sideways to the mean heading of neighbouring rows; 1 if nothing moves."""
    turn = np.unwrap(theta)
    middle = 0.5 * (turn[1:] + turn[:-1])
    dx, dy = np.diff(values["x"]), np.diff(values["y"])
    length = float(np.hypot(dx, dy).sum())
    return float(np.abs(np.cos(middle) * dy - np.sin(middle) * dx).sum()) / length if length > 0 else 1.0


def _steering(delta: Array, name: str, where: Sequence[str]) -> list[Problem]:
    worst = int(np.abs(delta).argmax())
    value = float(delta[worst])
    if abs(value) < np.pi / 2:
        return []
    hint = f" = {np.radians(value):.5g} rad if it is in degrees; then write the unit, for example {name} [deg]"
    sentence = f"a steering angle of {value:g} rad is not below pi/2; {value:g}{hint}"
    return [Problem(f"{where[worst]}, column {shown(name)}", sentence)]
