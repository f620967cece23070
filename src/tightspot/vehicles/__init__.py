"""Vehicles: dynamics, limits, bodies, and the catalogue of published ones."""

from tightspot.vehicles.base import BodyPart, MotionBounds, VehicleModel
from tightspot.vehicles.catalogue import CATALOGUE, vehicle
from tightspot.vehicles.files import VehicleSpec, from_dict, load_vehicle
from tightspot.vehicles.narrowed import body_width, narrowed
from tightspot.vehicles.single_track import Limits, SingleTrack

__all__ = [
    "CATALOGUE",
    "BodyPart",
    "Limits",
    "MotionBounds",
    "SingleTrack",
    "VehicleModel",
    "VehicleSpec",
    "body_width",
    "from_dict",
    "load_vehicle",
    "narrowed",
    "vehicle",
]
