"""Where no way leads through, whatever the vehicle does: the narrowest place between start and goal.

A disc inside the rigid body moves continuously from its place at the start to its place at the goal, within W and out
of reach of the obstacles. If not even the disc can do that, no trajectory exists at all, at whatever resolution.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from tightspot.errors import GeometryError
from tightspot.geometry import ConvexPolygon, transform
from tightspot.scenarios.labels import labels
from tightspot.scenarios.remedies import bisected
from tightspot.scenarios.scenario import Scenario
from tightspot.vehicles import VehicleModel

Array = NDArray[np.float64]

WORKSPACE = "workspace"
"""The name of W's border among the things that a place may lie between."""
ACCURACY = 5e-4
"""Of the widest passage, m."""

_ROUNDING = 1e-6
_QUADRANT = 16
_BESIDE = 1.1


@dataclass(frozen=True, eq=False)
class Bottleneck:
    """The narrowest place on the widest way from start to goal, where the vehicle cannot pass: a proof.

    Attributes:
        place: Its middle, m, in the scenario's coordinates, shape (2,).
        between: Names of what it lies between: obstacles, ``workspace``; one name if both sides are of one obstacle.
        room: Diameter of the largest disc that gets from start to goal and keeps the margin, m, to ``ACCURACY``.
        needed: Diameter of the disc in the body that was tried, m.
        margin: Largest margin, in whole mm, for which the way is not proved closed, m; ``None`` if there is none.
        reached: What the disc's centre can reach from the start, a shapely polygon.
    """

    place: Array
    between: tuple[str, ...]
    room: float
    needed: float
    margin: float | None
    reached: Any

    def describe(self, offset: Array) -> str:
        """Where it is in the file's coordinates, and how narrow."""
        x, y = self.place + offset
        names = ["the workspace's border" if name == WORKSPACE else repr(name) for name in self.between]
        if not self.room:
            obstacles = [repr(name) for name in self.between if name != WORKSPACE]
            by = f"by {' and '.join(obstacles)} " if obstacles else ""
            kept = "" if self.margin is None else " if the margin is kept"
            return f"the way is closed {by}near ({x:.2f}, {y:.2f}){kept}"
        sides = f"between {' and '.join(names)} " if len(names) > 1 else f"at {names[0]} " if names else ""
        return (
            f"the narrowest place, {sides}near ({x:.2f}, {y:.2f}), leaves {self.room:.3f} m besides the margin, "
            f"and the body needs {self.needed:.3f} m whatever way it takes"
        )

    def to_dict(self, offset: Array) -> dict[str, Any]:
        """Plain data in the file's coordinates."""
        return {
            "place": (self.place + offset).tolist(),
            "between": list(self.between),
            "room": self.room,
            "needed": self.needed,
            "margin_bound": self.margin,
        }


def bottleneck(scenario: Scenario, vehicle: VehicleModel, margin: float) -> Bottleneck | None:
    """The place where the vehicle cannot pass with this margin, if a disc in its body proves that there is one.

    Obstacles are enlarged by polygons inside the true ones, so that a disc that cannot pass cannot pass indeed. A body
    of several discs' width is not recognised: ``None`` proves nothing.
    """
    for radius, ends in _tried(scenario, vehicle):
        if not _connected(_free(scenario, radius - _ROUNDING, margin), ends):
            return _narrowest(scenario, margin, radius, ends, _open_margin(scenario, vehicle, margin))
    return None


def is_closed(scenario: Scenario, vehicle: VehicleModel, margin: float) -> bool:
    """Whether there is a :func:`bottleneck`, without looking where."""
    return any(
        not _connected(_free(scenario, radius - _ROUNDING, margin), ends) for radius, ends in _tried(scenario, vehicle)
    )


def _tried(scenario: Scenario, vehicle: VehicleModel) -> list[tuple[float, list[Array]]]:
    """Radius of each disc and where its centre is at the start and at the goal."""
    return [
        (radius, [_at(state, centre) for state in (scenario.start, scenario.goal)])
        for centre, radius in _discs(vehicle)
    ]


def _discs(vehicle: VehicleModel) -> list[tuple[Array, float]]:
    """Centre and radius of the largest disc in each part that is fixed to the rear-axle frame, the largest first."""
    discs = []
    for part in vehicle.parts:
        if part.frame == 0:
            polygon = part.polygon
            line = shapely.maximum_inscribed_circle(polygon.to_shapely(), tolerance=1e-3)
            centre = shapely.get_coordinates(line)[0]
            discs.append((centre, float((polygon.b - polygon.A @ centre).min())))
    return sorted(discs, key=lambda disc: -disc[1])


