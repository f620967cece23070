"""Vehicle files: what may stand in them, and one sentence with its path for what may not."""

import copy
import json

import numpy as np
import pytest
import shapely
import yaml

from tightspot.errors import VehicleError
from tightspot.vehicles import VehicleSpec, from_dict, load_vehicle

CAR = {
    "name": "van",
    "wheelbase": 3.1,
    "body": {"length": 5.4, "width": 2.0, "rear_overhang": 1.1},
    "limits": {"speed": [-1.0, 2.0], "acceleration": [-1.0, 1.0], "steering": 0.6, "steering_rate": 0.5},
    "source": "a brochure",
}
TRIANGLE = [[0, -1], [3, 0], [0, 1]]
GONE = object()


def changed(path, value):
    data = copy.deepcopy(CAR)
    *keys, last = path.split(".")
    place = data
    for key in keys:
        place = place[key]
    if value is GONE:
        del place[last]
    else:
        place[last] = value
    return data


def test_a_rectangle_is_read():
    car = from_dict(CAR)
    (part,) = car.parts
    np.testing.assert_allclose(part.polygon.vertices.min(axis=0), [-1.1, -1.0])
    np.testing.assert_allclose(part.polygon.vertices.max(axis=0), [4.3, 1.0])
    assert (car.name, car.wheelbase, car.source) == ("van", 3.1, "a brochure")
    assert car.limits.speed == (-1.0, 2.0)


def test_polygons_are_read_in_any_winding_and_closed():
    closed_clockwise = [*TRIANGLE[::-1], TRIANGLE[-1]]
    (part,) = from_dict(changed("body", [{"name": "nose", "vertices": closed_clockwise}])).parts
    assert part.name == "nose"
    assert part.polygon.to_shapely().equals(shapely.Polygon(TRIANGLE))


def test_a_body_that_is_not_convex_is_decomposed_into_named_parts():
    l_shape = [[0, -1], [4, -1], [4, 0], [2, 0], [2, 1], [0, 1]]
    parts = from_dict(changed("body", [{"name": "cab", "vertices": l_shape}])).parts
    assert [part.name for part in parts] == ["cab/0", "cab/1"]
    union = shapely.unary_union([part.polygon.to_shapely() for part in parts])
    assert union.symmetric_difference(shapely.Polygon(l_shape)).area < 1e-12


@pytest.mark.parametrize(
    ("path", "value", "where", "words"),
    [
        ("wheelbase", GONE, "wheelbase", "is missing"),
        ("wheelbase", "2.8 m", "wheelbase", "'2.8 m'"),
        ("wheelbase", 0, "wheelbase", "0 must be more than 0"),
        ("wheelbase", 2800, "wheelbase", "2800 must be at most 100"),
        ("wheelbase", float("nan"), "wheelbase", "finite"),
        ("wheelbase", 10**400, "wheelbase", "100000"),
        ("wheel_base", 2.8, "wheel_base", "is not a known key"),
        ("model", "hovercraft", "model", "single_track"),
        ("name", ["van"], "name", "a list of 1"),
        ("limits", None, "limits", "must be an object with keys, but is nothing (null)"),
        ("limits.steering", 40, "limits.steering", "40 deg = 0.6981 rad"),
        ("limits.steering", float("nan"), "limits.steering", "finite"),
        ("limits.steering_rate", 30, "limits.steering_rate", "30 deg = 0.5236 rad"),
        ("limits.speed", [-1], "limits.speed[1]", "is missing"),
        ("limits.speed", [2, -1], "limits.speed", "below 0"),
        ("limits.acceleration", [-1, float("inf")], "limits.acceleration[1]", "finite"),
        ("limits.jerk", 1, "limits.jerk", "is not a known key"),
        ("body", 3, "body", "must be an object with keys, but is 3"),
        ("body", [], "body", "at least 1"),
        ("body.width", -2, "body.width", "-2 must be at least 0.01"),
        ("body.width", 1e-20, "body.width", "at least 0.01"),
        ("body.height", 2, "body.height", "is not a known key"),
        ("body.length", GONE, "body.length", "is missing"),
        ("body.rear_overhang", -1, "body.rear_overhang", "at least 0"),
        ("body", [{"vertices": [[0, 0], [1, 0]]}], "body[0].vertices", "at least 3"),
        ("body", [{"vertices": [[0, 0], [1, 0], [2, 0]]}], "body[0].vertices", "zero area"),
        ("body", [{"vertices": TRIANGLE}, {"vertices": TRIANGLE}], "body[1].name", "names must differ"),
        (
            "body",
            [{"name": "a", "vertices": TRIANGLE}, {"points": TRIANGLE}],
            "body[1].vertices",
            "is missing",
        ),
        ("body", [{"vertices": [[0, 0], [1, 0, 0], [1, 1]]}], "body[0].vertices[1]", "at most 2"),
        ("body", [{"vertices": [[0, 0], [1, float("nan")], [1, 1]]}], "body[0].vertices[1][1]", "finite"),
        ("body", [{"vertices": [[0, 0], [1, 1], [1, 0], [0, 1]]}], "body[0].vertices", "cross"),
        ("body", [{"vertices": [[0, 0], [1e20, 0], [0, 1e20]]}], "body[0].vertices[1]", "at most"),
    ],
)
def test_each_mistake_gets_its_path_and_sentence(path, value, where, words):
    with pytest.raises(VehicleError) as error:
        from_dict(changed(path, value))
    found = [problem for problem in error.value.problems if problem.path == where]
    assert found, [str(problem) for problem in error.value.problems]
    assert words in found[0].message
    assert "\n" not in found[0].message
    assert len(found[0].message) < 200
    assert "Spec" not in str(error.value), "words of the program's inside have no place in a message"


