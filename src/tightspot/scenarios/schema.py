"""The scene file ``tightspot-scene/1``: its fields, types and units, and what each value may be.

The models say what a file looks like (``tightspot schema`` prints them as JSON Schema); geometry is judged in
:mod:`tightspot.scenarios.assemble`.
"""

from __future__ import annotations

import math
import numbers
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, Literal

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    TypeAdapter,
    ValidationError,
    WrapValidator,
)

from tightspot import vehicles
from tightspot.errors import Problem, VehicleError
from tightspot.problems import MOST_PROBLEMS, from_pydantic, near, prefixed, refusal, shown, unknown_key

FORMAT: Literal["tightspot-scene/1"] = "tightspot-scene/1"
MAX_VERTICES = 200_000
MAX_DRAWN = 50_000
"""Vertices in files of other formats: sorting out which of them are obstacles takes seconds."""
MAX_CORNERS = 10_000
"""Of one polygon with its holes: decomposing it takes seconds."""
LARGEST_COORDINATE = 1e11
"""Beyond it a double no longer resolves the 0.1 mm that clearances need."""

# YAML 1.1 reads 1e-3 (no point) as text; everyone else reads it as a number.
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")


def _number(value: Any) -> float:
    if isinstance(value, bool):
        raise refusal(f"must be a number, but is {value} (YAML also reads yes, no, on and off as such)")
    if isinstance(value, str) and len(value) <= 100 and _NUMBER.fullmatch(value):
        value = float(value)
    if not isinstance(value, numbers.Real):
        raise refusal(f"must be a number, but is {shown(value)}")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise refusal(f"{number} is not finite; give a number")
    return number


def _number_or_free(value: Any) -> float | None:
    return None if value is None else _number(value)


def _coordinate(value: Any) -> float:
    number = _number(value)
    if abs(number) > LARGEST_COORDINATE:
        raise refusal(f"{number:g} m is farther than {LARGEST_COORDINATE:g} m from the origin; are these metres?")
    return number


def _pair(value: Any, what: str) -> Sequence[Any]:
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise refusal(f"must be two numbers {what}, but is {shown(value)}")
    return value


def _point(value: Any) -> tuple[float, float]:
    x, y = _pair(value, "[x, y]")
    return _coordinate(x), _coordinate(y)


def _interval(value: Any) -> tuple[float, float]:
    low, high = map(_coordinate, _pair(value, "[lowest, highest]"))
    if not low < high:
        raise refusal(f"the lower bound {low:g} is not below the upper bound {high:g}; write the smaller first")
    return low, high


def _printable(value: Any) -> Any:
    if not isinstance(value, str | None):
        raise refusal(f"must be text, but is {shown(value)}")
    if value is not None and not value.isprintable():
        raise refusal("contains characters that cannot be printed, such as a line break; remove them")
    return value


def _workspace(value: Any, handler: Callable[[Any], Any]) -> Any:
    """Report only what is wrong with the form that was meant: a box, a list of corners, or corners and holes."""
    if isinstance(value, Mapping):
        return (RegionSpec if "vertices" in value else BoxSpec).model_validate(value)
    if isinstance(value, list | tuple):
        return _CORNERS.validate_python(value)
    raise refusal(f"must be a list of corners or an object with x and y, but is {shown(value)}")


def _vehicle(value: Any, handler: Callable[[Any], Any]) -> Any:
    """The vehicle room checks its own objects; its problems keep their paths, see :func:`read`."""
    if not isinstance(value, str | Mapping):
        raise refusal(f"must be a name or an object, but is {shown(value)}")
    return value


Number = Annotated[float, BeforeValidator(_number)]
FreeNumber = Annotated[float | None, BeforeValidator(_number_or_free)]
Coordinate = Annotated[float, BeforeValidator(_coordinate)]
Point = Annotated[tuple[float, float], BeforeValidator(_point)]
_CORNERS = TypeAdapter(list[Point])
Interval = Annotated[tuple[float, float], BeforeValidator(_interval)]
Name = Annotated[str, Field(min_length=1, max_length=200), BeforeValidator(_printable)]


