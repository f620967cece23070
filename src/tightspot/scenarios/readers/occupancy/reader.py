"""From a map file to a scene: every occupied cell lies in an obstacle."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from tightspot.errors import SceneError
from tightspot.geometry import rotation
from tightspot.geometry.outward import outward
from tightspot.safe_yaml import UnreadableError, load_yaml
from tightspot.scenarios.assemble import MOST_ROOM
from tightspot.scenarios.readers.files import read_text, refuse
from tightspot.scenarios.readers.given import Given, require_ends
from tightspot.scenarios.readers.occupancy.cells import Mask, occupied_cells
from tightspot.scenarios.readers.occupancy.map_file import SECTION, MapSpec, is_map, picture_path, read_spec
from tightspot.scenarios.readers.occupancy.outlines import count_sides, outlines
from tightspot.scenarios.readers.occupancy.pictures import read_picture
from tightspot.scenarios.readers.source import Source
from tightspot.scenarios.scenario import Scenario
from tightspot.scenarios.schema import LARGEST_COORDINATE

Array = NDArray[np.float64]

TOLERANCE = 0.05
"""Outlines may reach out of the occupied cells by this, m, or by a cell if that is larger, if the file does not say."""
MAX_SIDES = 30_000
HAIR = 1e-6
"""Outlines are grown by this, m, so that no rounding uncovers the edge of a cell."""


class Frame(NamedTuple):
    """The part of the map that is used: its lower left corner in the file's plane, m, yaw, and a cell's side, m."""

    corner: Array
    yaw: float
    resolution: float

    def points(self, cells: Array) -> Array:
        """Coordinates in the file's plane of points (n, 2) in units of cells."""
        return np.asarray(self.corner + cells * self.resolution @ rotation(self.yaw).T)

    def cells(self, points: Array) -> Array:
        """The inverse of :meth:`points`."""
        return np.asarray((points - self.corner) @ rotation(self.yaw) / self.resolution)


def read_map(source: Source, given: Given) -> Scenario:
    """The scene in a map file with its picture.

    Start and goal come from the caller or from the file's section ``tightspot``. What is farther than 50 m from both is
    left out. The workspace is the map, or the part of it that is used.

    Raises:
        SceneError: With all problems, each with its path in the file, or the picture's name.
    """
    data = source.yaml
    if not is_map(data):
        raise refuse(source.path, "is no map: it needs image, resolution and origin as ROS's map_server writes them")
    spec, scene = read_spec(data)
    scene = given.over({"name": source.name, "source": f"occupancy map {source.path.name}"[:300], **scene})
    require_ends(scene, f"the file's section {SECTION}: {{ROLE: {{x: ..., y: ..., theta: ...}}}}")
    mask = occupied_cells(
        read_picture(picture_path(source.path, spec.image)),
        spec,
        (given.unknown or spec.tightspot.unknown) == "occupied",
    )
    frame = Frame(np.array(spec.origin[:2]), spec.origin[2], spec.resolution)
    mask, frame = _cropped(mask, frame, scene)
    polygons = _polygons(mask, spec, source.path)
    obstacles = [_obstacle(f"cells-{index}", polygon, frame) for index, polygon in enumerate(polygons)]
    rows, columns = mask.shape
    corners = frame.points(np.array([(0, 0), (columns, 0), (columns, rows), (0, rows)], dtype=float))
    whole = {"workspace": corners.tolist(), **scene, "obstacles": obstacles}
    return Scenario.from_dict(whole)


def tolerance(spec: MapSpec) -> float:
    """How far outlines may reach out of the occupied cells, m."""
    if spec.tightspot.simplify is not None:
        return spec.tightspot.simplify
    return max(spec.resolution, TOLERANCE)


def picture_alone(path: Path) -> SceneError:
    """What to say if somebody gives the picture instead of the map file: which file it is, if it lies beside it."""
    try:
        beside = [other for other in sorted(path.parent.iterdir())[:1000] if other.suffix.lower() in (".yaml", ".yml")]
    except OSError:
        beside = []
    for other in beside[:100]:
        try:
            data = load_yaml(read_text(other))
        except (SceneError, UnreadableError):
            continue
        if is_map(data) and isinstance(data["image"], str) and picture_path(other, data["image"]) == path:
            return refuse(path, f"is only the picture of a map; give {other}")
    return refuse(path, "is only a picture; give the YAML file with its image, resolution and origin (ROS map_server)")


def _cropped(mask: Mask, frame: Frame, scene: Mapping[str, Any]) -> tuple[Mask, Frame]:
    """The part of the map within 50 m of start or goal; all of it if they are no places."""
    try:
        ends = np.array([[float(scene[key][axis]) for axis in "xy"] for key in ("start", "goal")])
    except (TypeError, ValueError, KeyError, OverflowError):
        return mask, frame
    rows, columns = mask.shape
    reach = MOST_ROOM / frame.resolution
    if not (np.abs(ends) <= LARGEST_COORDINATE).all():  # refused later, with all else that is wrong; NaN too
        return mask, frame
    cells = frame.cells(ends)
    low = np.clip(np.floor(cells.min(axis=0) - reach), 0, (columns - 1, rows - 1)).astype(int)
    high = np.clip(np.ceil(cells.max(axis=0) + reach), low + 1, (columns, rows)).astype(int)
    part = mask[low[1] : high[1], low[0] : high[0]]
    return part, Frame(frame.points(low.astype(float)), frame.yaw, frame.resolution)


def _polygons(mask: Mask, spec: MapSpec, path: Path) -> list[shapely.Polygon]:
    """Simplified outlines in units of cells, the largest first."""
    sides = count_sides(mask)
    if sides > MAX_SIDES:
        sentence = f"the occupied cells' outline has {sides} sides, at most {MAX_SIDES} are read"
        sentence += "; remove noise from the picture"
        raise refuse(path, sentence)
    room = tolerance(spec) / spec.resolution
    hair = HAIR / spec.resolution
    simple = [outward(polygon, room - hair) if room > hair else polygon for polygon in outlines(mask)]
    grown = [polygon.buffer(hair, join_style="mitre") for polygon in simple]
    return sorted(grown, key=lambda polygon: -polygon.area)


def _obstacle(name: str, polygon: shapely.Polygon, frame: Frame) -> dict[str, Any]:
    exterior, *holes = (
        frame.points(shapely.get_coordinates(ring)[:-1]).tolist() for ring in (polygon.exterior, *polygon.interiors)
    )
    return {"name": name, "vertices": exterior, "holes": holes}
