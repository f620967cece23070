"""What the vehicle does: the inputs, constant on each interval, integrated from the first knot's state.

The solver's knots are only its record of the motion. A replay starts where they start and never looks at them
again.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tightspot.errors import InputError, Problem
from tightspot.trajectory import Trajectory
from tightspot.vehicles import SingleTrack, VehicleModel
from tightspot.verification import compiled

if TYPE_CHECKING:
    from tightspot.verification.compiled import Motion

Array = NDArray[np.float64]

METHOD = "RK4, error estimated by step doubling"
MAX_STEPS = 400_000
LARGEST = 1e9
# Kept in reserve for rounding, in m and rad, on top of the estimated integration error.
RESERVE = 1e-9
_ROUNDING = 8 * np.finfo(float).eps  # of a step's sums, relative to the state


_OF_KNOTS = ("apart", "furthest", "defect", "_by_core")
"""What a replay finds out about its trajectory's knots."""


@dataclass(frozen=True, eq=False)
class Replay:
    """The motion of a vehicle, at any time.

    Attributes:
        vehicle: Whose dynamics were integrated.
        trajectory: Whose first state and inputs were used.
        substeps: RK4 steps in each interval, shape (N,).
        nodes: Times between the steps, s, shape (K+1,), all knots among them.
        node_states: The states there, shape (K+1, n_x).
        position_error: How far (x, y) may be from the exact solution at any time, m: the largest difference
            between this solution and one with steps twice as long. By Richardson's estimate the error is a
            fifteenth of it; the factor is kept as safety. It is an *estimate*: the certificate's checker has
            a proved bound.
        heading_error: The same for theta, rad.
        core: The same motion in the compiled core, if that knows the model. It stays in this process.
        accuracy: What was asked for: tolerance, m and rad, and longest first step, s.
    """

    vehicle: VehicleModel
    trajectory: Trajectory
    substeps: NDArray[np.intp]
    nodes: Array
    node_states: Array
    position_error: float
    heading_error: float
    core: Motion | None = field(default=None, repr=False)
    accuracy: tuple[float, float] | None = None

    def of_equal(self, trajectory: Trajectory) -> Replay:
        """The same motion for a trajectory that is equal in all that is integrated."""
        if trajectory is self.trajectory:
            return self
        kept = {name: value for name, value in self.__dict__.items() if name not in _OF_KNOTS}
        other: Replay = object.__new__(Replay)
        other.__dict__.update(kept, trajectory=trajectory)
        return other

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"core": None}

    @cached_property
    def first_nodes(self) -> NDArray[np.intp]:
        """Index of the node at each knot, shape (N+1,)."""
        return np.concatenate([np.zeros(1, np.intp), np.cumsum(self.substeps, dtype=np.intp)])

    @cached_property
    def knots(self) -> Array:
        """Replayed states at the trajectory's knots, shape (N+1, n_x)."""
        return self.node_states[self.first_nodes] if self.core is None else self.core.knots

    @cached_property
    def extremes(self) -> Array:
        """Smallest and largest value of each state at the nodes, shape (2, n_x)."""
        if self.core is not None:
            return self.core.extremes
        return np.stack([self.node_states.min(axis=0), self.node_states.max(axis=0)])

    def interval(self, times: ArrayLike) -> NDArray[np.intp]:
        """Index k of the interval ``[t_k, t_{k+1})`` that holds each time; the last one is closed."""
        k = np.searchsorted(self.trajectory.t, np.asarray(times, float), side="right") - 1
        return np.asarray(np.clip(k, 0, self.trajectory.steps - 1), dtype=np.intp)

    def at(self, times: ArrayLike) -> Array:
        """States at ``times`` (...) in s, shape (..., n_x): one RK4 step from the nearest node of the
        interval.

        Times outside the horizon are not extrapolated far: they get a single step from its end.
        """
        times = np.asarray(times, float)
        flat = times.ravel()
        if self.core is not None:
            return self.core.at(flat).reshape(*times.shape, self.vehicle.n_states)
        last = self.nodes.size - 1
        left = np.clip(np.searchsorted(self.nodes, flat, side="right") - 1, 0, last - 1)
        controls = self.trajectory.inputs[self._node_interval[left]]
        nearest = left + (flat - self.nodes[left] > self.nodes[left + 1] - flat)
        start = self.node_states[nearest]
        states = _rk4(self.vehicle, list(start.T), list(controls.T), flat - self.nodes[nearest], np)
        stacked = np.stack([np.broadcast_to(state, flat.shape) for state in states], axis=-1)
        return stacked.reshape(*times.shape, stacked.shape[-1])

    def dense(self, dt: float) -> Array:
        """Times at most ``dt`` apart that include every knot, s."""
        pieces = np.maximum(1, np.ceil(np.diff(self.trajectory.t) / dt - 1e-9)).astype(int)
        ends = zip(self.trajectory.t[:-1], self.trajectory.t[1:], pieces, strict=True)
        inner = [np.linspace(start, end, count + 1)[:-1] for start, end, count in ends]
        return np.concatenate([*inner, self.trajectory.t[-1:]])

    @cached_property
    def apart(self) -> Array:
        """The trajectory's knots less the replay's, shape (N+1, n_x)."""
        return self.trajectory.states - self.knots

    @cached_property
    def furthest(self) -> Array:
        """Largest absolute value of each column of :attr:`apart`, shape (n_x,)."""
        if self.core is not None:
            return self._by_core[1]
        return np.asarray(np.abs(self.apart).max(axis=0))

    @cached_property
    def _by_core(self) -> tuple[float, Array]:
        """Largest distance of positions and :attr:`furthest`, of a motion in the compiled core."""
        assert self.core is not None
        return self.core.apart(np.ascontiguousarray(self.trajectory.states))

    @cached_property
    def defect(self) -> tuple[float, float]:
        """Largest distance between the trajectory's knots and the replay: (position m, heading rad).

        Headings are compared as angles, so a whole turn between them does not count.
        """
        heading = float(self.furthest[2])
        position = float(np.hypot(*self.apart[:, :2].T).max()) if self.core is None else self._by_core[0]
        if not heading <= np.pi:
            turn = self.apart[:, 2]
            heading = float(np.abs(turn - 2 * np.pi * np.round(turn / (2 * np.pi))).max())
        return position, heading

    @cached_property
    def _node_interval(self) -> NDArray[np.intp]:
        return np.repeat(np.arange(self.substeps.size), self.substeps)


