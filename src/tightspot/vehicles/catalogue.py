"""Published vehicles, each with its source. All poses are of the rear-axle midpoint."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tightspot.errors import Problem, VehicleError
from tightspot.geometry.polygon import ConvexPolygon
from tightspot.vehicles.base import BodyPart
from tightspot.vehicles.commonroad import COMMONROAD
from tightspot.vehicles.single_track import Limits, SingleTrack

_PAPER_LIMITS = Limits(
    speed=(-5 / 3.6, 5 / 3.6),
    acceleration=(-1.0, 1.0),
    steering=float(np.radians(40)),
    steering_rate=float(np.radians(5)),
)


def paper() -> SingleTrack:
    """The car of the paper, section 7, with the printed wheelbase and the units of NOTES.md, erratum 6."""
    return SingleTrack.rectangular(
        "paper",
        wheelbase=2.796,
        length=4.628,
        width=2.097,
        rear_overhang=0.929,
        limits=_PAPER_LIMITS,
        source="Fan, Murgovski, Liang: Efficient collision avoidance for autonomous vehicles in polygonal domains, "
        "arXiv 2308.09103, section 7",
    )


def paper_recovered() -> SingleTrack:
    """The car that reproduces the paper's Table II: the wheelbase is the car's length."""
    return SingleTrack.rectangular(
        "paper-recovered",
        wheelbase=4.628,
        length=4.628,
        width=2.097,
        rear_overhang=0.928,
        limits=_PAPER_LIMITS,
        source="Recovered from Table II of arXiv 2308.09103: L = 4.628 m reproduces its objective values, the "
        "printed 2.796 m does not",
    )


def tpcap() -> SingleTrack:
    """The car of the Trajectory Planning Competition for Automated Parking."""
    return SingleTrack.rectangular(
        "tpcap",
        wheelbase=2.8,
        length=0.929 + 2.8 + 0.96,
        width=1.942,
        rear_overhang=0.929,
        limits=Limits(speed=(-2.5, 2.5), acceleration=(-1.0, 1.0), steering=0.75, steering_rate=0.5),
        source="Trajectory Planning Competition for Automated Parking (TPCAP), competition rules",
    )


def lincoln_mkz() -> SingleTrack:
    """Lincoln MKZ as calibrated in the Apollo project, at manoeuvring speed.

    The steering wheel's 8.203 rad and 6.981 rad/s are divided by the steering ratio 16. Speed and acceleration
    are limited to what suits a parking manoeuvre, not to what the car can do.
    """
    return SingleTrack.rectangular(
        "lincoln-mkz",
        wheelbase=2.8448,
        length=4.933,
        width=2.11,
        rear_overhang=1.043,
        limits=Limits(
            speed=(-2.0, 2.0), acceleration=(-1.0, 1.0), steering=8.20304748437 / 16, steering_rate=6.98131700798 / 16
        ),
        source="ApolloAuto/apollo v7.0.0, modules/calibration/data/mkz_example/vehicle_param.pb.txt; speed and "
        "acceleration reduced to manoeuvring values",
    )


def obca() -> SingleTrack:
    """The car of the OBCA parking examples (Zhang, Liniger, Sakai, Borrelli)."""
    return SingleTrack.rectangular(
        "obca",
        wheelbase=2.7,
        length=4.7,
        width=2.0,
        rear_overhang=1.0,
        limits=Limits(speed=(-1.0, 2.0), acceleration=(-0.4, 0.4), steering=0.6, steering_rate=0.6),
        source="Zhang, Liniger, Sakai, Borrelli: Autonomous parking using optimization-based collision avoidance, "
        "CDC 2018, and its public code (XiaojingGeorgeZhang/H-OBCA)",
    )


def forklift() -> SingleTrack:
    """A counterbalance forklift whose body is not convex: a mast and two tines before a chassis.

    Illustrative dimensions, not a product's. Parts must not be replaced by their bounding box: the space between
    and beside the tines is free.
    """
    chassis = ConvexPolygon.rectangle(-0.55, 1.75, -0.60, 0.60)
    left = ConvexPolygon.rectangle(1.75, 2.85, 0.22, 0.36)
    right = ConvexPolygon.rectangle(1.75, 2.85, -0.36, -0.22)
    return SingleTrack(
        "forklift",
        wheelbase=1.4,
        body=(BodyPart("chassis", chassis), BodyPart("left tine", left), BodyPart("right tine", right)),
        limits=Limits(speed=(-1.5, 1.5), acceleration=(-0.8, 0.8), steering=float(np.radians(60)), steering_rate=0.6),
        source="tightspot, illustrative",
    )


CATALOGUE: dict[str, Callable[[], SingleTrack]] = {
    "paper": paper,
    "paper-recovered": paper_recovered,
    "tpcap": tpcap,
    "lincoln-mkz": lincoln_mkz,
    "obca": obca,
    "forklift": forklift,
    **COMMONROAD,
}


def vehicle(name: str) -> SingleTrack:
    """The catalogue's vehicle of that name; raises :class:`VehicleError` with the names there are."""
    try:
        return CATALOGUE[name]()
    except KeyError:
        raise VehicleError(
            Problem("vehicle", f"{name!r} is not in the catalogue; choose one of {', '.join(CATALOGUE)} or give a file")
        ) from None
