"""The kinematic single-track ("bicycle") model of the paper's equation (23)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from tightspot.errors import Problem, VehicleError
from tightspot.geometry.polygon import ConvexPolygon
from tightspot.geometry.stack import PolygonStack
from tightspot.vehicles.base import Array, BodyPart, MathNamespace, MotionBounds, VehicleModel

_SMOOTH_ACCELERATION, _SMOOTH_RATE, _SMOOTH_SPEED, _SMOOTH_STEERING = 0.1, 0.05, 0.1, 0.1


@dataclass(frozen=True)
class Limits:
    """Bounds that hold for all times.

    Attributes:
        speed: Lowest (reverse, negative) and highest rear-axle speed v, m/s.
        acceleration: Lowest and highest a, m/s^2.
        steering: Largest absolute steering angle delta, rad, below pi/2.
        steering_rate: Largest absolute steering rate omega, rad/s.
    """

    speed: tuple[float, float]
    acceleration: tuple[float, float]
    steering: float
    steering_rate: float


@dataclass(frozen=True, eq=False)
class SingleTrack(VehicleModel):
    """Kinematic single-track model, paper eq. (23), about the rear-axle midpoint::

        x' = v cos(theta)    y' = v sin(theta)    theta' = v tan(delta) / L    v' = a    delta' = omega

    State (x m, y m, theta rad, v m/s, delta rad), input (a m/s^2, omega rad/s). Wheels do not slip, so the model
    is for manoeuvring speeds.

    Attributes:
        name: As in the catalogue or the user's file.
        wheelbase: L, distance of the axles, m.
        body: Convex parts in the rear-axle frame (x forward, y left), m.
        limits: Bounds of speed, acceleration, steering angle and rate.
        source: Where the numbers come from.

    Raises:
        VehicleError: If a dimension or limit makes no sense; every problem is named.
    """

    name: str
    wheelbase: float
    body: tuple[BodyPart, ...]
    limits: Limits
    source: str = ""

    state_names = ("x", "y", "theta", "v", "delta")
    state_units = ("m", "m", "rad", "m/s", "rad")
    input_names = ("a", "omega")
    input_units = ("m/s^2", "rad/s")
    cascade = ((3, 4), (2,), (0, 1))

    def __post_init__(self) -> None:
        problems = _problems(self)
        if problems:
            raise VehicleError(problems)

    @classmethod
    def rectangular(
        cls,
        name: str,
        *,
        wheelbase: float,
        length: float,
        width: float,
        rear_overhang: float,
        limits: Limits,
        source: str = "",
    ) -> SingleTrack:
        """A car with a rectangular body; ``rear_overhang`` is the distance from rear axle to rear bumper, m."""
        sizes = {"length": length, "width": width, "rear_overhang": rear_overhang}
        problems = [
            Problem(field, f"{value} m is not a length; give a positive, finite number of metres")
            for field, value in sizes.items()
            if not (np.isfinite(value) and (value > 0 or (field == "rear_overhang" and value == 0)))
        ]
        if problems:
            raise VehicleError(problems)
        polygon = ConvexPolygon.rectangle(-rear_overhang, length - rear_overhang, -width / 2, width / 2)
        return cls(name, wheelbase, (BodyPart("body", polygon),), limits, source)

    @property
    def parts(self) -> tuple[BodyPart, ...]:
        return self.body

    @property
    def state_bounds(self) -> tuple[Array, Array]:
        low, high = self.limits.speed
        free, steering = np.inf, self.limits.steering
        return np.array([-free, -free, -free, low, -steering]), np.array([free, free, free, high, steering])

    @property
    def input_bounds(self) -> tuple[Array, Array]:
        low, high = self.limits.acceleration
        rate = self.limits.steering_rate
        return np.array([low, -rate]), np.array([high, rate])

    @property
    def min_turning_radius(self) -> float:
        """Smallest radius of the rear-axle midpoint's circle, L / tan(delta_max), m."""
        return float(self.wheelbase / np.tan(self.limits.steering))

    def dynamics(self, state: Sequence[Any], control: Sequence[Any], ns: MathNamespace) -> list[Any]:
        theta, v, delta = state[2], state[3], state[4]
        return [v * ns.cos(theta), v * ns.sin(theta), v * ns.tan(delta) / self.wheelbase, control[0], control[1]]

    @cached_property
    def part_stack(self) -> PolygonStack:
        """The polygons of the body's parts in one array."""
        return PolygonStack(part.polygon for part in self.parts)

    def frames(self, state: Sequence[Any], ns: MathNamespace) -> list[tuple[Any, Any, Any]]:
        return [(state[0], state[1], state[2])]

    def motion_bounds(self, before: Array, after: Array, controls: Array) -> list[MotionBounds]:
        """See :meth:`VehicleModel.motion_bounds`.

        v and delta are linear in time on an interval of constant input, so their absolute values are largest at
        an end; tan is monotone on (-pi/2, pi/2). Beyond pi/2 nothing is bounded and infinity is returned.
        With kappa = tan|delta|/L: ``|theta'| <= |v| kappa``, ``|p''| = sqrt(a^2 + (v theta')^2)`` and
        ``|theta''| <= (|a| tan|delta| + |v| |omega| / cos(delta)^2) / L``.
        """
        speed = np.maximum(np.abs(before[:, 3]), np.abs(after[:, 3]))
        steering = np.maximum(np.abs(before[:, 4]), np.abs(after[:, 4]))
        a, omega = np.abs(controls[:, 0]), np.abs(controls[:, 1])
        inside = steering < np.pi / 2
        tangent = np.tan(np.where(inside, steering, 0.0))
        yaw_rate = speed * tangent / self.wheelbase
        acceleration = np.hypot(a, speed * yaw_rate)
        yaw_acceleration = (a * tangent + speed * omega * (1 + tangent**2)) / self.wheelbase
        unbounded = np.where(inside, 0.0, np.inf)
        return [MotionBounds(speed, yaw_rate + unbounded, acceleration + unbounded, yaw_acceleration + unbounded)]

    def acceleration_bound(
        self, frame: int, rho: float, middle: Sequence[Any], control: Sequence[Any], half: Any, ns: MathNamespace
    ) -> Any:
        """See :meth:`VehicleModel.acceleration_bound`.

        v and delta are linear in time, so ``V = |v_mid| + |a| half`` and ``D = |delta_mid| + |omega| half`` are their
        largest absolute values. tan is convex on [0, delta_max], so ``tan(D) <= D tan(delta_max) / delta_max``; with
        ``kappa`` that divided by L and ``r = V kappa``, the bounds of :meth:`motion_bounds` give::

            sqrt(a^2 + (V r)^2) + rho sqrt((|a| kappa + V |omega| (1 + tan(delta_max)^2) / L)^2 + r^4)

        Absolute values are smoothed upwards, ``|z| <= sqrt(z^2 + s^2)``. It holds while ``|delta| <= delta_max``.
        """
        tangent, limit = ns.tan(self.limits.steering), self.limits.steering
        a = ns.sqrt(control[0] ** 2 + _SMOOTH_ACCELERATION**2)
        omega = ns.sqrt(control[1] ** 2 + _SMOOTH_RATE**2)
        speed = ns.sqrt(middle[3] ** 2 + _SMOOTH_SPEED**2) + a * half
        steering = ns.sqrt(middle[4] ** 2 + _SMOOTH_STEERING**2) + omega * half
        kappa = steering * tangent / (limit * self.wheelbase)
        yaw_rate = speed * kappa
        yaw_acceleration = a * kappa + speed * omega * (1 + tangent**2) / self.wheelbase
        centre = ns.sqrt(a**2 + (speed * yaw_rate) ** 2)
        return centre + rho * ns.sqrt(yaw_acceleration**2 + yaw_rate**4)

    @property
    def moves_as_stated(self) -> bool:
        """False for a subclass with dynamics or frames of its own: no closed form of this model's motion is its."""
        own = type(self)
        return own.dynamics is SingleTrack.dynamics and own.frames is SingleTrack.frames

    def to_dict(self) -> dict[str, Any]:
        return {
            "name": self.name,
            "model": "single_track",
            "wheelbase": self.wheelbase,
            "body": [{"name": part.name, "vertices": part.polygon.vertices.tolist()} for part in self.body],
            "limits": {
                "speed": list(self.limits.speed),
                "acceleration": list(self.limits.acceleration),
                "steering": self.limits.steering,
                "steering_rate": self.limits.steering_rate,
            },
            "source": self.source,
        }


