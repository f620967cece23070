"""WKT with roles: one geometry a line, or a table with a column of geometries, in projected metres.

A line holds fields separated by semicolons, in any order: a role, a geometry, and ``key=value``. Values that are not a
word or a number are JSON. The line ``scene; vehicle=tpcap; margin=0.05`` holds what a scene has beyond its geometry;
lines that begin with ``#`` are comments.
"""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Iterator, Mapping
from typing import Any

from tightspot.errors import Problem, SceneError
from tightspot.problems import MOST_PROBLEMS, shortened, shown, unknown_key
from tightspot.safe_yaml import UnreadableError, load_json
from tightspot.scenarios.readers.features import PROJECT, ROLES, SCENE_FIELDS, Count, Feature, scene_of
from tightspot.scenarios.readers.given import Given
from tightspot.scenarios.readers.source import Source
from tightspot.scenarios.readers.wkt_geometry import GEOMETRY, shapes_in
from tightspot.scenarios.scenario import Scenario

FORMAT = "tightspot-wkt/1"
_ROLE = re.compile(rf"({'|'.join(ROLES)}|scene)(?:\s*[:,]\s*|\s+|$)", re.IGNORECASE)
_SRID = re.compile(r"SRID\s*=\s*(\d{1,9})\s*$", re.IGNORECASE)
_PROPERTY = re.compile(r"\s*([A-Za-z_]\w{0,40})\s*=\s*(.*)", re.DOTALL)
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_PIECE = re.compile(r'(?:"[^"\\]*+(?:\\.[^"\\]*+)*+"|[^;"]++)++|;+|"')
_DEGREES = (4326, 4258, 4269)


def is_wkt(text: str) -> bool:
    """Whether a text is meant to be WKT: a geometry, or a column for them, stands in one of its first lines."""
    return _has_header(text) or any(GEOMETRY.search(line[:4000]) for line in text[:100_000].splitlines()[:50])


def read_wkt(source: Source, given: Given) -> Scenario:
    """The scene in a WKT file or in a table with a column ``wkt``.

    Raises:
        SceneError: With all problems, each with its line.
    """
    whole: dict[str, Any] = {}
    problems: list[Problem] = []
    rows = _table(source.text, problems) if _has_header(source.text) else _lines(source.text, whole, problems)
    features, count = [], Count()
    for where, geometry, properties in rows:
        try:
            shapes = tuple(map(count.add, shapes_in(geometry)))
        except SceneError:
            raise
        except ValueError as error:
            problems.append(Problem(where, str(error)))
            shapes = ()
        if shapes:
            features.append(Feature(shapes, properties, where))
        if len(problems) > MOST_PROBLEMS:
            break
    if problems:
        raise SceneError(shortened(problems))
    title = "a line `ROLE; POINT (x y); theta=...`"
    return scene_of(features, whole, given, source.name, place="scene", title=title)


def to_wkt(scenario: Scenario) -> str:
    """The text of a WKT file that holds the scene."""
    data = scenario.to_dict()
    whole = {"format": FORMAT, "unit": "m", **{key: data[key] for key in SCENE_FIELDS}}
    lines = [_line("scene", None, whole)]
    for role in ("start", "goal"):
        state = dict(data[role])
        lines.append(_line(role, f"POINT ({state.pop('x')!r} {state.pop('y')!r})", state))
    region = data["workspace"]
    rings = [region["vertices"], *region["holes"]] if isinstance(region, Mapping) else [region]
    lines.append(_line("boundary", _polygon(rings), {}))
    for obstacle in data["obstacles"]:
        rings = [obstacle["vertices"], *obstacle.get("holes", [])]
        lines.append(_line("obstacle", _polygon(rings), {"name": obstacle["name"]}))
    return "\n".join(lines) + "\n"


def _line(role: str, geometry: str | None, properties: Mapping[str, Any]) -> str:
    said = [f"{key}={json.dumps(value, ensure_ascii=False, allow_nan=False)}" for key, value in properties.items()]
    return "; ".join([role, *said, *([geometry] if geometry else [])])


def _polygon(rings: list[list[list[float]]]) -> str:
    texts = [", ".join(f"{x!r} {y!r}" for x, y in [*ring, ring[0]]) for ring in rings]
    return f"POLYGON ({', '.join(f'({text})' for text in texts)})"


_Row = tuple[str, str, dict[str, Any]]


def _lines(text: str, whole: dict[str, Any], problems: list[Problem]) -> Iterator[_Row]:
    """Place, geometry and properties of each line; the scene's own properties go to ``whole``."""
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        where = f"line {number}"
        try:
            role, geometry, properties = _parsed(line)
        except ValueError as error:
            problems.append(Problem(where, str(error)))
            continue
        if role == "scene":
            _add_whole(properties, where, whole, problems)
        elif geometry is None:
            problems.append(Problem(where, f"has no geometry such as POLYGON ((...)): {shown(line.strip())}"))
        else:
            yield where, geometry, {**properties, **({"role": role} if role else {})}


