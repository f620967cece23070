"""GeoJSON (RFC 7946) with a role property: drawings of scenes from GIS and CAD programs, in projected metres.

What a scene has beyond its geometry stands in the collection's member ``tightspot``, which other programs ignore.
Numbers are written with all their digits, so that what is read again is the same bit for bit.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import Problem, SceneError
from tightspot.problems import MOST_PROBLEMS, join, shortened, shown, unknown_key
from tightspot.scenarios.readers.features import PROJECT, SCENE_FIELDS, Feature, Shape, scene_of
from tightspot.scenarios.readers.files import refuse
from tightspot.scenarios.readers.given import Given
from tightspot.scenarios.readers.json_text import json_lines
from tightspot.scenarios.readers.source import Source
from tightspot.scenarios.scenario import Scenario

Array = NDArray[np.float64]

FORMAT = "tightspot-geojson/1"
MEMBER = "tightspot"
_SIMPLE = {"Point": 0, "LineString": 1, "Polygon": 2}
_MULTI = {"MultiPoint": "Point", "MultiLineString": "LineString", "MultiPolygon": "Polygon"}
TYPES = ("FeatureCollection", "Feature", "GeometryCollection", *_SIMPLE, *_MULTI)
_DEGREES = re.compile(r"crs\W?84|4326|4258|4269|wgs\W?84", re.IGNORECASE)


def is_geojson(data: Any) -> bool:
    """Whether plain data is meant to be GeoJSON."""
    return isinstance(data, Mapping) and (data.get("type") in TYPES or isinstance(data.get("features"), list))


def read_geojson(source: Source, given: Given) -> Scenario:
    """The scene in a GeoJSON file: a feature collection, a feature or a bare geometry.

    Raises:
        SceneError: With all problems, each with its place in the file.
    """
    data = source.json
    if not is_geojson(data):
        raise refuse(source.path, f"is not GeoJSON: it has no type such as FeatureCollection, but holds {shown(data)}")
    _refuse_degrees(data.get("crs"))
    problems: list[Problem] = []
    features = [*_features(data, problems)]
    whole = _whole(data.get(MEMBER), problems)
    if problems:
        raise SceneError(shortened(problems))
    return scene_of(features, whole, given, source.name, place=MEMBER, title="a feature with role ROLE")


def to_geojson(scenario: Scenario) -> str:
    """The text of a feature collection that holds the scene."""
    data = scenario.to_dict()
    whole = {key: data[key] for key in SCENE_FIELDS}
    collection = {
        "type": "FeatureCollection",
        MEMBER: {"format": FORMAT, "unit": "m", **whole},
        "features": [
            *(_state(role, data[role]) for role in ("start", "goal")),
            _polygon({"role": "boundary"}, *_rings(data["workspace"])),
            *(
                _polygon({"role": "obstacle", "name": obstacle["name"]}, *_rings(obstacle))
                for obstacle in data["obstacles"]
            ),
        ],
    }
    return json_lines(collection)


def _state(role: str, state: Mapping[str, Any]) -> dict[str, Any]:
    rest = {key: value for key, value in state.items() if key not in ("x", "y")}
    return _feature({"role": role, **rest}, {"type": "Point", "coordinates": [state["x"], state["y"]]})


def _polygon(properties: dict[str, Any], *rings: list[list[float]]) -> dict[str, Any]:
    return _feature(properties, {"type": "Polygon", "coordinates": [[*ring, ring[0]] for ring in rings]})


def _feature(properties: dict[str, Any], geometry: dict[str, Any]) -> dict[str, Any]:
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def _rings(region: Any) -> list[list[list[float]]]:
    """Exterior and holes of a scene file's obstacle or workspace."""
    return [region["vertices"], *region.get("holes", [])] if isinstance(region, Mapping) else [region]


def _refuse_degrees(crs: Any) -> None:
    name = crs.get("properties") if isinstance(crs, Mapping) else None
    text = str(name.get("name", "")) if isinstance(name, Mapping) else ""
    if _DEGREES.search(text[:200]):
        sentence = f"{shown(text)} is degrees of longitude and latitude; {PROJECT}"
        raise SceneError(Problem("crs", sentence))


def _whole(member: Any, problems: list[Problem]) -> dict[str, Any]:
    """The scene's fields in our own member."""
    if member is None:
        return {}
    if not isinstance(member, Mapping):
        problems.append(Problem(MEMBER, f"must be an object, but is {shown(member)}"))
        return {}
    known = ("format", "unit", *SCENE_FIELDS)
    problems += [unknown_key(MEMBER, key, known) for key in member if key not in known][: MOST_PROBLEMS + 1]
    for key, wanted in (("format", FORMAT), ("unit", "m")):
        if member.get(key, wanted) != wanted:
            sentence = f"{shown(member[key])} is not known to this version; it must be {wanted!r}"
            problems.append(Problem(join(MEMBER, key), sentence))
    return {key: member[key] for key in SCENE_FIELDS if key in member}


