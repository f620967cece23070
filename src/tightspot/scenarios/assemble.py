"""From a scene object's fields to a scenario's: recentring, polygons, the default workspace."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import GeometryError, Problem, SceneError
from tightspot.geometry import ConvexPolygon, clean_ring, is_convex
from tightspot.problems import prefixed, shortened
from tightspot.scenarios import schema, states
from tightspot.scenarios.boundary import Boundary
from tightspot.scenarios.obstacle import Obstacle, unique_names
from tightspot.vehicles import VehicleSpec

Array = NDArray[np.float64]

FAR = 1e4
"""Coordinates farther from the origin than this are recentred, m."""
FARTHEST = 1e8
"""The goal may be this far from the start, m."""
ROOM = 10.0
"""The default workspace leaves this much room around start and goal, m, ..."""
MOST_ROOM = 50.0
"""... and takes in obstacles up to this far, m."""


def recentring(start: Array) -> Array:
    """What to subtract from all coordinates, m, (2,): the start rounded to metres if it is far, else zero."""
    far = bool(np.abs(start[:2]).max() > FAR)
    return np.round(start[:2]) if far else np.zeros(2)


def default_workspace(start: Array, goal: Array, obstacles: Sequence[Obstacle]) -> ConvexPolygon:
    """The box around start and goal grown by 10 m, and further (at most 50 m) to take in the obstacles."""
    ends = np.array([start[:2], goal[:2]])
    low, high = ends.min(axis=0), ends.max(axis=0)
    corners = np.vstack([ends, *(obstacle.exterior for obstacle in obstacles)])
    lowest = np.clip(corners.min(axis=0), low - MOST_ROOM, low - ROOM)
    highest = np.clip(corners.max(axis=0), high + ROOM, high + MOST_ROOM)
    return ConvexPolygon.rectangle(lowest[0], highest[0], lowest[1], highest[1])


def assemble(data: Any, name: str = "scene") -> dict[str, Any]:
    """Keyword arguments of :class:`tightspot.scenarios.Scenario` from a scene object (plain data).

    Args:
        data: What the scene file holds, see :mod:`tightspot.scenarios.schema`.
        name: The scene's name if it has none of its own.

    Raises:
        SceneError: With all problems, each with its path in the file.
    """
    fields, problems = schema.read(data)
    ends = {key: states.from_spec(fields[key]) for key in ("start", "goal") if key in fields}
    for key, state in ends.items():
        problems += states.state_problems(key, state)
    problems += _too_far(ends.get("start"), ends.get("goal"))
    # Without a start there is no scenario, but the polygons are still judged, near the origin if they can be.
    offset = recentring(ends.get("start", ends.get("goal", _any_point(fields))))
    obstacles, found = _obstacles(fields.get("obstacles", []), offset)
    problems += found
    workspace, boundary, original, found = _workspace(fields.get("workspace"), offset)
    problems += found
    if problems:
        raise SceneError(shortened(problems))
    shift = np.array([*offset, 0.0, 0.0, 0.0])
    start, goal = ends["start"] - shift, ends["goal"] - shift
    originals = ends | ({} if original is None else {"workspace": original})
    return {
        "name": fields["name"] or name,
        "description": fields["description"],
        "source": fields["source"],
        "vehicle": _plain_vehicle(fields["vehicle"]),
        "margin": fields["margin"],
        "workspace": workspace or default_workspace(start, goal, obstacles),
        "obstacles": tuple(obstacles),
        "start": start,
        "goal": goal,
        "tolerance": fields["tolerance"],
        "offset": offset,
        "boundary": boundary,
        "originals": originals if offset.any() else {},
    }


def _too_far(start: Array | None, goal: Array | None) -> list[Problem]:
    """Start and goal must lie so near that one set of recentred coordinates resolves both."""
    distance = 0.0 if start is None or goal is None else float(np.hypot(*(goal - start)[:2]))
    if not distance > FARTHEST:
        return []
    return [
        Problem("goal", f"is {distance:.3g} m from the start; at most {FARTHEST:g} m are planned: are these metres?")
    ]


def _plain_vehicle(vehicle: str | Mapping[str, Any]) -> str | dict[str, Any]:
    """The vehicle as it was given, in plain lists and numbers and without the keys that were left out."""
    if isinstance(vehicle, str):
        return vehicle
    plain: dict[str, Any] = VehicleSpec.model_validate(vehicle).model_dump(mode="json", exclude_unset=True)
    return plain


def _any_point(fields: dict[str, Any]) -> Array:
    for spec in fields.get("obstacles", []):
        if spec is not None and spec.vertices:
            return np.array(spec.vertices[0])
    return np.zeros(2)


def _obstacles(specs: Sequence[schema.ObstacleSpec | None], offset: Array) -> tuple[list[Obstacle], list[Problem]]:
    names = unique_names([None if spec is None else spec.name for spec in specs])
    obstacles, problems = [], []
    for index, (name, spec) in enumerate(zip(names, specs, strict=True)):
        if spec is None:
            continue
        found = _too_many(f"obstacles[{index}].vertices", spec)
        if found:
            problems += found
            continue
        rings = [np.array(ring, dtype=float).reshape(-1, 2) for ring in (spec.vertices, *spec.holes)]
        try:
            exterior, *holes = (ring - offset for ring in rings)
            obstacles.append(Obstacle(name, exterior, tuple(holes), tuple(rings) if offset.any() else ()))
        except GeometryError as error:
            problems += prefixed(f"obstacles[{index}]", error.problems)
    return obstacles, problems


def _too_many(path: str, spec: schema.ObstacleSpec | schema.RegionSpec) -> list[Problem]:
    count = sum(map(len, (spec.vertices, *spec.holes)))
    if count <= schema.MAX_CORNERS:
        return []
    sentence = f"has {count} vertices; at most {schema.MAX_CORNERS} a polygon are read: simplify or split it"
    return [Problem(path, sentence)]


def _workspace(
    spec: schema.BoxSpec | schema.RegionSpec | list[tuple[float, float]] | None, offset: Array
) -> tuple[ConvexPolygon | None, Boundary | None, Array | None, list[Problem]]:
    """W, the boundary if it is not convex, W's vertices in the file's coordinates if it is, and what is wrong."""
    if spec is None:
        return None, None, None, []
    if isinstance(spec, schema.BoxSpec):
        (x_min, x_max), (y_min, y_max) = spec.x, spec.y
        spec = [(x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max)]
    if isinstance(spec, list):
        spec = schema.RegionSpec.model_construct(vertices=spec, holes=[])
    problems = _too_many("workspace", spec)
    if problems:
        return None, None, None, problems
    rings = [np.array(ring, dtype=float).reshape(-1, 2) for ring in (spec.vertices, *spec.holes)]
    try:
        exterior, *holes = (ring - offset for ring in rings)
        ring = clean_ring(exterior, "")
        if not holes and is_convex(ring.vertices):
            return ConvexPolygon.from_vertices(exterior), None, rings[0][ring.indices], []
        boundary = Boundary(exterior, tuple(holes), tuple(rings) if offset.any() else ())
        return boundary.workspace(), boundary, None, []
    except GeometryError as error:
        return None, None, None, prefixed("workspace", error.problems)