_PLAUSIBLE = {"speed": (100.0, "m/s"), "acceleration": (100.0, "m/s^2")}
_PLAUSIBLE_STEERING_RATE = 10.0


def _problems(vehicle: SingleTrack) -> list[Problem]:
    problems = _body_problems(vehicle.body)
    limits = vehicle.limits
    if not (np.isfinite(vehicle.wheelbase) and vehicle.wheelbase > 0):
        problems.append(Problem("wheelbase", f"{vehicle.wheelbase} m must be a positive, finite length"))
    for field, (largest, unit) in _PLAUSIBLE.items():
        low, high = getattr(limits, field)
        if not (-largest <= low < 0 < high <= largest):
            sentence = f"[{low}, {high}] {unit} must be [below 0, above 0] and within {largest:g} {unit}"
            problems.append(Problem(f"limits.{field}", sentence))
    if not 0 < limits.steering < np.pi / 2:
        sentence = f"{limits.steering} rad must lie strictly between 0 and pi/2 (90 deg)"
        problems.append(Problem("limits.steering", sentence + _in_radians(limits.steering, 90.0)))
    if not 0 < limits.steering_rate <= _PLAUSIBLE_STEERING_RATE:
        largest = _PLAUSIBLE_STEERING_RATE
        sentence = f"{limits.steering_rate} rad/s must be positive and at most {largest:g} rad/s"
        problems.append(Problem("limits.steering_rate", sentence + _in_radians(limits.steering_rate, 3600.0)))
    return problems


def _body_problems(body: tuple[BodyPart, ...]) -> list[Problem]:
    problems = [] if body else [Problem("body", "has no part; give at least one polygon or a rectangle")]
    first: dict[str, int] = {}
    for index, part in enumerate(body):
        if part.name in first:
            sentence = f"{part.name!r} is already the name of body[{first[part.name]}]; names must differ"
            problems.append(Problem(f"body[{index}].name", sentence))
        first.setdefault(part.name, index)
        if part.frame != 0:
            sentence = f"{part.frame} must be 0: this model has one frame"
            problems.append(Problem(f"body[{index}].frame", sentence))
    return problems


def _in_radians(value: float, largest_degrees: float) -> str:
    """What to do about a number that is too large for radians but would do as degrees."""
    if not 1.0 < value < largest_degrees:
        return ""
    return f"; angles are in radians: {value:g} deg = {np.radians(value):.4g} rad"
