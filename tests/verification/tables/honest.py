"""Honest tables: a vehicle driven by an integrator of the tests' own, sampled, rounded and written down; and lies."""

from __future__ import annotations

import functools
import math
from typing import NamedTuple

import numpy as np

from tightspot.geometry import ConvexPolygon
from tightspot.scenarios import Obstacle, Scenario, Tolerance
from tightspot.vehicles import Limits, SingleTrack

ISSUE = ("index", "x", "y", "theta", "v", "a", "sigma", "omega", "t")
STEP = 2e-3


class Drive(NamedTuple):
    """A motion every 2 ms: times (M,), states (M, 5), inputs (M, 2)."""

    t: np.ndarray
    states: np.ndarray
    inputs: np.ndarray

    def column(self, name: str) -> np.ndarray:
        places = {"x": 0, "y": 1, "theta": 2, "v": 3, "sigma": 4, "delta": 4}
        if name == "t":
            return self.t
        return self.inputs[:, ("a", "omega").index(name)] if name in ("a", "omega") else self.states[:, places[name]]


def drive(car: SingleTrack, seed: int, *, seconds: float = 8.0, hold: float = 0.5, heading: float = 0.7) -> Drive:
    """Random inputs within the limits, held for ``hold`` s: x' = v cos, y' = v sin, theta' = v tan(delta) / L."""
    return _drive(car.wheelbase, car.limits, seed, seconds, hold, heading)


@functools.cache
def _drive(L: float, limits: Limits, seed: int, seconds: float, hold: float, heading: float) -> Drive:
    rng, tan = np.random.default_rng(seed), math.tan

    def slope(s, u):
        return s[3] * math.cos(s[2]), s[3] * math.sin(s[2]), s[3] * tan(s[4]) / L, *u

    def moved(s, rates, by):
        return [x + by * rate for x, rate in zip(s, rates, strict=True)]

    count, h = round(seconds / STEP), STEP
    state, states, inputs = [0.0, 0.0, heading, 0.0, 0.0], [], []
    for k in range(count + 1):
        if k % round(hold / STEP) == 0:
            goal = rng.uniform((limits.speed[0], -limits.steering), (limits.speed[1], limits.steering))
            low, high = (limits.acceleration[0], -limits.steering_rate), (limits.acceleration[1], limits.steering_rate)
            u = np.clip((goal - state[3:]) / hold, low, high).tolist()
        states.append(state)
        inputs.append(u)
        k1 = slope(state, u)
        k2 = slope(moved(state, k1, h / 2), u)
        k3 = slope(moved(state, k2, h / 2), u)
        k4 = slope(moved(state, k3, h), u)
        state = [x + h / 6 * (p + 2 * q + 2 * r + w) for x, p, q, r, w in zip(state, k1, k2, k3, k4, strict=True)]
    motion = Drive(STEP * np.arange(count + 1), np.array(states), np.array(inputs))
    for array in motion:
        array.setflags(write=False)
    return motion


def text(
    motion: Drive,
    *,
    dt: float = 0.05,
    decimals: int | None = 4,
    columns: tuple[str, ...] = ISSUE,
    separator: str = "\t",
) -> str:
    """The motion as a table sampled every ``dt``; ``index`` is a column without a name."""
    rows = np.arange(0, motion.t.size, round(dt / STEP))
    lines = [separator.join("" if name == "index" else name for name in columns)]
    values = [None if name == "index" else motion.column(name)[rows] for name in columns]
    for k in range(rows.size):
        cells = [
            str(k) if v is None else repr(float(v[k])) if decimals is None else f"{v[k]:.{decimals}f}" for v in values
        ]
        lines.append(separator.join(cells))
    return "\n".join(lines) + "\n"


def scene(motion: Drive, obstacles=(), *, offset=(0.0, 0.0), room: float = 30.0) -> Scenario:
    """A scene around the motion that starts and ends where it does."""
    x = motion.states[:, :2]
    low, high = x.min(axis=0) - room, x.max(axis=0) + room
    ends = [state.copy() for state in (motion.states[0], motion.states[-1])]
    for state in ends:
        state[2] = np.angle(np.exp(1j * state[2]))
    return Scenario(
        name="around",
        workspace=ConvexPolygon.rectangle(low[0], high[0], low[1], high[1]),
        obstacles=tuple(Obstacle(f"o{i}", np.asarray(ring, float)) for i, ring in enumerate(obstacles)),
        start=ends[0],
        goal=ends[1],
        tolerance=Tolerance(),
        offset=np.array(offset),
    )


def sideways(motion: Drive, speed: float) -> Drive:
    """From the middle on the vehicle drifts to its left, for a second, at that speed (m/s)."""
    states = motion.states.copy()
    middle = motion.t.size // 2
    way = speed * np.clip(motion.t - motion.t[middle], 0, 1)
    theta = states[middle, 2]
    states[:, :2] += way[:, None] * np.array([-np.sin(theta), np.cos(theta)])
    return motion._replace(states=states)


def changed(motion: Drive, column: int, change, *, since: float = 0.0) -> Drive:
    """A state's column changed by a function from a time on."""
    states = motion.states.copy()
    late = motion.t >= since
    states[late, column] = change(states[late, column])
    return motion._replace(states=states)