class Strict(BaseModel):
    """No unknown keys, no infinities."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, validate_assignment=True)


class StateSpec(Strict):
    """State of the vehicle: pose of the rear-axle midpoint, speed and steering angle."""

    x: Coordinate = Field(description="rear-axle midpoint, m", examples=[6.3])
    y: Coordinate = Field(description="rear-axle midpoint, m", examples=[-6.7])
    theta: Number = Field(
        description="heading, rad, counter-clockwise from the x axis; multiples of 2 pi do not matter",
        examples=[1.5707963267948966],
    )
    v: FreeNumber = Field(
        default=0.0, description="speed, m/s, negative in reverse; null leaves it free", examples=[0.0]
    )
    delta: FreeNumber = Field(
        default=0.0,
        description="steering angle, rad, positive to the left; null leaves it free",
        examples=[0.0],
    )


class BoxSpec(Strict):
    """An axis-parallel rectangle."""

    x: Interval = Field(description="[lowest, highest], m", examples=[[-2.0, 15.0]])
    y: Interval = Field(description="[lowest, highest], m", examples=[[-8.0, 8.0]])


class RegionSpec(Strict):
    """A simple polygon, convex or not, inside of which the body must stay."""

    vertices: list[Point] = Field(description="corners [x, y], m, once around in either direction")
    holes: list[list[Point]] = Field(default=[], description="rings inside that are not free")


class ObstacleSpec(Strict):
    """A polygon, convex or not, that the vehicle must not touch."""

    name: Name | None = Field(
        default=None,
        description="for messages and certificates; obstacle-<index> if not given",
        examples=["wall"],
    )
    vertices: list[Point] = Field(
        description="corners [x, y], m, once around in either direction; may be closed and repeat corners",
        examples=[[[0.0, -8.0], [5.0, -8.0], [5.0, -2.0], [0.0, -2.0]]],
    )
    holes: list[list[Point]] = Field(
        default=[], description="rings inside that are free", examples=[[[[1, -6], [2, -6], [2, -5]]]]
    )


class ToleranceSpec(Strict):
    """How near the goal counts as reached."""

    position: Number = Field(default=0.01, gt=0, le=10, description="distance of the rear-axle midpoint, m")
    heading: Number = Field(default=math.radians(1), gt=0, le=math.pi, description="rad")
    speed: Number = Field(default=0.01, gt=0, le=10, description="m/s, where the goal's v is not null")
    steering: Number = Field(
        default=math.radians(1), gt=0, le=math.pi / 2, description="rad, where the goal's delta is not null"
    )


class SceneSpec(Strict):
    """A scene: where the vehicle may be, what it must not touch, where it starts and where it shall stand.

    Lengths in metres, angles in radians, times in seconds.
    """

    model_config = ConfigDict(title="tightspot scene file")

    format: Literal["tightspot-scene/1"] = Field(default=FORMAT, description="format and version; may be left out")
    name: Name | None = Field(default=None, description="the file's name if not given", examples=["my-garage"])
    description: str = Field(default="", max_length=10_000, description="for people")
    source: str = Field(default="", max_length=10_000, description="where the geometry comes from")
    vehicle: Annotated[str | vehicles.VehicleSpec, WrapValidator(_vehicle)] = Field(
        default="paper",
        description="a name of the catalogue, or the vehicle itself",
        examples=["lincoln-mkz"],
    )
    margin: Number = Field(
        default=0.05, ge=0, le=10, description="clearance that a plan shall keep from every obstacle, m"
    )
    workspace: Annotated[BoxSpec | list[Point] | RegionSpec | None, WrapValidator(_workspace)] = Field(
        default=None,
        description="region that the body must not leave: {x: [min, max], y: [min, max]}, a list of corners of a "
        "simple polygon, or {vertices: [...], holes: [...]}; if not given, the box around start and goal grown by "
        "10 m, and further (at most 50 m) to take in the obstacles",
        examples=[{"x": [-2.0, 15.0], "y": [-8.0, 8.0]}],
    )
    obstacles: list[ObstacleSpec] = Field(
        default=[],
        description="polygons the vehicle must not touch; they may overlap and reach outside the workspace",
    )
    start: StateSpec = Field(description="where the manoeuvre begins", examples=[{"x": 0.0, "y": 0.0, "theta": 0.0}])
    goal: StateSpec = Field(
        description="where it ends", examples=[{"x": 6.3, "y": -6.7, "theta": 1.5707963267948966, "v": 0.0}]
    )
    tolerance: ToleranceSpec = Field(default=ToleranceSpec(), description="how near the goal counts as reached")


KNOWN: dict[str, list[str]] = {
    "": list(SceneSpec.model_fields),
    "start": list(StateSpec.model_fields),
    "goal": list(StateSpec.model_fields),
    "tolerance": list(ToleranceSpec.model_fields),
    "workspace": [*BoxSpec.model_fields, *RegionSpec.model_fields],
    "obstacles": list(ObstacleSpec.model_fields),
}


def json_schema() -> dict[str, Any]:
    """The scene file's JSON Schema, as ``tightspot schema`` prints it."""
    schema = SceneSpec.model_json_schema()
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def read(data: Any) -> tuple[dict[str, Any], list[Problem]]:
    """What could be read of a scene object, field by field, and what is wrong with the rest.

    Fields are judged one by one, so that the geometry of the good ones can still be checked and all problems
    of a file be told at once.

    Returns:
        The readable fields by name, with defaults for what is not given (``obstacles`` holds ``None`` in the
        place of an unreadable one), and the problems. An unreadable or missing required field is absent.
    """
    if not isinstance(data, Mapping):
        return {}, [Problem("", f"a scene must be an object with keys such as start and goal, but is {shown(data)}")]
    unknown = [key for key in data if key not in KNOWN[""]][: MOST_PROBLEMS + 1]
    problems = [unknown_key("", key, KNOWN[""]) for key in unknown]
    given = {key: value for key, value in data.items() if key in KNOWN[""] and value is not None}
    required = [key for key, field in SceneSpec.model_fields.items() if field.is_required()]
    problems += [Problem(key, "is missing; add it") for key in required if key not in given]
    count = _vertex_count(given.get("obstacles"))
    if count > MAX_VERTICES:
        problems.append(Problem("obstacles", f"have {count} vertices together; at most {MAX_VERTICES} are read"))
        del given["obstacles"]
    spec = SceneSpec.model_construct()
    for key, value in given.items():
        try:
            setattr(spec, key, value)
        except ValidationError as error:
            problems += from_pydantic(error, "", KNOWN.get(key, []))
            if key == "obstacles" and isinstance(value, list | tuple):
                spec.obstacles = []
                spec.__dict__["obstacles"] = [_obstacle_or_none(item) for item in value]
            else:
                spec.__dict__.pop(key, None)
    problems += _vehicle_problems(spec.__dict__.get("vehicle"))
    return {key: value for key, value in spec.__dict__.items() if key in KNOWN[""]}, problems


def _obstacle_or_none(item: Any) -> ObstacleSpec | None:
    try:
        return ObstacleSpec.model_validate(item)
    except ValidationError:
        return None


def _vertex_count(obstacles: Any) -> int:
    count = 0
    for obstacle in obstacles if isinstance(obstacles, list | tuple) else ():
        if isinstance(obstacle, Mapping):
            holes = obstacle.get("holes")
            rings = [obstacle.get("vertices"), *(holes if isinstance(holes, list | tuple) else ())]
            count += sum(len(ring) for ring in rings if isinstance(ring, list | tuple))
    return count


def _vehicle_problems(vehicle: Any) -> list[Problem]:
    if isinstance(vehicle, str) and vehicle not in vehicles.CATALOGUE:
        guesses = near(vehicle, vehicles.CATALOGUE)
        advice = f"did you mean {guesses[0]!r}?" if guesses else f"it has {', '.join(vehicles.CATALOGUE)}"
        return [Problem("vehicle", f"{shown(vehicle)} is not in the catalogue; {advice}")]
    if isinstance(vehicle, Mapping):
        try:
            vehicles.from_dict(vehicle)
        except VehicleError as error:
            return prefixed("vehicle", error.problems)
    return []
