"""The four vehicles of CommonRoad, with the dimensions by which its checkers judge a solution.

CommonRoad gives positions at the vehicle's *centre*: the middle of its rectangle, which it takes to be the centre of
gravity, too, ``b`` in front of the rear axle. So the rear overhang is ``length / 2 - b``.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from tightspot.vehicles.single_track import Limits, SingleTrack

_SOURCE = (
    "Althoff, Wuersching: CommonRoad: Vehicle Models, 2020, and commonroad-vehicle-models 3.0.2, vehicle {number} "
    "({title}); speed and acceleration reduced to manoeuvring values"
)


class _Dimensions(NamedTuple):
    """Metres; a and b from the centre to the front and the rear axle; rad and rad/s."""

    title: str
    length: float
    width: float
    a: float
    b: float
    steering: float
    steering_rate: float
    reverse: float


_VEHICLES = {
    "commonroad-ford-escort": _Dimensions("Ford Escort", 4.298, 1.674, 0.88392, 1.50876, 0.91, 0.4, -5.0),
    "commonroad-bmw-320i": _Dimensions("BMW 320i", 4.508, 1.61, 1.1561957064, 1.4227170936, 1.066, 0.4, -5.0),
    "commonroad-vw-vanagon": _Dimensions(
        "VW Vanagon", 4.569, 1.844, 1.1507916024, 1.3211363976000001, 1.023, 0.4, -5.0
    ),
    "commonroad-truck": _Dimensions("truck", 5.1, 2.55, 1.8, 1.8, 0.55, 0.7103, -2.78),
}

VEHICLE_TYPES: dict[int, str] = dict(enumerate(_VEHICLES, start=1))
"""Names in our catalogue by CommonRoad's number of the vehicle type."""


def _vehicle(name: str) -> SingleTrack:
    size, number = _VEHICLES[name], 1 + list(_VEHICLES).index(name)
    return SingleTrack.rectangular(
        name,
        wheelbase=size.a + size.b,
        length=size.length,
        width=size.width,
        rear_overhang=size.length / 2 - size.b,
        limits=Limits(
            speed=(size.reverse, 14.0),
            acceleration=(-3.0, 3.0),
            steering=size.steering,
            steering_rate=size.steering_rate,
        ),
        source=_SOURCE.format(number=number, title=size.title),
    )


COMMONROAD: dict[str, Callable[[], SingleTrack]] = {name: partial(_vehicle, name) for name in _VEHICLES}
