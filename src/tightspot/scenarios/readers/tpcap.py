"""Scenes of the Trajectory Planning Competition for Automated Parking: CSV files of numbers only.

Values, 1-based: V1-3 start x, y, theta; V4-6 goal x, y, theta; V7 number of obstacles n; then n vertex
counts; then the vertices x, y, obstacle after obstacle, unclosed. Metres and radians, the pose is that of the
rear-axle midpoint.

What the format leaves open is set here: the workspace is the box around start and goal grown by 15 m, the
vehicle ``tpcap``, the demanded clearance 0.02 m, both ends at rest with straight wheels. Headings are wrapped
to (-pi, pi].
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import NDArray

from tightspot.errors import Problem, SceneError
from tightspot.geometry import wrap_angle
from tightspot.problems import MOST_PROBLEMS, shortened, shown
from tightspot.scenarios.readers.files import read_text, refuse
from tightspot.scenarios.scenario import Scenario
from tightspot.scenarios.schema import MAX_VERTICES

Array = NDArray[np.float64]

ROOM = 15.0
"""The workspace reaches this far beyond the box around start and goal, m."""
MARGIN = 0.02
THICKNESS = 1e-3
"""An obstacle without area (a point, a wall drawn as a line) becomes a rectangle this thick, m."""
_THINNEST = 1e-5
_MOST_VALUES = 7 + 3 * MAX_VERTICES

_DELIMITER = re.compile(r"\s*[,;]\s*|\s+")


def read_tpcap(path: Path) -> Scenario:
    """The scene in a competition file.

    Separators may be commas, semicolons, blanks and line breaks. An obstacle that has no area is not dropped,
    which would be unsafe, but thickened to 1 mm.

    Raises:
        SceneError: Not numbers, fewer or more numbers than announced, or a scene that is none.
    """
    values = _numbers(path, read_text(path))
    counts = _counts(path, values)
    ends = 7 + len(counts) + 2 * np.cumsum([0, *counts])
    rings = [values[a:b].reshape(-1, 2) for a, b in itertools.pairwise(ends)]
    (x0, y0), (x1, y1) = values[0:2], values[3:5]
    return Scenario.from_dict(
        {
            "name": path.stem[:200],
            "description": "A scene of the Trajectory Planning Competition for Automated Parking (TPCAP).",
            "source": f"TPCAP, {path.name[:200]}",
            "vehicle": "tpcap",
            "margin": MARGIN,
            "workspace": {
                "x": [min(x0, x1) - ROOM, max(x0, x1) + ROOM],
                "y": [min(y0, y1) - ROOM, max(y0, y1) + ROOM],
            },
            "obstacles": [{"vertices": _thickened(ring).tolist()} for ring in rings],
            "start": _pose(values[0:3]),
            "goal": _pose(values[3:6]),
        }
    )


def _pose(values: Array) -> dict[str, float]:
    x, y, theta = values.tolist()
    return {"x": x, "y": y, "theta": float(wrap_angle(theta))}


def _numbers(path: Path, text: str) -> Array:
    values: list[float] = []
    problems: list[Problem] = []
    for line, token in _tokens(text):
        value = _number(token)
        if not np.isfinite(value):
            problems.append(Problem(f"value {len(values) + 1}", _token_sentence(token, line)))
        values.append(value)
        if len(values) > _MOST_VALUES or len(problems) > MOST_PROBLEMS:
            break
    if problems:
        raise SceneError(shortened(problems))
    if len(values) > _MOST_VALUES:
        raise refuse(path, f"holds more numbers than a scene of {MAX_VERTICES} vertices")
    return np.array(values)


def _tokens(text: str) -> Iterator[tuple[int, str]]:
    """Line number and text of what stands between separators; empty if there is nothing between two."""
    for number, line in enumerate(text.splitlines(), start=1):
        stripped = line.strip().rstrip(",; \t")
        if stripped:
            yield from ((number, token) for token in _DELIMITER.split(stripped, _MOST_VALUES + 1))


def _number(token: str) -> float:
    try:
        return float(token) if "_" not in token else np.nan
    except ValueError:
        return np.nan


def _token_sentence(token: str, line: int) -> str:
    if not token:
        return f"is missing: there is nothing between two separators in line {line}"
    return f"{shown(token)} in line {line} is not a finite number; a TPCAP file holds numbers only"


def _counts(path: Path, values: Array) -> list[int]:
    """The vertex counts, after the length of the file has been checked against them."""
    found = len(values)
    if found < 7:
        raise _wrong_length(path, "at least 7", found)
    announced = values[6]
    if announced != np.round(announced) or not 0 <= announced <= MAX_VERTICES:
        sentence = f"{announced:g} is not a number of obstacles between 0 and {MAX_VERTICES} (value 7)"
        raise SceneError(Problem(path.name, sentence))
    n = int(announced)
    if found < 7 + n:
        raise _wrong_length(path, f"at least {7 + n} ({n} obstacles)", found)
    counts = values[7 : 7 + n]
    odd = [
        Problem(path.name, f"{count:g} is not a number of vertices (value {8 + i})")
        for i, count in enumerate(counts)
        if count != np.round(count) or count < 1
    ]
    if odd:
        raise SceneError(shortened(odd))
    if counts.sum() > MAX_VERTICES:
        sentence = f"announces {counts.sum():g} vertices; at most {MAX_VERTICES} are read"
        raise SceneError(Problem(path.name, sentence))
    expected = 7 + n + 2 * int(counts.sum())
    if found != expected:
        raise _wrong_length(path, f"{expected} ({n} obstacles of {int(counts.sum())} vertices)", found)
    return [int(count) for count in counts]


def _wrong_length(path: Path, expected: str, found: int) -> SceneError:
    return SceneError(Problem(path.name, f"holds {found} numbers where {expected} were expected; is it cut off?"))


def _thickened(ring: Array) -> Array:
    """The ring itself, or a rectangle 1 mm thick about it if it has no area to speak of."""
    local = shapely.MultiPoint(ring - ring[0])
    box = shapely.minimum_rotated_rectangle(local)
    if box.geom_type == "Polygon" and _width(box) > _THINNEST:
        return ring
    spine = box if box.geom_type != "Polygon" else _longest_edge(box)
    if spine.geom_type == "Point":
        corners = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]) * THICKNESS / 2
    else:
        corners = shapely.get_coordinates(spine.buffer(THICKNESS / 2, cap_style="square"))[:-1]
    thick: Array = ring[0] + corners
    return thick


def _edges(box: shapely.Polygon) -> Array:
    corners: Array = shapely.get_coordinates(box)
    return np.diff(corners, axis=0)


def _width(box: shapely.Polygon) -> float:
    return float(np.hypot(*_edges(box).T).min())


def _longest_edge(box: shapely.Polygon) -> shapely.LineString:
    corners = shapely.get_coordinates(box)
    longest = int(np.hypot(*_edges(box).T).argmax())
    return shapely.LineString(corners[longest : longest + 2])