def replay(
    vehicle: VehicleModel,
    trajectory: Trajectory,
    *,
    tolerance: float = 1e-7,
    first_step: float = 0.125,
    in_core: bool = True,
    known: Replay | None = None,
) -> Replay:
    """Integrate the trajectory's inputs from its first state.

    Classical RK4 with equal steps in each interval. The number of steps is raised until the solution with n
    steps an interval and the one with 2n differ by less than ``tolerance`` in position and heading at every
    common node; the second is kept. RK4's error falls with the fourth power of the step, so the kept
    solution's error is about a fifteenth of that difference.

    Args:
        vehicle: Its dynamics are used through NumPy's (or Python's) sin, cos, tan.
        trajectory: Only its times, its first state and its inputs are used.
        tolerance: m and rad.
        first_step: The longest step of the first, coarser solution, s.
        in_core: By the compiled judge, if it knows the model; what is judged from it then is judged there, too.
        known: An earlier replay. If it was of the same motion, which is looked at here, nothing is integrated again.

    Raises:
        InputError: The names of states and inputs are not the vehicle's, a state exceeds 1e9, or the horizon
            is too long to be integrated to this tolerance.
    """
    _check_names(vehicle, trajectory)
    by_core = in_core and compiled.is_compiled(vehicle)
    made_to = by_core, (tolerance, first_step)
    if known and (known.core is not None, known.accuracy) == made_to and _is_of(known, vehicle, trajectory):
        return known.of_equal(trajectory)
    found = (_compiled if by_core else _replayed)(vehicle, trajectory, tolerance, first_step)
    if found is None:
        raise InputError(
            Problem(
                "trajectory",
                f"lasts {trajectory.duration:g} s and cannot be integrated to {tolerance:g} m within {MAX_STEPS} "
                f"steps and numbers below {LARGEST:g}; check times, speeds and steering angles",
            )
        )
    return found


def _is_of(known: Replay, vehicle: VehicleModel, trajectory: Trajectory) -> bool:
    """Whether it is of the same vehicle, and of a trajectory that is equal in all that is integrated."""
    other = known.trajectory
    return known.vehicle is vehicle and all(
        one is two or np.array_equal(one, two)
        for one, two in (
            (trajectory.t, other.t),
            (trajectory.inputs, other.inputs),
            (trajectory.states[0], other.states[0]),
        )
    )


def _compiled(vehicle: VehicleModel, trajectory: Trajectory, tolerance: float, first_step: float) -> Replay | None:
    """The replay in the compiled core."""
    accuracy = {"max_steps": MAX_STEPS, "largest": LARGEST, "reserve": RESERVE, "rounding": _ROUNDING}
    assert isinstance(vehicle, SingleTrack)
    core = compiled.integrated(vehicle, trajectory, tolerance=tolerance, first_step=first_step, **accuracy)
    if core is None:
        return None
    substeps = core.substeps.astype(np.intp)
    errors = core.position_error, core.heading_error
    return Replay(vehicle, trajectory, substeps, core.nodes, core.node_states, *errors, core, (tolerance, first_step))


