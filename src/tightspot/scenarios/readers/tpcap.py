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
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import Problem, SceneError
from tightspot.geometry import wrap_angle
from tightspot.problems import MOST_PROBLEMS, shortened, shown
from tightspot.scenarios.readers.files import refuse
from tightspot.scenarios.readers.given import Given
from tightspot.scenarios.readers.source import Source
from tightspot.scenarios.readers.thickening import thickened_ring
from tightspot.scenarios.scenario import Scenario
from tightspot.scenarios.schema import MAX_DRAWN

Array = NDArray[np.float64]

ROOM = 15.0
"""The workspace reaches this far beyond the box around start and goal, m."""
MARGIN = 0.02
VEHICLE = "tpcap"
DESCRIPTION = "A scene of the Trajectory Planning Competition for Automated Parking (TPCAP)."
_MOST_VALUES = 7 + 3 * MAX_DRAWN

_DELIMITER = re.compile(r"\s*[,;]\s*|\s+")
_UNQUOTED = re.compile(r"^\"([^\"]*)\"$")


def read_tpcap(source: Source, given: Given) -> Scenario:
    """The scene in a competition file.

    Separators may be commas, semicolons, blanks and line breaks; numbers may be in quotes. An obstacle that has
    no area (a point, a wall drawn as a line) is not dropped, which would be unsafe, but thickened to 1 mm.

    Raises:
        SceneError: Not numbers, fewer or more numbers than announced, or a scene that is none.
    """
    path = source.path
    values = _numbers(path, source.text)
    counts = _counts(path, values)
    ends = 7 + len(counts) + 2 * np.cumsum([0, *counts])
    rings = [values[a:b].reshape(-1, 2) for a, b in itertools.pairwise(ends)]
    start, goal = _pose(values[0:3]), _pose(values[3:6])
    data = given.over(
        {
            "name": source.name,
            "description": DESCRIPTION,
            "source": f"TPCAP, {path.name[:200]}",
            "vehicle": VEHICLE,
            "margin": MARGIN,
            "obstacles": [{"vertices": thickened_ring(ring).tolist()} for ring in rings],
            "start": start,
            "goal": goal,
        }
    )
    return Scenario.from_dict(data | {"workspace": _workspace(data["start"], data["goal"], start, goal)})


def _workspace(*states: Mapping[str, Any]) -> dict[str, list[float]]:
    """The box around the states grown by 15 m; what the caller gave may be no numbers."""
    known = {
        key: [state[key] for state in states if isinstance(state.get(key), int | float) and np.isfinite(state[key])]
        for key in ("x", "y")
    }
    return {key: [min(values) - ROOM, max(values) + ROOM] for key, values in known.items()}


def looks_like_tpcap(text: str) -> bool:
    """Whether a text begins with the numbers that every such file has."""
    tokens = [token for _, token in itertools.islice(_tokens(text[:10_000]), 7)]
    return len(tokens) == 7 and all(np.isfinite(_number(token)) for token in tokens)


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
        raise refuse(path, f"holds more numbers than a scene of {MAX_DRAWN} vertices")
    return np.array(values)


def _tokens(text: str) -> Iterator[tuple[int, str]]:
    """Line number and text of what stands between separators; empty if there is nothing between two."""
    for number, line in enumerate(text.splitlines(), start=1):
        stripped = line.strip().rstrip(",; \t")
        if stripped:
            yield from ((number, token) for token in _DELIMITER.split(stripped, _MOST_VALUES + 1))


def _number(token: str) -> float:
    try:
        return float(_UNQUOTED.sub(r"\1", token)) if "_" not in token else np.nan
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
    if announced != np.round(announced) or not 0 <= announced <= MAX_DRAWN:
        sentence = f"{announced:g} is not a number of obstacles between 0 and {MAX_DRAWN} (value 7)"
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
    total = sum(counts.tolist())
    if total > MAX_DRAWN:
        sentence = f"announces {total:g} vertices; at most {MAX_DRAWN} are read"
        raise SceneError(Problem(path.name, sentence))
    expected = 7 + n + 2 * int(counts.sum())
    if found != expected:
        raise _wrong_length(path, f"{expected} ({n} obstacles of {int(counts.sum())} vertices)", found)
    return [int(count) for count in counts]


def _wrong_length(path: Path, expected: str, found: int) -> SceneError:
    return SceneError(Problem(path.name, f"holds {found} numbers where {expected} were expected; is it cut off?"))
