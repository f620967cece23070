"""What a vehicle must say of itself: dynamics, limits and the bodies that must not touch anything."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import Problem, VehicleError
from tightspot.geometry.polygon import ConvexPolygon

Array = NDArray[np.float64]


class MathNamespace(Protocol):
    """The functions dynamics may use; NumPy and CasADi both provide them."""

    def sin(self, x: Any, /) -> Any: ...
    def cos(self, x: Any, /) -> Any: ...
    def tan(self, x: Any, /) -> Any: ...
    def sqrt(self, x: Any, /) -> Any: ...


@dataclass(frozen=True)
class BodyPart:
    """A convex polygon fixed to one of the vehicle's frames.

    Attributes:
        name: For messages and certificates.
        polygon: Vertices ``V0`` and half-planes ``C0 q <= d0`` in the frame's coordinates, m.
        frame: Index into :meth:`VehicleModel.frames`; 0 is the frame of the rear-axle midpoint.
    """

    name: str
    polygon: ConvexPolygon
    frame: int = 0


class MotionBounds(NamedTuple):
    """How fast one frame can move during intervals of constant input; every entry has shape (M,).

    A body point at distance rho from the frame's origin has speed at most ``speed + yaw_rate * rho`` and
    acceleration at most ``acceleration + (yaw_acceleration + yaw_rate**2) * rho``.

    Attributes:
        speed: Bound of the origin's speed, m/s.
        yaw_rate: Bound of the absolute turning rate, rad/s.
        acceleration: Bound of the norm of the origin's acceleration, m/s^2.
        yaw_acceleration: Bound of the absolute turning acceleration, rad/s^2.
    """

    speed: Array
    yaw_rate: Array
    acceleration: Array
    yaw_acceleration: Array


class VehicleModel(ABC):
    """Dynamics ``xi' = f(xi, u)``, bounds and bodies of a vehicle.

    The state's first three entries are the pose (x, y, theta) of the rear-axle midpoint.

    What a class states of its motion holds for its own motion. A subclass that replaces :meth:`dynamics` or
    :meth:`frames` therefore inherits neither :attr:`cascade` nor :meth:`acceleration_bound`, and has to define
    :meth:`motion_bounds` anew: the parent's would have the judge certify another vehicle's motion.
    """

    name: str
    state_names: tuple[str, ...]
    state_units: tuple[str, ...]
    input_names: tuple[str, ...]
    input_units: tuple[str, ...]
    cascade: tuple[tuple[int, ...], ...] = ()
    """Groups of states, all of them, such that a group's rates depend on the inputs and on groups before it only. Then
    all times can be integrated at once. Empty if the dynamics are not of this kind."""

    def __init_subclass__(cls, **arguments: Any) -> None:
        super().__init_subclass__(**arguments)
        for fact, about in _STATED.items():
            stated = _place(cls, fact)
            if min(_place(cls, name) for name in about) >= stated:
                continue
            default = getattr(VehicleModel, fact)
            if not getattr(default, "__isabstractmethod__", False):
                setattr(cls, fact, default)
            elif cls.__mro__[stated] is not VehicleModel:
                setattr(cls, fact, _not_stated)

    @property
    @abstractmethod
    def parts(self) -> tuple[BodyPart, ...]:
        """The convex parts whose union is the body."""

    @property
    @abstractmethod
    def state_bounds(self) -> tuple[Array, Array]:
        """Lower and upper bounds of the state, each (n_x,), infinite where free. They hold for all times."""

    @property
    @abstractmethod
    def input_bounds(self) -> tuple[Array, Array]:
        """Lower and upper bounds of the input, each (n_u,)."""

    @abstractmethod
    def dynamics(self, state: Sequence[Any], control: Sequence[Any], ns: MathNamespace) -> list[Any]:
        """``f(xi, u)`` entry by entry, written with ``ns.sin``, ``ns.cos``, ``ns.tan``, so that NumPy arrays
        and CasADi symbols share one text. ``state[i]`` is the i-th entry (a number, array or symbol)."""

    @abstractmethod
    def frames(self, state: Sequence[Any], ns: MathNamespace) -> list[tuple[Any, Any, Any]]:
        """(x, y, theta) of every frame that carries a body part, as functions of the state."""

    @abstractmethod
    def motion_bounds(self, before: Array, after: Array, controls: Array) -> list[MotionBounds]:
        """Bounds that hold on whole intervals of constant input.

        Args:
            before: States at the intervals' beginnings, shape (M, n_x).
            after: States at their ends, shape (M, n_x).
            controls: The constant inputs, shape (M, n_u).

        Returns:
            One :class:`MotionBounds` a frame, each entry of shape (M,).
        """

    def fastest(self) -> list[MotionBounds]:
        """:meth:`motion_bounds` at the vehicle's limits, each entry of shape (1,)."""
        lower, upper = self.state_bounds
        extreme = np.where(np.isfinite(upper), np.maximum(np.abs(lower), np.abs(upper)), 0.0)[None]
        inputs = np.maximum(*(np.abs(bound) for bound in self.input_bounds))[None]
        return self.motion_bounds(extreme, extreme, inputs)

    def acceleration_bound(
        self, frame: int, rho: float, middle: Sequence[Any], control: Sequence[Any], half: Any, ns: MathNamespace
    ) -> Any:
        """Smooth upper bound of the acceleration of a body point during an interval of constant input, m/s^2.

        The default is the constant bound within the vehicle's limits; a model may give a tighter one that depends
        on the motion, as long as it is twice differentiable in it.

        Args:
            frame: The frame that carries the point.
            rho: Distance of the point from the frame's origin, m.
            middle: State in the middle of the interval, entry by entry.
            control: The constant input, entry by entry.
            half: Half the interval's duration, s.
            ns: NumPy or CasADi.
        """
        bounds = self.fastest()[frame]
        rotation = bounds.yaw_acceleration[0] + bounds.yaw_rate[0] ** 2
        return float(bounds.acceleration[0] + rotation * rho)

    @abstractmethod
    def to_dict(self) -> dict[str, Any]:
        """The plan file's ``vehicle`` object, from which :func:`tightspot.vehicles.from_dict` rebuilds it."""

    @property
    def n_states(self) -> int:
        """Number of states."""
        return len(self.state_names)

    @property
    def n_inputs(self) -> int:
        """Number of inputs."""
        return len(self.input_names)


_STATED = {
    "cascade": ("dynamics",),
    "motion_bounds": ("dynamics", "frames"),
    "acceleration_bound": ("dynamics", "frames"),
}
"""What a model states, and the methods that it is stated of."""


def _place(cls: type, name: str) -> int:
    """How far up in the method resolution order an attribute is defined."""
    return next(place for place, base in enumerate(cls.__mro__) if name in vars(base))


def _not_stated(self: VehicleModel, *_: Array) -> list[MotionBounds]:
    sentence = "has dynamics or frames of its own; define motion_bounds for them, too: its parent's hold for the parent"
    raise VehicleError(Problem("vehicle", f"{type(self).__name__} {sentence}"))
