"""A trajectory that knows its vehicle, and so what happens between its knots."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tightspot.errors import InputError, Problem
from tightspot.trajectory import Trajectory
from tightspot.vehicles import VehicleModel
from tightspot.verification.replay import Replay, replay

Array = NDArray[np.float64]

SLACK = 1e-9
"""Times this far outside the horizon are rounding and taken as its end, s and relative to the end's time."""


@dataclass(frozen=True, eq=False)
class DrivenTrajectory(Trajectory):
    """A :class:`Trajectory` and the vehicle that drives it; its motion can be asked for at any time.

    Attributes:
        vehicle: Whose dynamics lead from one knot to the next; ``None`` until :meth:`of` sets it.
    """

    vehicle: VehicleModel | None = None

    @classmethod
    def of(cls, trajectory: Trajectory, vehicle: VehicleModel) -> DrivenTrajectory:
        """The same trajectory, driven by the vehicle; itself if it is that already."""
        if isinstance(trajectory, cls) and trajectory.vehicle is vehicle:
            return trajectory
        names = trajectory.state_names, trajectory.input_names
        made = cls.of_sound(trajectory.t, trajectory.states, trajectory.inputs, *names)
        made.__dict__["vehicle"] = vehicle
        return made

    @cached_property
    def replay(self) -> Replay:
        """The inputs integrated from the first knot's state; raises :class:`InputError` if that cannot be done."""
        if self.vehicle is None:
            raise InputError(Problem("vehicle", "is missing; make it with DrivenTrajectory.of(trajectory, vehicle)"))
        return replay(self.vehicle, self, in_core=False)

    def sample(self, times: ArrayLike) -> Array:
        """States at ``times`` (...) in s, shape (..., n_x), columns as in ``state_names``.

        The continuous motion that the judge certifies: the inputs, constant on each interval, integrated from the first
        knot's state to 1e-7 m and rad (:func:`tightspot.verification.replay.replay`); not an interpolation of the
        knots. In the coordinates of ``states``.

        Raises:
            InputError: A time before the first or after the last knot, or the trajectory cannot be integrated.
        """
        return self.replay.at(self._inside(times))

    def sample_inputs(self, times: ArrayLike) -> Array:
        """Inputs at ``times`` (...) in s, shape (..., n_u): those from that time on, at the end the last interval's.

        Raises:
            InputError: A time before the first or after the last knot, or the trajectory cannot be integrated.
        """
        return np.asarray(self.inputs[self.replay.interval(self._inside(times))])

    def _inside(self, times: ArrayLike) -> Array:
        """The times as an array, rounding beyond the ends put right."""
        try:
            asked = np.asarray(times, float)
        except (TypeError, ValueError):
            raise InputError(Problem("times", "must be a number or an array of numbers, s")) from None
        first, last = float(self.t[0]), float(self.t[-1])
        slack = SLACK * max(1.0, abs(last))
        outside = ~((asked >= first - slack) & (asked <= last + slack))
        if outside.any():
            sentence = (
                f"{asked[outside].flat[0]:g} s is outside [{first:g}, {last:g}] s; the motion is known only there"
            )
            raise InputError(Problem("times", sentence))
        return np.asarray(np.clip(asked, first, last), float)
