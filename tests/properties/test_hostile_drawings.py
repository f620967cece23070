"""Whatever is in a GeoJSON, WKT or map file: a scene, or a SceneError that can be printed. Never anything else."""

import copy
import json
from typing import Any

import pytest
import yaml
from hypothesis import example, given, settings
from hypothesis import strategies as st

from tightspot.errors import SceneError
from tightspot.scenarios import Scenario, load

KEYS = [
    "type",
    "features",
    "geometry",
    "geometries",
    "coordinates",
    "properties",
    "role",
    "theta",
    "width",
    "tightspot",
]
WORDS = ["Point", "Polygon", "LineString", "MultiPolygon", "GeometryCollection", "Feature", "start", "goal", "boundary"]
numbers = st.one_of(st.floats(), st.integers(-9, 9), st.sampled_from([10**400, 1e308, 1e-320, 4.5e9, -0.0, True]))
scalars = st.one_of(st.none(), numbers, st.text(max_size=5), st.sampled_from(WORDS))
junk = st.recursive(
    scalars,
    lambda inner: st.one_of(
        st.lists(inner, max_size=5), st.dictionaries(st.one_of(st.sampled_from(KEYS), st.text(max_size=3)), inner)
    ),
    max_leaves=15,
)
RING = [[4, 4], [6, 4], [6, 6], [4, 6], [4, 4]]


def _feature(kind, coordinates, **properties):
    return {"type": "Feature", "properties": properties, "geometry": {"type": kind, "coordinates": coordinates}}


DRAWING: dict[str, Any] = {
    "type": "FeatureCollection",
    "tightspot": {"vehicle": "tpcap", "margin": 0.1, "tolerance": {"position": 0.1}},
    "features": [
        _feature("Point", [0, 0], role="start", theta=0),
        _feature("LineString", [[9, 1], [10, 1]], role="goal"),
        _feature("Polygon", [RING], role="obstacle", name="a"),
        _feature("MultiPolygon", [[RING], [RING]], role="obstacle"),
        _feature("LineString", [[-4, -4], [-6, -4]], width=0.2),
        {"type": "Feature", "geometry": {"type": "GeometryCollection", "geometries": [{"type": "Point", "coordinates":
            [3, 3]}]}, "properties": {"role": "obstacle"}},
    ],
}  # fmt: skip
MAP: dict[str, Any] = {
    "image": "hostile.pgm",
    "resolution": 0.5,
    "origin": [0, 0, 0],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
    "mode": "trinary",
    "tightspot": {
        "start": {"x": 1, "y": 1, "theta": 0},
        "goal": {"x": 3, "y": 1, "theta": 0},
        "unknown": "free",
        "simplify": 0.5,
    },
}


def _places(data: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    children = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    return [path, *(place for key, value in children for place in _places(value, (*path, key)))]


def changed(data: Any, place: tuple[Any, ...], value: Any) -> Any:
    data = copy.deepcopy(data)
    target = data
    for key in place[:-1]:
        target = target[key]
    target[place[-1]] = value
    return data


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    """``outcome(name, content)``: the scene in a file, or the refusal, which must be printable."""
    directory = tmp_path_factory.mktemp("hostile")
    (directory / "hostile.pgm").write_bytes(b"P5\n8 6\n255\n" + bytes(47) + b"\xfe")

    def outcome(name: str, content: str | bytes) -> Scenario | None:
        path = directory / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode("utf-8", "surrogatepass"))
        try:
            return load(path)
        except SceneError as error:
            refusal = error
        is_refusal(refusal)
        return None

    return outcome


def is_refusal(error: SceneError) -> None:
    assert error.problems
    for problem in error.problems:
        assert problem.message
        assert len(str(problem)) < 700
        str(problem).encode()


@settings(max_examples=150)
@given(place=st.sampled_from(_places(DRAWING)[1:]), value=junk)
def test_junk_anywhere_in_a_drawing(outcome, place, value):
    scenario = outcome("hostile.geojson", json.dumps(changed(DRAWING, place, value)))
    if scenario is not None:
        assert Scenario.from_dict(scenario.to_dict()).to_dict() == scenario.to_dict()


@given(value=junk)
def test_junk_as_a_drawing(outcome, value):
    outcome("hostile.geojson", json.dumps(value))


@settings(max_examples=100)
@given(place=st.sampled_from(_places(MAP)[1:]), value=junk)
@example(place=("tightspot", "start", "x"), value=9e307)
@example(place=("tightspot", "goal", "y"), value=-1.7e308)
@example(place=("origin", 0), value=9e307)
@example(place=("origin", 2), value=1.7e308)
@example(place=("resolution",), value=1e-320)
def test_junk_anywhere_in_a_map_file(outcome, place, value):
    outcome("hostile.yaml", yaml.safe_dump(changed(MAP, place, value)))


GOOD = (
    'scene; vehicle=tpcap; name="a;b"\nstart; POINT (0 0); theta=0\n'
    "goal; POINT (9 1) 0.5\nPOLYGON ((4 4, 6 4, 6 6, 4 4))\n"
)
WKT_WORDS = ["(", ")", "nan", "1e999", "EMPTY", ";", "=", '"', "POINT", "\x00", "GEOMETRYCOLLECTION (", "-1e308", "Z"]


@settings(max_examples=150)
@given(
    cut=st.integers(0, len(GOOD)),
    length=st.integers(0, 20),
    put=st.one_of(st.text(max_size=8), st.sampled_from(WKT_WORDS)),
)
def test_a_changed_drawing_in_wkt(outcome, cut, length, put):
    outcome("hostile.wkt", GOOD[:cut] + put + GOOD[cut + length :])


@given(text=st.one_of(st.text(), st.text(alphabet="POINTLYGZM()., ;=\"'01-+e\n#SRDstargobundy{}[]")))
def test_any_text_as_wkt(outcome, text):
    outcome("hostile.wkt", text)
    outcome("hostile.txt", text)


@settings(max_examples=150)
@given(
    magic=st.sampled_from([b"P2", b"P5", b"P6", b"\x89PNG\r\n\x1a\n", b"BM", b"GIF89a", b"II*\x00", b""]),
    rest=st.one_of(
        st.binary(max_size=200),
        st.tuples(st.integers(-2, 70_000), st.integers(-2, 12), st.integers(-2, 70_000), st.binary(max_size=40)).map(
            lambda t: b"\n%d %d\n%d\n" % t[:3] + t[3]
        ),
    ),
)
def test_any_bytes_as_a_picture(outcome, magic, rest):
    pictures = {**MAP, "image": "hostile.png"}
    outcome("hostile.png", magic + rest)
    outcome("hostile.yaml", yaml.safe_dump(pictures))
