"""The formats that scenes are read from and written to, and which one a file is in."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from tightspot import vehicles
from tightspot.errors import InputError, Problem, SceneError
from tightspot.problems import near, shown
from tightspot.scenarios.readers import geojson, native, occupancy, tpcap, tpcap_writer, wkt
from tightspot.scenarios.readers.files import exists, refuse
from tightspot.scenarios.readers.given import Given
from tightspot.scenarios.readers.source import Source
from tightspot.scenarios.scenario import Scenario


@dataclass(frozen=True)
class Format:
    """A file format.

    Attributes:
        name: What ``--format`` takes.
        title: For people.
        extensions: Lower case. A file is written in the first format that has its extension.
        read: A scene from a file.
        write: The file's text for a scene; ``None`` if the format is only read.
    """

    name: str
    title: str
    extensions: tuple[str, ...]
    read: Callable[[Source, Given], Scenario]
    write: Callable[[Scenario], str] | None = None


def _read_commonroad(source: Source, given: Given) -> Scenario:
    from tightspot.scenarios.readers.commonroad import read_commonroad

    car = vehicles.from_dict(given.vehicle) if isinstance(given.vehicle, Mapping) else given.vehicle
    return given.over_scenario(read_commonroad(source.path, vehicle=car))


def _write_commonroad(scenario: Scenario) -> str:
    from tightspot.scenarios.readers.commonroad.writer import to_xml

    return to_xml(scenario)


FORMATS: dict[str, Format] = {
    format_.name: format_
    for format_ in (
        Format("yaml", "scene in YAML", (".yaml", ".yml"), native.read_yaml, native.to_yaml),
        Format("json", "scene or plan in JSON", (".json",), native.read_json, native.to_json),
        Format("geojson", "GeoJSON with roles", (".geojson", ".json"), geojson.read_geojson, geojson.to_geojson),
        Format("tpcap", "TPCAP", (".csv",), tpcap.read_tpcap, tpcap_writer.to_tpcap),
        Format("wkt", "WKT with roles", (".wkt", ".txt", ".csv"), wkt.read_wkt, wkt.to_wkt),
        Format("commonroad", "CommonRoad", (".xml",), _read_commonroad, _write_commonroad),
        Format("map", "occupancy map of ROS's map_server", (".yaml", ".yml"), occupancy.read_map),
    )
}
EXTENSIONS = tuple(dict.fromkeys(extension for format_ in FORMATS.values() for extension in format_.extensions))
"""Of files that are scenes."""


def named(name: str, option: str = "format") -> Format:
    """The format of that name; raises :class:`InputError` with all names."""
    if name in FORMATS:
        return FORMATS[name]
    guesses = near(name, FORMATS)
    advice = f"did you mean {guesses[0]!r}?" if guesses else f"choose one of {', '.join(FORMATS)}"
    raise InputError(Problem(option, f"{shown(name)} is not known; {advice}"))


def guess(source: Source) -> Format:
    """The format that a file is in, by its extension, and by its content where that leaves a choice.

    Raises:
        SceneError: It is none of them, or cannot be read.
    """
    path = source.path
    suffix = path.suffix.lower()
    if suffix in (".yaml", ".yml"):
        return FORMATS["map" if occupancy.is_map(source.yaml) else "yaml"]
    if suffix == ".json":
        return FORMATS["geojson" if geojson.is_geojson(source.json) else "json"]
    if suffix == ".csv":
        return FORMATS["wkt" if wkt.is_wkt(source.text) else "tpcap"]
    for name, extension in (("geojson", ".geojson"), ("wkt", ".wkt"), ("commonroad", ".xml")):
        if suffix == extension:
            return FORMATS[name]
    if suffix in occupancy.PICTURES and exists(path):
        raise occupancy.picture_alone(path)
    return _by_content(source)


def _by_content(source: Source) -> Format:
    """The format of a file whose extension says nothing."""
    path = source.path
    if path.is_dir():
        raise refuse(path, "is a directory; give the file in it")
    unknown = f"has an unknown extension {path.suffix!r}"
    try:
        start = source.text.lstrip()[:100]
    except SceneError as error:
        raise refuse(path, f"{error.problems[0].message}; it {unknown}, scenes are read from {_listed()}") from None
    if start.startswith("<"):
        return FORMATS["commonroad"]
    if start.startswith("{"):
        return FORMATS["geojson" if geojson.is_geojson(source.json) else "json"]
    if wkt.is_wkt(source.text):
        return FORMATS["wkt"]
    if tpcap.looks_like_tpcap(source.text):
        return FORMATS["tpcap"]
    raise refuse(path, f"{unknown}, and its content is none of {_listed()}")


def for_writing(path: Path, name: str | None) -> tuple[Format, Callable[[Scenario], str]]:
    """The format to write a file in, and what writes it: the named one, or by the extension.

    Raises:
        InputError: It is not known, or not written.
    """
    suffix = path.suffix.lower()
    if name is None:
        name = next((key for key, known in FORMATS.items() if suffix in known.extensions and known.write), None)
        if name is None:
            sentence = f"has an unknown extension {suffix!r}; scenes are written to {_listed()}, or name a --format"
            raise InputError(Problem(str(path), sentence))
    format_ = named(name)
    if format_.write is None:
        written = ", ".join(other.name for other in FORMATS.values() if other.write)
        raise InputError(Problem("format", f"{format_.name} ({format_.title}) is only read; choose one of {written}"))
    return format_, format_.write


def _listed() -> str:
    return ", ".join(EXTENSIONS)