def _features(data: Mapping[str, Any], problems: list[Problem]) -> Iterator[Feature]:
    if data.get("type") not in ("FeatureCollection", None):
        yield from _one_feature(data, "", problems)
        return
    features = data.get("features")
    if not isinstance(features, list):
        problems.append(Problem("features", f"must be a list of features, but is {shown(features)}"))
        return
    for index, item in enumerate(features):
        yield from _one_feature(item, f"features[{index}]", problems)
        if len(problems) > MOST_PROBLEMS:
            return


def _one_feature(item: Any, where: str, problems: list[Problem]) -> Iterator[Feature]:
    """The feature, none if it has no geometry; a bare geometry is a feature without properties."""
    if not isinstance(item, Mapping):
        problems.append(Problem(where, f"must be a feature, but is {shown(item)}"))
        return
    is_feature = item.get("type") == "Feature"
    geometry, properties = (item.get("geometry"), item.get("properties")) if is_feature else (item, {})
    if properties is not None and not isinstance(properties, Mapping):
        problems.append(Problem(join(where, "properties"), f"must be an object, but is {shown(properties)}"))
        return
    if geometry is None:
        return
    path = join(where, "geometry") if is_feature else where
    shapes = tuple(_shapes(geometry, path, problems))
    if shapes:
        named = {str(key).lower(): value for key, value in (properties or {}).items()}
        yield Feature(shapes, named, where or "the geometry")


def _shapes(geometry: Any, path: str, problems: list[Problem]) -> Iterator[Shape]:
    """The simple geometries in a geometry; what is wrong with it is added to the problems."""
    kind = geometry.get("type") if isinstance(geometry, Mapping) else None
    if not isinstance(kind, str):
        problems.append(Problem(path, f"must be a geometry with a type, but is {shown(geometry)}"))
    elif kind == "GeometryCollection":
        members = geometry.get("geometries")
        if not isinstance(members, list):
            problems.append(Problem(join(path, "geometries"), f"must be a list, but is {shown(members)}"))
            return
        for index, member in enumerate(members):
            yield from _shapes(member, f"{path}.geometries[{index}]".lstrip("."), problems)
    elif kind in _SIMPLE:
        yield from _shape(kind, geometry.get("coordinates"), join(path, "coordinates"), problems)
    elif kind in _MULTI:
        items = geometry.get("coordinates")
        if not isinstance(items, list):
            problems.append(Problem(join(path, "coordinates"), f"must be a list, but is {shown(items)}"))
            return
        for index, item in enumerate(items):
            yield from _shape(_MULTI[kind], item, f"{join(path, 'coordinates')}[{index}]", problems)
    else:
        sentence = f"has the type {shown(kind)}; it must be one of {', '.join(TYPES[2:])}"
        problems.append(Problem(path, sentence))


def _shape(kind: Any, coordinates: Any, path: str, problems: list[Problem]) -> Iterator[Shape]:
    try:
        if kind == "Point":
            yield Shape("Point", (_points([coordinates], path, lambda _: path),))
        elif kind == "LineString":
            yield Shape("LineString", (_points(coordinates, path),))
        elif not isinstance(coordinates, list) or not coordinates:
            problems.append(Problem(path, f"must be a list of rings, but is {shown(coordinates)}"))
        else:
            rings = [_points(ring, f"{path}[{j}]") for j, ring in enumerate(coordinates)]
            yield Shape("Polygon", tuple(_opened(ring) for ring in rings))
    except SceneError as error:
        problems += error.problems


def _opened(ring: Array) -> Array:
    """The ring without its closing point."""
    return ring[:-1] if len(ring) > 1 and (ring[0] == ring[-1]).all() else ring


def _points(points: Any, path: str, place: Any = None) -> Array:
    """Positions as (n, 2); heights are left out."""
    if not isinstance(points, list) or not points:
        raise SceneError(Problem(path, f"must be a list of positions [x, y], but is {shown(points)}"))
    problems = []
    for index, point in enumerate(points):
        if not _is_position(point):
            where = place(index) if place else f"{path}[{index}]"
            text = f"[{', '.join(shown(value) for value in point[:4])}]" if isinstance(point, list) else shown(point)
            problems.append(Problem(where, f"must be a position [x, y] of finite numbers, but is {text}"))
            if len(problems) > MOST_PROBLEMS:
                break
    if problems:
        raise SceneError(problems)
    return np.array([point[:2] for point in points], dtype=float)


def _is_position(point: Any) -> bool:
    return (
        isinstance(point, list)
        and len(point) >= 2
        and all(
            isinstance(value, int | float) and not isinstance(value, bool) and _finite(value) for value in point[:2]
        )
    )


def _finite(value: float) -> bool:
    try:
        return math.isfinite(value)
    except OverflowError:  # an integer of more than 308 digits
        return False
