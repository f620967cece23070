"""A trajectory: knot times, states at the knots, inputs constant on each interval.

The vehicle does what its inputs say: between the knots the state is the solution of the dynamics under the
interval's constant input. The states at the knots are the solver's (or a replay's) record of it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tightspot.errors import InputError, Problem

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Trajectory:
    """States ``xi_k`` at times ``t_k`` and inputs ``u_k`` on ``[t_k, t_{k+1})``.

    Attributes:
        t: Knot times in s, shape (N+1,), strictly increasing, first 0.
        states: Shape (N+1, n_x), columns named by ``state_names``.
        inputs: Shape (N, n_u), columns named by ``input_names``.
        state_names: For the single-track model ``("x", "y", "theta", "v", "delta")``.
        input_names: For the single-track model ``("a", "omega")``.

    Raises:
        InputError: If the shapes disagree, a number is not finite or time does not increase.
    """

    t: Array
    states: Array
    inputs: Array
    state_names: tuple[str, ...] = ("x", "y", "theta", "v", "delta")
    input_names: tuple[str, ...] = ("a", "omega")

    def __post_init__(self) -> None:
        for field in ("t", "states", "inputs"):
            value = np.array(getattr(self, field), dtype=float)
            value.setflags(write=False)
            object.__setattr__(self, field, value)
        self._check()

    @classmethod
    def of_sound(
        cls, t: Array, states: Array, inputs: Array, state_names: tuple[str, ...], input_names: tuple[str, ...]
    ) -> Self:
        """From arrays of our own making that are known to be in order: neither checked nor copied."""
        made = object.__new__(cls)
        for field, value in (("t", t), ("states", states), ("inputs", inputs)):
            value.setflags(write=False)
            made.__dict__[field] = value
        made.__dict__["state_names"], made.__dict__["input_names"] = state_names, input_names
        return made

    def _check(self) -> None:
        knots = self.t.size
        expected = {"states": (knots, len(self.state_names)), "inputs": (knots - 1, len(self.input_names))}
        if self.t.ndim != 1 or knots < 2:
            raise InputError(Problem("t", "a trajectory needs at least two knot times in one list"))
        for field, shape in expected.items():
            if getattr(self, field).shape != shape:
                raise InputError(
                    Problem(field, f"the shape is {getattr(self, field).shape}, but {knots} knots need {shape}")
                )
        for field in ("t", "states", "inputs"):
            if not np.isfinite(getattr(self, field)).all():
                raise InputError(Problem(field, "contains a number that is not finite; remove or repair it"))
        backwards = self.t[1:] <= self.t[:-1]
        if backwards.any():
            k = int(np.argmax(backwards))
            raise InputError(
                Problem(f"t[{k + 1}]", f"{self.t[k + 1]:g} s does not come after {self.t[k]:g} s; times must increase")
            )

    @property
    def steps(self) -> int:
        """Number of intervals N (the paper's k_f)."""
        return self.t.size - 1

    @property
    def duration(self) -> float:
        """Final time t_f minus the first knot time, in s."""
        return float(self.t[-1] - self.t[0])

    def column(self, name: str) -> Array:
        """One state over the knots (N+1,) or one input over the intervals (N,), by name."""
        if name in self.state_names:
            return self.states[:, self.state_names.index(name)]
        if name in self.input_names:
            return self.inputs[:, self.input_names.index(name)]
        raise InputError(f"a trajectory has no column {name!r}; it has {self.state_names + self.input_names}")

    @property
    def poses(self) -> Array:
        """(x, y, theta) at the knots, shape (N+1, 3)."""
        return np.column_stack([self.column("x"), self.column("y"), self.column("theta")])

    def shifted(self, offset: ArrayLike) -> Trajectory:
        """The same motion with ``offset`` (m, m) added to x and y."""
        states = self.states.copy()
        states[:, [self.state_names.index("x"), self.state_names.index("y")]] += np.asarray(offset, float)
        return Trajectory(self.t, states, self.inputs, self.state_names, self.input_names)

    def to_dict(self) -> dict[str, Any]:
        """The plan file's ``trajectory`` object: lists by name."""
        return {
            "t": self.t.tolist(),
            "states": {name: self.column(name).tolist() for name in self.state_names},
            "inputs": {name: self.column(name).tolist() for name in self.input_names},
        }

    @classmethod
    def from_dict(
        cls, data: Mapping[str, Any], state_names: Sequence[str] | None = None, input_names: Sequence[str] | None = None
    ) -> Trajectory:
        """Inverse of :meth:`to_dict`; raises :class:`InputError` naming the field that is missing or odd."""
        problems = [Problem(key, "is missing") for key in ("t", "states", "inputs") if key not in data]
        for key in ("states", "inputs"):
            if key in data and not (isinstance(data[key], Mapping) and data[key]):
                problems.append(Problem(key, "must be an object of lists, one a name"))
        if problems:
            raise InputError(problems)
        columns: dict[str, list[Array]] = {}
        names = {"states": tuple(state_names or data["states"]), "inputs": tuple(input_names or data["inputs"])}
        for key, wanted in names.items():
            missing = [name for name in wanted if name not in data[key]]
            unknown = [name for name in data[key] if name not in wanted]
            if missing or unknown:
                raise InputError(Problem(key, f"needs exactly {list(wanted)}; missing {missing}, unknown {unknown}"))
            columns[key] = [_numbers(data[key][name], f"{key}.{name}") for name in wanted]
            if len({column.size for column in columns[key]}) != 1:
                raise InputError(
                    Problem(key, "has lists of different lengths; each needs one number a knot or interval")
                )
        return cls(
            _numbers(data["t"], "t"),
            np.column_stack(columns["states"]),
            np.column_stack(columns["inputs"]),
            names["states"],
            names["inputs"],
        )


def _numbers(values: Any, path: str) -> Array:
    try:
        array = np.array(values, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise InputError(Problem(path, "must be a list of numbers")) from None
    if array.ndim != 1:
        raise InputError(Problem(path, "must be a plain list of numbers"))
    return array
