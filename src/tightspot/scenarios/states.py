"""States of a scene: (x, y, theta, v, delta), and whether the numbers look like metres and radians."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tightspot.errors import Problem, SceneError
from tightspot.scenarios.filed import in_file
from tightspot.scenarios.schema import StateSpec

Array = NDArray[np.float64]

STATE = ("x", "y", "theta", "v", "delta")
FREE = ("v", "delta")
"""Entries of a state that may be NaN, which means free."""


def as_state(value: ArrayLike, path: str) -> Array:
    """A read-only copy of shape (5,); a pose (x, y, theta) stands at rest with straight wheels.

    Raises:
        SceneError: If it is neither.
    """
    wanted = f"five numbers {', '.join(STATE)}, or the first three"
    try:
        state = np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise SceneError(Problem(path, f"must be {wanted}")) from None
    if state.shape not in ((3,), (5,)):
        raise SceneError(Problem(path, f"has shape {state.shape}; it must be {wanted}"))
    state = np.concatenate((state, np.zeros(5 - state.size)))
    state.setflags(write=False)
    return state


def from_spec(spec: StateSpec) -> Array:
    """The file's state as an array; ``null`` becomes NaN."""
    values = [getattr(spec, name) for name in STATE]
    return np.array([np.nan if value is None else value for value in values], dtype=float)


def to_dict(state: Array, offset: Array, original: Array | None = None) -> dict[str, float | None]:
    """The file's state, ``offset`` (m, m) added, see :func:`in_file`; NaN becomes ``None``."""
    values = in_file(state, np.array([*offset, 0.0, 0.0, 0.0]), original)
    return {name: None if np.isnan(value) else float(value) for name, value in zip(STATE, values, strict=True)}


def free_steering(state: Array) -> Array:
    """The state with a free steering angle."""
    return np.array([*state[:4], np.nan])


def state_problems(path: str, state: Array) -> list[Problem]:
    """What is wrong with a state's numbers for any vehicle: not finite, or degrees where radians belong."""
    problems = []
    for name, value in zip(STATE, state, strict=True):
        if np.isinf(value) or (np.isnan(value) and name not in FREE):
            problems.append(Problem(f"{path}.{name}", f"{value} is not a finite number"))
    theta, delta = state[2], state[4]
    if np.isfinite(theta) and abs(theta) > 4 * np.pi:
        problems.append(
            Problem(
                f"{path}.theta",
                f"{theta:g} rad is more than two turns and looks like degrees; "
                f"angles are in radians: {theta:g} deg = {np.radians(theta):.6g} rad",
            )
        )
    if np.isfinite(delta) and abs(delta) >= np.pi / 2:
        hint = f": {delta:g} deg = {np.radians(delta):.6g} rad" if abs(delta) > 2 else ""
        problems.append(
            Problem(
                f"{path}.delta",
                f"a steering angle of {delta:g} rad is not below pi/2 (90 deg); angles are in radians{hint}",
            )
        )
    return problems