def test_several_mistakes_are_reported_at_once():
    data = changed("wheelbase", -1) | {"colour": "red"}
    data["limits"]["steering"] = "much"
    with pytest.raises(VehicleError) as error:
        from_dict(data)
    assert {problem.path for problem in error.value.problems} == {"wheelbase", "colour", "limits.steering"}


@pytest.mark.parametrize("data", [{}, [], None, 3, "car", {1: 2}, [CAR]])
def test_what_is_no_vehicle_at_all_is_refused(data):
    with pytest.raises(VehicleError):
        from_dict(data)


@pytest.mark.parametrize(
    ("suffix", "dump"), [(".json", json.dumps), (".yaml", yaml.safe_dump), (".yml", yaml.safe_dump)]
)
def test_files_are_loaded_by_their_suffix(tmp_path, suffix, dump):
    path = tmp_path / f"van{suffix}"
    path.write_text(dump(CAR))
    assert load_vehicle(path).to_dict() == from_dict(CAR).to_dict()
    assert load_vehicle(str(path)).to_dict() == from_dict(CAR).to_dict()


def test_a_catalogue_name_wins_over_files():
    assert load_vehicle("tpcap").name == "tpcap"


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"{wheelbase: [1, 2", "not readable"),
        (b"\xff\xfe\x00", "not UTF-8"),
        (b"date: 2020-13-45", "not readable"),
        (b"[" * 1000, "levels deep"),
        (b"", "holds no object"),
        (b"- 1\n- 2\n", "holds no object"),
        (b"#" * 200_001, "larger than"),
    ],
)
def test_unreadable_files_are_refused_in_one_sentence(tmp_path, content, words):
    path = tmp_path / "car.yaml"
    path.write_bytes(content)
    with pytest.raises(VehicleError, match=words) as error:
        load_vehicle(path)
    assert len(error.value.problems) == 1


@pytest.mark.parametrize("name", ["missing.yaml", "directory.yaml", "nul\0byte.yaml"])
def test_files_that_cannot_be_opened_are_refused(tmp_path, name):
    (tmp_path / "directory.yaml").mkdir()
    with pytest.raises(VehicleError):
        load_vehicle(tmp_path / name)


def test_an_object_with_python_tags_is_not_executed(tmp_path):
    path = tmp_path / "car.yaml"
    path.write_text("!!python/object/apply:os.system ['true']")
    with pytest.raises(VehicleError, match="not readable"):
        load_vehicle(path)


def test_the_schema_describes_both_kinds_of_body():
    schema = json.dumps(VehicleSpec.model_json_schema())
    for word in ("rear_overhang", "vertices", "steering_rate", "additionalProperties"):
        assert word in schema
