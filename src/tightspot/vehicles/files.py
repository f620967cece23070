"""Vehicles as files: the same object as a plan file's ``vehicle``, in YAML or JSON, checked by pydantic."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, ValidationError

from tightspot.errors import GeometryError, Problem, VehicleError
from tightspot.geometry.decomposition import decompose
from tightspot.geometry.polygon import ConvexPolygon
from tightspot.problems import from_pydantic
from tightspot.safe_yaml import UnreadableError, load_json, load_yaml
from tightspot.vehicles.base import BodyPart
from tightspot.vehicles.catalogue import CATALOGUE, vehicle
from tightspot.vehicles.single_track import Limits, SingleTrack

_MAX_BYTES = 200_000


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class RectangleSpec(_Strict):
    """A rectangular body."""

    length: float = Field(ge=0.01, le=100, description="bumper to bumper, m")
    width: float = Field(ge=0.01, le=100, description="m")
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


def _body_kind(body: Any) -> str:
    return "parts" if isinstance(body, list | tuple) else "rectangle"


Body = Annotated[
    Annotated[RectangleSpec, Tag("rectangle")]
    | Annotated[list[PartSpec], Tag("parts"), Field(min_length=1, max_length=100)],
    Discriminator(_body_kind),
]


class VehicleSpec(_Strict):
    """A vehicle file. Angles in radians, lengths in metres, the origin is the rear-axle midpoint."""

    name: str = "vehicle"
    model: Literal["single_track"] = "single_track"
    wheelbase: float = Field(gt=0, le=100, description="distance of the axles, m")
    body: Body = Field(description="a rectangle, or a list of polygons with different names")
    limits: LimitsSpec
    source: str = ""


_KEYS = tuple(
    dict.fromkeys(key for model in (VehicleSpec, RectangleSpec, PartSpec, LimitsSpec) for key in model.model_fields)
)


def from_dict(data: Mapping[str, Any]) -> SingleTrack:
    """A vehicle from the object that :meth:`SingleTrack.to_dict` writes or a user's file holds.

    Raises:
        VehicleError: With every problem and its path.
    """
    try:
        spec = VehicleSpec.model_validate(data)
    except ValidationError as error:
        raise VehicleError([_untagged(problem) for problem in from_pydantic(error, "", _KEYS)]) from None
    given = spec.limits
    limits = Limits(given.speed, given.acceleration, given.steering, given.steering_rate)
    body = _rectangle(spec.body) if isinstance(spec.body, RectangleSpec) else _parts(spec.body)
    return SingleTrack(spec.name, spec.wheelbase, body, limits, spec.source)


def _rectangle(size: RectangleSpec) -> tuple[BodyPart, ...]:
    rear = -size.rear_overhang
    polygon = ConvexPolygon.rectangle(rear, rear + size.length, -size.width / 2, size.width / 2)
    return (BodyPart("body", polygon),)


def _parts(parts: list[PartSpec]) -> tuple[BodyPart, ...]:
    body: list[BodyPart] = []
    problems: list[Problem] = []
    for index, part in enumerate(parts):
        try:
            polygons = decompose(np.array(part.vertices, float), name=f"body[{index}].vertices")
        except GeometryError as error:
            problems += error.problems
            continue
        names = [part.name] if len(polygons) == 1 else [f"{part.name}/{i}" for i in range(len(polygons))]
        body += [BodyPart(name, polygon) for name, polygon in zip(names, polygons, strict=True)]
    if problems:
        raise VehicleError(problems)
    return tuple(body)


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
    data = _read(path)
    if not isinstance(data, Mapping):
        raise VehicleError(Problem("vehicle", f"{text} holds no object; see `tightspot schema --vehicle`"))
    return from_dict(data)


def _read(path: Path) -> Any:
    """The plain data in the file; depth and aliases are bounded before anything is built."""
    try:
        size = path.stat().st_size
        text = path.read_text(encoding="utf-8-sig") if size <= _MAX_BYTES else ""
    except OSError as error:
        raise _refuse(f"{path} cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError as error:
        raise _refuse(f"{path} is not UTF-8 text (byte {error.start}); save it as UTF-8") from None
    except ValueError:  # a null byte in the name
        raise _refuse(f"{str(path)!a} cannot be read: it is not a file name") from None
    if size > _MAX_BYTES:
        raise _refuse(f"{path} is larger than {_MAX_BYTES} bytes; a vehicle file is a few lines")
    try:
        return load_json(text) if path.suffix.lower() == ".json" else load_yaml(text)
    except UnreadableError as error:
        raise _refuse(f"{path} {error}") from None


def _refuse(sentence: str) -> VehicleError:
    return VehicleError(Problem("vehicle", sentence))


def _untagged(problem: Problem) -> Problem:
    """Without the names by which pydantic tells the two kinds of body apart."""
    path = problem.path.replace("body.rectangle", "body", 1).replace("body.parts", "body", 1)
    return Problem(path, problem.message)
