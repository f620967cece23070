"""Vehicles: dynamics, limits, bodies, and the catalogue of published ones."""

from tightspot.vehicles.base import BodyPart, MotionBounds, VehicleModel
from tightspot.vehicles.catalogue import CATALOGUE, vehicle
from tightspot.vehicles.files import VehicleSpec, from_dict, load_vehicle
from tightspot.vehicles.single_track import Limits, SingleTrack

__all__ = [
    "CATALOGUE",
    "BodyPart",
    "Limits",
    "MotionBounds",
    "SingleTrack",
    "VehicleModel",
    "VehicleSpec",
    "from_dict",
    "load_vehicle",
    "vehicle",
]