def _replayed(vehicle: VehicleModel, trajectory: Trajectory, tolerance: float, first_step: float) -> Replay | None:
    """The same in NumPy; ``None`` if the motion leaves the finite numbers or needs too many steps."""
    durations, made_to = np.diff(trajectory.t), (tolerance, first_step)
    steps = np.maximum(1, np.ceil(durations / first_step))
    while 3 * steps.sum() < MAX_STEPS:
        count = steps.astype(np.intp)
        coarse, fine = _integrate(vehicle, trajectory, count), _integrate(vehicle, trajectory, 2 * count)
        if not (np.abs(fine) < LARGEST).all():
            return None
        difference = coarse[:, :3] - fine[::2, :3]
        position = float(np.hypot(difference[:, 0], difference[:, 1]).max())
        heading = float(np.abs(difference[:, 2]).max())
        excess = max(position, heading) / tolerance
        if excess <= 1:
            reserve = RESERVE + _ROUNDING * fine.shape[0] * np.abs(fine[:, :3]).max(axis=0)
            errors = position + float(reserve[:2].max()), heading + float(reserve[2])
            return Replay(vehicle, trajectory, 2 * count, _nodes(trajectory.t, 2 * count), fine, *errors, None, made_to)
        steps = np.ceil(steps * min(1.1 * excess**0.25, 8.0))
    return None


def _check_names(vehicle: VehicleModel, trajectory: Trajectory) -> None:
    for names in ("state_names", "input_names"):
        have, need = getattr(trajectory, names), getattr(vehicle, names)
        if tuple(have) != tuple(need):
            raise InputError(Problem(f"trajectory.{names}", f"are {have}, but {vehicle.name} needs {need}"))


def _nodes(t: Array, steps: NDArray[np.intp]) -> Array:
    ends = zip(t[:-1], t[1:], steps, strict=True)
    return np.concatenate([*(np.linspace(a, b, n + 1)[:-1] for a, b, n in ends), t[-1:]])


def _integrate(vehicle: VehicleModel, trajectory: Trajectory, steps: NDArray[np.intp]) -> Array:
    """States after every step, shape (sum(steps)+1, n_x); NaN where the motion leaves the finite numbers."""
    if vehicle.cascade:
        return _integrate_cascade(vehicle, trajectory, steps)
    states = np.full((int(steps.sum()) + 1, vehicle.n_states), np.nan)
    state: Sequence[Any] = trajectory.states[0].tolist()
    states[0], row = state, 0
    durations, inputs = np.diff(trajectory.t).tolist(), trajectory.inputs.tolist()
    try:
        for duration, control, count in zip(durations, inputs, steps.tolist(), strict=True):
            step = duration / count
            for _ in range(count):
                state = _rk4(vehicle, state, control, step, math)
                row += 1
                states[row] = state
    except (OverflowError, ValueError):  # how the math module answers infinity
        pass
    return states


def _integrate_cascade(vehicle: VehicleModel, trajectory: Trajectory, steps: NDArray[np.intp]) -> Array:
    """The same steps of the same scheme, all at once: group after group of the cascade is a sum of known rates."""
    h = np.repeat(np.diff(trajectory.t) / steps, steps)
    control = list(np.repeat(trajectory.inputs, steps, axis=0).T)
    nodes = np.zeros((vehicle.n_states, h.size + 1))
    stages = np.zeros((4, vehicle.n_states, h.size))
    with np.errstate(all="ignore"):
        for group in vehicle.cascade:
            rates = [vehicle.dynamics(list(stage), control, np) for stage in stages]
            for i in group:
                k1, k2, k3, k4 = (np.broadcast_to(rate[i], h.shape) for rate in rates)
                increments = h / 6 * (k1 + 2 * (k2 + k3) + k4)
                nodes[i] = np.cumsum(np.concatenate([trajectory.states[0, i : i + 1], increments]))
                stages[:, i] = nodes[i, :-1] + np.stack([np.zeros_like(h), 0.5 * h * k1, 0.5 * h * k2, h * k3])
    return np.ascontiguousarray(nodes.T)


def _rk4(vehicle: VehicleModel, state: Sequence[Any], control: Sequence[Any], h: Any, ns: Any) -> list[Any]:
    """One classical Runge-Kutta step of length h; entries may be numbers or arrays."""
    k1 = vehicle.dynamics(state, control, ns)
    k2 = vehicle.dynamics([x + 0.5 * h * k for x, k in zip(state, k1, strict=True)], control, ns)
    k3 = vehicle.dynamics([x + 0.5 * h * k for x, k in zip(state, k2, strict=True)], control, ns)
    k4 = vehicle.dynamics([x + h * k for x, k in zip(state, k3, strict=True)], control, ns)
    slopes = zip(state, k1, k2, k3, k4, strict=True)
    return [x + h / 6 * (a + 2 * (b + c) + d) for x, a, b, c, d in slopes]