def _add_whole(properties: Mapping[str, Any], where: str, whole: dict[str, Any], problems: list[Problem]) -> None:
    known = ("format", "unit", *SCENE_FIELDS)
    problems += [unknown_key(where, key, known) for key in properties if key not in known]
    for key, wanted in (("format", FORMAT), ("unit", "m")):
        if properties.get(key, wanted) != wanted:
            sentence = f"{key} {shown(properties[key])} is not known to this version; it must be {wanted!r}"
            problems.append(Problem(where, sentence))
    whole |= {key: properties[key] for key in SCENE_FIELDS if key in properties}


def _parsed(line: str) -> tuple[str | None, str | None, dict[str, Any]]:
    """Role, geometry and properties of a line; raises ``ValueError`` with a sentence."""
    role: str | None = None
    geometry: str | None = None
    properties: dict[str, Any] = {}
    for text in _fields(line):
        field = text.strip()
        word = _ROLE.match(field)
        if word and role is None:
            role, field = word[1].lower(), field[word.end() :].strip()
        if not field:
            continue
        srid, said = _SRID.match(field), _PROPERTY.match(field)
        if srid:
            _check_srid(int(srid[1]))
        elif GEOMETRY.match(field):
            if geometry is not None:
                raise ValueError("has two geometries; write one a line")
            geometry, heading = _heading_after(field)
            properties |= heading
        elif said:
            key = said[1].lower()
            if key in properties:
                raise ValueError(f"says {key} twice; remove one of them")
            properties[key] = _value(key, said[2].strip())
        else:
            words = f"a role ({', '.join(ROLES)}), a geometry such as POLYGON ((...)) nor key=value"
            raise ValueError(f"{shown(field)} is neither {words}")
    return role, geometry, properties


def _fields(line: str) -> Iterator[str]:
    """What stands between semicolons, those within quotes left alone."""
    field: list[str] = []
    for piece in _PIECE.finditer(line):
        if not piece[0].startswith(";"):
            field.append(piece[0])
        elif field:
            yield "".join(field)
            field = []
    yield "".join(field)


def _heading_after(field: str) -> tuple[str, dict[str, Any]]:
    """A geometry and, if a number follows it, that as ``theta``."""
    end = field.rfind(")") + 1 or len(field)
    rest = field[end:].strip()
    if not rest:
        return field, {}
    if not _NUMBER.fullmatch(rest):
        raise ValueError(f"{shown(rest)} after the geometry is not a heading in radians")
    return field[:end], {"theta": float(rest)}


def _value(key: str, text: str) -> Any:
    if _NUMBER.fullmatch(text[:100]):
        return float(text)
    if text[:1] in ('"', "{", "[") or text in ("null", "true", "false"):
        try:
            return load_json(text)
        except UnreadableError as error:
            raise ValueError(f"the value of {key} {error}") from None
    return None if text == "free" else text


def _has_header(text: str) -> bool:
    first = next((line for line in text[:10_000].splitlines() if line.strip()), "")
    return not GEOMETRY.search(first) and _column(re.split(r"[,;\t]", first)) is not None


def _column(names: list[str]) -> int | None:
    words = [name.strip().strip('"').lower() for name in names]
    return next(
        (words.index(word) for word in ("wkt", "geometry", "geom", "the_geom", "wkt_geom") if word in words), None
    )


def _table(text: str, problems: list[Problem]) -> Iterator[_Row]:
    """Place, geometry and properties of each row of a table with a header."""
    first = next(line for line in text.splitlines() if line.strip())
    delimiter = max(",;\t", key=first.count)
    reader = csv.reader(io.StringIO(text), delimiter=delimiter, skipinitialspace=True)
    try:
        header = [name.strip().lower() for name in next(row for row in reader if row)]
        column = _column(header)
        for row in reader:
            if not any(cell.strip() for cell in row) or column is None:
                continue
            where = f"line {reader.line_num}"
            if len(row) != len(header):
                sentence = f"has {len(row)} columns where the header has {len(header)}; quote the geometry"
                problems.append(Problem(where, sentence))
                continue
            cells = {key: _value(key, cell.strip()) for key, cell in zip(header, row, strict=True) if cell.strip()}
            geometry = row[column].strip()
            srid, _, rest = geometry.partition(";")
            if _SRID.match(srid.strip()):
                _check_srid(int(_SRID.match(srid.strip())[1]))  # type: ignore[index]
                geometry = rest.strip()
            yield where, geometry, {key: value for key, value in cells.items() if key != header[column]}
    except csv.Error as error:
        advice = "; write long geometries one a line, not in a table" if "limit" in str(error) else ""
        problems.append(Problem(f"line {reader.line_num}", f"cannot be read: {error}{advice}"))
    except ValueError as error:
        problems.append(Problem(f"line {reader.line_num}", str(error)))


def _check_srid(number: int) -> None:
    if number in _DEGREES:
        raise ValueError(f"SRID {number} is degrees of longitude and latitude; {PROJECT}")
