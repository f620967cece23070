"""The YAML file of ROS's map_server: which picture, how large a cell is, where the map lies, what shades mean."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from tightspot.errors import Problem, SceneError
from tightspot.problems import MOST_PROBLEMS, from_pydantic, near, refusal, shown, unknown_key
from tightspot.scenarios.schema import Coordinate, Number, SceneSpec

SECTION = "tightspot"


def _flag(value: Any) -> bool:
    if value in (0, 1, "0", "1"):
        return bool(int(value))
    raise refusal(f"must be 0 or 1, but is {shown(value)}")


def _mode(value: Any) -> str:
    if isinstance(value, str) and value.lower() in ("trinary", "scale", "raw"):
        return value.lower()
    raise refusal(f"must be trinary, scale or raw, but is {shown(value)}")


def _origin(value: Any) -> Any:
    if not isinstance(value, list | tuple) or len(value) not in (2, 3):
        raise refusal(f"must be [x, y, yaw] of the lower left corner in metres and radians, but is {shown(value)}")
    return [*value, 0.0][:3]


def _occupied_or_free(value: Any) -> Any:
    if value in ("occupied", "free"):
        return value
    raise refusal(f"must be occupied or free, but is {shown(value)}")


class _Lenient(BaseModel):
    model_config = ConfigDict(extra="ignore", allow_inf_nan=False)


class Section(_Lenient):
    """Ours, under ``tightspot``: what a scene needs beyond the map. Other keys are those of a scene file."""

    unknown: Annotated[Literal["occupied", "free"], BeforeValidator(_occupied_or_free)] = Field(
        default="occupied", description="what cells are that nobody has seen"
    )
    simplify: Number | None = Field(
        default=None, ge=0, le=10, description="how far outlines may reach out of the occupied cells, m"
    )


class MapSpec(_Lenient):
    """map_server's keys. Others are ignored unless they look like a misspelt one."""

    image: str = Field(min_length=1, max_length=1000, description="the picture, relative to this file")
    resolution: Number = Field(gt=1e-4, le=100, description="side of a cell, m")
    origin: Annotated[tuple[Coordinate, Coordinate, Number], BeforeValidator(_origin)] = Field(
        description="pose of the picture's lower left corner: x m, y m, yaw rad counter-clockwise"
    )
    negate: Annotated[bool, BeforeValidator(_flag)] = Field(
        default=False, description="whether white is occupied instead of black"
    )
    occupied_thresh: Number = Field(default=0.65, gt=0, lt=1, description="occupied above this probability")
    free_thresh: Number = Field(default=0.196, gt=0, lt=1, description="free below this probability")
    mode: Annotated[Literal["trinary", "scale", "raw"], BeforeValidator(_mode)] = "trinary"
    tightspot: Section = Section()


_SCENE_KEYS = tuple(key for key in SceneSpec.model_fields if key not in ("format", "obstacles"))
"""What the section may say of the scene; the obstacles are the map's."""


def is_map(data: Any) -> bool:
    """Whether plain data from YAML is a map_server file: it names a picture and the size of its cells."""
    return isinstance(data, Mapping) and "image" in data and ("resolution" in data or "origin" in data)


def read_spec(data: Mapping[str, Any]) -> tuple[MapSpec, dict[str, Any]]:
    """The map's keys, and the scene's fields in our section.

    Raises:
        SceneError: With all problems, each with its path in the file.
    """
    known = list(MapSpec.model_fields)
    problems = [unknown_key("", key, known) for key in data if key not in known and near(str(key), known)]
    section = data.get(SECTION)
    ours = [*Section.model_fields, *_SCENE_KEYS]
    if isinstance(section, Mapping):
        problems += [unknown_key(SECTION, key, ours) for key in section if key not in ours]
    try:
        spec = MapSpec.model_validate({key: data[key] for key in known if data.get(key) is not None})
    except ValidationError as error:
        raise SceneError((problems + from_pydantic(error, "", known))[:MOST_PROBLEMS]) from None
    if spec.free_thresh >= spec.occupied_thresh:
        sentence = f"{spec.free_thresh:g} is not below occupied_thresh = {spec.occupied_thresh:g}"
        problems.append(Problem("free_thresh", sentence))
    if spec.mode == "raw" and spec.negate:
        sentence = "has no meaning on which all of ROS agree in mode raw; negate the picture, or choose another mode"
        problems.append(Problem("negate", sentence))
    if problems:
        raise SceneError(problems[:MOST_PROBLEMS])
    scene = {key: section[key] for key in _SCENE_KEYS if key in section} if isinstance(section, Mapping) else {}
    return spec, scene


def picture_path(map_path: Path, image: str) -> Path:
    """Where the picture is: beside the YAML file unless its path is absolute."""
    return map_path.parent / image
