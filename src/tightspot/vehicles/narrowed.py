"""The same vehicle with a narrower body: how much too wide is it?"""

from __future__ import annotations

import dataclasses
from dataclasses import replace

import numpy as np

from tightspot.errors import Problem, VehicleError
from tightspot.geometry.polygon import ConvexPolygon
from tightspot.vehicles.base import BodyPart, VehicleModel


def body_width(vehicle: VehicleModel) -> float:
    """Lateral extent of the body with all its parts in line, m."""
    sides = np.concatenate([part.polygon.vertices[:, 1] for part in vehicle.parts])
    return float(np.ptp(sides))


def narrowed(vehicle: VehicleModel, factor: float) -> VehicleModel:
    """The vehicle with the lateral coordinate of every body part multiplied by ``factor``.

    Lengths, limits and dynamics stay. Parts beside the axis come nearer to it, so a body of one part about its axis is
    contained in the former one; one of several parts need not be.

    Args:
        vehicle: A dataclass with a field that holds its body parts, as every model of the catalogue is.
        factor: Above 0.

    Raises:
        VehicleError: If the model keeps its parts elsewhere, or the factor is not positive.
    """
    if not (np.isfinite(factor) and factor > 0):
        raise VehicleError(Problem("width", f"the factor {factor} must be positive and finite"))
    changes: dict[str, tuple[BodyPart, ...]] = {}
    if dataclasses.is_dataclass(vehicle):
        for field in dataclasses.fields(vehicle):
            parts = getattr(vehicle, field.name)
            if field.init and _are_parts(parts):
                changes[field.name] = tuple(_narrowed_part(part, factor) for part in parts)
    if not changes:
        raise VehicleError(Problem("vehicle", f"the body of a {type(vehicle).__name__} cannot be made narrower"))
    return replace(vehicle, **changes)  # type: ignore[type-var]


def _are_parts(value: object) -> bool:
    return isinstance(value, tuple) and bool(value) and all(isinstance(part, BodyPart) for part in value)


def _narrowed_part(part: BodyPart, factor: float) -> BodyPart:
    polygon = ConvexPolygon.from_vertices(part.polygon.vertices * np.array([1.0, factor]))
    return BodyPart(part.name, polygon, part.frame)
