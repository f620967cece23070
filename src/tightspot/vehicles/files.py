"""Vehicles as files: the same object as a plan file's ``vehicle``, in YAML or JSON, checked by pydantic."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np
import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from tightspot.errors import GeometryError, Problem, VehicleError
from tightspot.geometry.decomposition import decompose
from tightspot.vehicles.base import BodyPart
from tightspot.vehicles.catalogue import CATALOGUE, vehicle
from tightspot.vehicles.single_track import Limits, SingleTrack

_MAX_BYTES = 1_000_000


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class RectangleSpec(_Strict):
    """A rectangular body."""

    length: float = Field(gt=0, le=100, description="bumper to bumper, m")
    width: float = Field(gt=0, le=100, description="m")
    rear_overhang: float = Field(ge=0, le=100, description="rear axle to rear bumper, m")


class PartSpec(_Strict):
    """One polygon of the body in the rear-axle frame; a nonconvex one is decomposed."""

    name: str = "body"
    vertices: list[tuple[float, float]] = Field(min_length=3, max_length=1000, description="m, x forward, y left")


class LimitsSpec(_Strict):
    """Bounds that hold for all times."""

    speed: tuple[float, float] = Field(description="[lowest, highest] rear-axle speed, m/s")
    acceleration: tuple[float, float] = Field(description="[lowest, highest], m/s^2")
    steering: float = Field(description="largest absolute steering angle, rad, below pi/2")
    steering_rate: float = Field(description="largest absolute steering rate, rad/s")


class VehicleSpec(_Strict):
    """A vehicle file. Angles in radians, lengths in metres, the origin is the rear-axle midpoint."""

    name: str = "vehicle"
    model: Literal["single_track"] = "single_track"
    wheelbase: float = Field(gt=0, le=100, description="distance of the axles, m")
    body: RectangleSpec | list[PartSpec]
    limits: LimitsSpec
    source: str = ""


def from_dict(data: Mapping[str, Any]) -> SingleTrack:
    """A vehicle from the object that :meth:`SingleTrack.to_dict` writes or a user's file holds.

    Raises:
        VehicleError: With every problem and its path.
    """
    try:
        spec = VehicleSpec.model_validate(data)
    except ValidationError as error:
        raise VehicleError([_problem(detail) for detail in error.errors()]) from None
    limits = Limits(spec.limits.speed, spec.limits.acceleration, spec.limits.steering, spec.limits.steering_rate)
    if isinstance(spec.body, RectangleSpec):
        size = spec.body
        return SingleTrack.rectangular(
            spec.name,
            wheelbase=spec.wheelbase,
            length=size.length,
            width=size.width,
            rear_overhang=size.rear_overhang,
            limits=limits,
            source=spec.source,
        )
    body: list[BodyPart] = []
    problems: list[Problem] = []
    for index, part in enumerate(spec.body):
        try:
            polygons = decompose(np.array(part.vertices, float))
        except GeometryError as error:
            problems += [Problem(_join(f"body[{index}].vertices", p.path), p.message) for p in error.problems]
            continue
        names = [part.name] if len(polygons) == 1 else [f"{part.name}/{i}" for i in range(len(polygons))]
        body += [BodyPart(name, polygon) for name, polygon in zip(names, polygons, strict=True)]
    if problems:
        raise VehicleError(problems)
    return SingleTrack(spec.name, spec.wheelbase, tuple(body), limits, spec.source)


def load_vehicle(name_or_path: str | Path) -> SingleTrack:
    """A vehicle by catalogue name or from a YAML/JSON file.

    Raises:
        VehicleError: Unknown name, unreadable file, or a file that describes no vehicle.
    """
    text = str(name_or_path)
    if text in CATALOGUE:
        return vehicle(text)
    path = Path(text)
    if path.suffix.lower() not in {".yaml", ".yml", ".json"}:
        return vehicle(text)
    try:
        if path.stat().st_size > _MAX_BYTES:
            raise VehicleError(Problem(text, f"is larger than {_MAX_BYTES} bytes; a vehicle file is a few lines"))
        data = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise VehicleError(Problem("vehicle", f"{text} cannot be read: {error.strerror or error}")) from None
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError) as error:
        first_line = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise VehicleError(Problem("vehicle", f"{text} is not readable as YAML or JSON: {first_line}")) from None
    if not isinstance(data, Mapping):
        raise VehicleError(Problem("vehicle", f"{text} holds no object; see `tightspot schema --vehicle`"))
    return from_dict(data)


def _problem(detail: Any) -> Problem:
    path = "".join(f"[{item}]" if isinstance(item, int) else f".{item}" for item in detail["loc"]).lstrip(".")
    value = detail.get("input")
    shown = "" if isinstance(value, Mapping | list) else f" (given: {value!r})"
    return Problem(path, f"{detail['msg']}{shown}")


def _join(prefix: str, path: str) -> str:
    return f"{prefix}{path}" if path.startswith("[") or not path else f"{prefix}.{path}"