def _at(state: Array, centre: Array) -> Array:
    """Where the body's point is, m, when the vehicle stands there."""
    return np.asarray(transform(centre[None], state[:3])[0])


def _free(scenario: Scenario, radius: float, margin: float) -> list[Any]:
    """Connected pieces of where the centre of a disc may be: polygons that contain the true ones."""
    W = scenario.workspace
    try:
        room = ConvexPolygon.from_halfplanes(W.A, W.b - radius).to_shapely()
    except GeometryError:
        return []
    if scenario.obstacles:
        polygons = [polygon.to_shapely() for _, polygon in scenario.obstacle_parts]
        taken = shapely.union_all(shapely.buffer(polygons, radius + margin, quad_segs=_QUADRANT))
        room = shapely.difference(room, taken)
    return [piece for piece in shapely.get_parts(room) if piece.area > 0]


def _pieces_of(pieces: list[Any], ends: list[Array]) -> list[int]:
    """Which piece holds each end (the nearest one); empty if there is none."""
    return [int(np.argmin(shapely.distance(pieces, shapely.Point(end)))) for end in ends] if pieces else []


def _connected(pieces: list[Any], ends: list[Array]) -> bool:
    holding = _pieces_of(pieces, ends)
    return bool(holding) and holding[0] == holding[1]


def _open_margin(scenario: Scenario, vehicle: VehicleModel, margin: float) -> float | None:
    """The largest smaller margin in whole mm for which the way is not closed, m."""
    if is_closed(scenario, vehicle, 0.0):
        return None
    high = int(np.ceil(1000 * margin))
    return bisected(lambda value: not is_closed(scenario, vehicle, value / 1000), 0, high) / 1000


def _narrowest(
    scenario: Scenario, margin: float, radius: float, ends: list[Array], open_margin: float | None
) -> Bottleneck:
    """Bisection for the largest disc that passes; 0 if not even a point does."""
    passing, failing = 0.0, radius - _ROUNDING
    largest = _free(scenario, failing, margin)
    if not _connected(_free(scenario, 0.0, margin), ends):
        failing = 0.0
    while failing - passing > ACCURACY / 2:
        middle = (passing + failing) / 2
        passing, failing = (middle, failing) if _connected(_free(scenario, middle, margin), ends) else (passing, middle)
    pieces = _free(scenario, failing, margin)
    here, there = _pieces_of(pieces, ends)
    place = _gap(pieces, here, there, ends)
    reached = largest[_pieces_of(largest, ends)[0]]
    beside = _beside(scenario, place, failing + margin)
    return Bottleneck(place, beside, 2 * passing, 2 * radius, open_margin, reached)


def _gap(pieces: list[Any], here: int, there: int, ends: list[Array]) -> Array:
    """The middle of a shortest line from one piece to the next on the way to the other end.

    If there are many such lines, as across a wall, the one that begins nearest to the straight line between the ends.
    """
    line = shapely.shortest_line(pieces[here], pieces[there])
    crossed = [i for i, piece in enumerate(pieces) if i != here and shapely.intersects(line, piece)]
    onward = shapely.union_all([pieces[i] for i in crossed])
    near = shapely.buffer(onward, 1.001 * shapely.distance(pieces[here], onward) + ACCURACY, quad_segs=64)
    shore = shapely.intersection(shapely.boundary(pieces[here]), near)
    shore = pieces[here] if shore.is_empty else shore
    first = shapely.get_coordinates(shapely.shortest_line(shore, shapely.LineString(ends)))[0]
    last = shapely.get_coordinates(shapely.shortest_line(shapely.Point(first), onward))[-1]
    return np.asarray((first + last) / 2)


def _beside(scenario: Scenario, place: Array, radius: float) -> tuple[str, ...]:
    """Names of the two things nearest to the place, if they are about as near as the disc's rim."""
    point = shapely.Point(place)
    distances: dict[str, float] = {}
    names = labels(scenario)
    for part_name, polygon in scenario.obstacle_parts:
        name = names[part_name]
        distances[name] = min(distances.get(name, np.inf), float(polygon.to_shapely().distance(point)))
    distances[WORKSPACE] = float((scenario.workspace.b - scenario.workspace.A @ place).min())
    near = sorted(distances, key=lambda name: round(distances[name], 2))[:2]  # of equals the first in the scene
    return tuple(name for name in near if distances[name] <= _BESIDE * radius + 0.05)
