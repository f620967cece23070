"""GeoJSON: roles, headings, every kind of geometry, what is refused and how."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
import shapely

from tightspot.errors import SceneError
from tightspot.scenarios import load, save
from tightspot.scenarios.readers.features import MIN_WIDTH


def feature(geometry, **properties):
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def point(x, y, **properties):
    return feature({"type": "Point", "coordinates": [x, y]}, **properties)


def polygon(*rings, **properties):
    return feature({"type": "Polygon", "coordinates": [[*ring, ring[0]] for ring in rings]}, **properties)


def line(*points, **properties):
    return feature({"type": "LineString", "coordinates": list(points)}, **properties)


START, GOAL = point(0, 0, role="start", theta=0), point(9, 1, role="goal", theta=0.5)
SQUARE = [[4, 4], [6, 4], [6, 6], [4, 6]]
HOLE = [[4.5, 4.5], [5.5, 4.5], [5.5, 5.5]]
TWO = {"type": "MultiPolygon", "coordinates": [[[*SQUARE, SQUARE[0]]], [[[14, 4], [15, 4], [15, 5], [14, 4]]]]}


@pytest.fixture
def read(tmp_path):
    def read(*features, name="plan.geojson", given=(), **members):
        path = tmp_path / name
        path.write_text(json.dumps({"type": "FeatureCollection", "features": features, **members}))
        return load(path, **dict(given))

    return read


def test_roles_and_properties(read):
    boundary = polygon([[-9, -9], [19, -9], [19, 9], [-9, 9]], role="boundary", margin=0.1)
    goal = point(9, 1, role="goal", theta=0.5, v=0.2, delta=None)
    scenario = read(
        point(0, 0, role="Start", Heading=0.25, vehicle="tpcap"), goal, boundary, polygon(SQUARE, HOLE, name="hut")
    )
    assert scenario.start.tolist() == [0, 0, 0.25, 0, 0]
    assert scenario.goal[:4].tolist() == [9, 1, 0.5, 0.2]
    assert np.isnan(scenario.goal[4])
    assert (scenario.vehicle, scenario.margin, scenario.name) == ("tpcap", 0.1, "plan")
    assert scenario.workspace.area == 28 * 18
    (hut,) = scenario.obstacles
    assert hut.name == "hut"
    assert hut.exterior.tolist() == SQUARE
    assert [hole.tolist() for hole in hut.holes] == [HOLE]


def test_a_line_of_two_points_is_a_pose(read):
    scenario = read(line([1, 2], [0, 3], role="start"), GOAL)
    assert scenario.start[:3].tolist() == [1, 2, 3 * math.pi / 4]


def test_areas_and_lines_without_a_role_are_obstacles(read):
    scenario = read(START, GOAL, polygon(SQUARE), line([4, -4], [9, -4]))
    assert len(scenario.obstacles) == 2


@pytest.mark.parametrize(
    ("geometry", "count"),
    [
        (TWO, 2),
        ({"type": "GeometryCollection", "geometries": [polygon(SQUARE)["geometry"], TWO]}, 3),
        ({"type": "MultiLineString", "coordinates": [[[4, 4], [9, 4]], [[4, 8], [9, 8]]]}, 2),
        ({"type": "MultiPoint", "coordinates": [[4, 4], [5, 5], [6, 6]]}, 3),
    ],
)
def test_geometries_of_several_parts_are_several_obstacles(read, geometry, count):
    scenario = read(START, GOAL, feature(geometry, role="obstacle", name="thing"))
    assert [o.name for o in scenario.obstacles] == ["thing", "thing-2", "thing-3"][:count]


@pytest.mark.parametrize(("said", "width"), [({}, MIN_WIDTH), ({"width": 0.3}, 0.3), ({"width": 0}, MIN_WIDTH)])
def test_lines_are_walls_with_a_thickness(read, said, width):
    bent = [[4, 4], [9, 4], [9, 8]]
    (wall,) = read(START, GOAL, line(*bent, **said)).obstacles
    (shape,) = wall.polygons
    assert shape.covers(shapely.LineString(bent).buffer(width / 2 * 0.999, cap_style="flat"))
    assert shape.area == pytest.approx(9 * width, rel=0.1)


def test_points_are_posts_with_a_thickness(read):
    for said, radius in (({}, MIN_WIDTH / 2), ({"radius": 0.25}, 0.25), ({"width": 0.5}, 0.25)):
        (post,) = read(START, GOAL, point(4, 4, role="obstacle", **said)).obstacles
        assert post.polygons[0].covers(shapely.Point(4, 4).buffer(radius * 0.999))
        assert post.polygons[0].area < 1.1 * math.pi * radius**2


def test_a_flat_polygon_is_thickened_not_dropped(read):
    (wall,) = read(START, GOAL, polygon([[4, 4], [9, 4], [9, 4]])).obstacles
    assert wall.polygons[0].covers(shapely.LineString([(4, 4), (9, 4)]))


def test_heights_null_geometries_and_styles_are_left_out(read):
    high = feature({"type": "Point", "coordinates": [0, 0, 500]}, role="start", theta=0, stroke="#f00", id=7)
    assert read(high, GOAL, feature(None, role="obstacle")).obstacles == ()


def test_an_unclosed_ring_is_closed(read):
    open_ring = feature({"type": "Polygon", "coordinates": [SQUARE]})
    assert read(START, GOAL, open_ring).obstacles[0].exterior.tolist() == SQUARE


def test_a_bare_geometry_takes_its_ends_from_the_caller(tmp_path):
    path = tmp_path / "block.json"
    path.write_text(json.dumps(polygon(SQUARE)["geometry"]))
    scenario = load(path, start=(0, 0, 0), goal="9, 1, 0.5")
    assert len(scenario.obstacles) == 1
    assert scenario.goal[:3].tolist() == [9, 1, 0.5]


def test_a_nonconvex_boundary_with_a_pillar(read, tmp_path):
    room = [[-9, -9], [19, -9], [19, 4], [12, 4], [12, 9], [-9, 9]]
    scenario = read(START, GOAL, polygon(room, HOLE, role="boundary"))
    assert scenario.boundary is not None
    save(scenario, tmp_path / "again.geojson")
    assert load(tmp_path / "again.geojson").to_dict() == scenario.to_dict() | {"name": scenario.name}


MISTAKES = [
    ([GOAL], "start", "is missing; give --start x,y,theta"),
    ([START, START, GOAL, point(1, 1, role="start", theta=0)], "features[3]", "start is said twice"),
    ([START, GOAL, point(1, 1)], "features[2]", "a point without a role"),
    ([START, GOAL, point(1, 1, role="goall")], "features[2]", "has the role 'goall'"),
    ([START, GOAL, point(1, 1, role=5)], "features[2]", "has the role 5"),
    ([point(0, 0, role="start"), GOAL], "features[0]", "has no heading; add the property theta"),
    ([point(0, 0, role="start", theta="north"), GOAL], "features[0] (start.theta)", "must be a number"),
    ([point(0, 0, role="start", theta=90), GOAL], "features[0] (start.theta)", "looks like degrees"),
    ([polygon(SQUARE, role="start"), GOAL], "features[0]", "must be one point with theta"),
    ([line([0, 0], [1, 1], [2, 2], role="start"), GOAL], "features[0]", "a line of two different points"),
    ([line([0, 0], [0, 0], role="start"), GOAL], "features[0]", "a line of two different points"),
    ([START, GOAL, point(1, 1, role="boundary")], "features[2]", "must be one polygon"),
    ([START, GOAL, feature(TWO, role="boundary")], "features[2]", "must be one polygon"),
    ([START, GOAL, polygon([[0, 0], [1, 1], [1, 0], [0, 1]])], "features[2] (obstacles[0].vertices)", "crosses itself"),
    ([START, GOAL, line([4, 4], [9, 4], width=-1)], "features[2].width", "between 0 and 1000"),
    ([START, GOAL, polygon(SQUARE, margin=1), point(1, 1, role="obstacle", margin=2)], "features[3]", "margin is said"),
    ([START, GOAL, feature({"type": "Circle"})], "features[2].geometry", "has the type 'Circle'"),
    ([START, GOAL, feature({"type": "Polygon"})], "features[2].geometry.coordinates", "a list of rings"),
    ([START, GOAL, feature({"type": "Polygon", "coordinates": [[[1]]]})], "features[2].geometry.coordinates[0][0]",
     "must be a position [x, y]"),
    ([START, GOAL, polygon([[0, "a"], [1, 1], [1, 0]])], "features[2].geometry.coordinates[0][0]", "'a'"),
    ([START, GOAL, polygon([[0, True], [1, 1], [1, 0]])], "features[2].geometry.coordinates[0][0]", "finite numbers"),
    ([START, GOAL, polygon([[1e200, 0], [1, 1], [1, 0]])], "features[2] (obstacles[0].vertices[0])", "farther than"),
    ([START, GOAL, 5], "features[2]", "must be a feature, but is 5"),
    ([START, GOAL, {"type": "Feature", "properties": 3, "geometry": None}], "features[2].properties", "an object"),
]  # fmt: skip


@pytest.mark.parametrize(("features", "path", "words"), MISTAKES, ids=range(len(MISTAKES)))
def test_mistakes_are_named_with_their_feature(read, features, path, words):
    with pytest.raises(SceneError) as caught:
        read(*features)
    found = {problem.path: problem.message for problem in caught.value.problems}
    assert path in found
    assert words in found[path]


def test_degrees_are_told_from_metres(read):
    with pytest.raises(SceneError, match="look like degrees of longitude and latitude"):
        read(point(11.5761, 48.1371, role="start", theta=0), point(11.5763, 48.1372, role="goal", theta=0))
    for name in ("urn:ogc:def:crs:OGC:1.3:CRS84", "EPSG:4326"):
        with pytest.raises(SceneError, match="project them, for example to the UTM zone"):
            read(START, GOAL, crs={"type": "name", "properties": {"name": name}})
    projected = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}}
    assert read(START, GOAL, crs=projected).start[0] == 0


def test_our_member_is_checked(read):
    with pytest.raises(SceneError) as caught:
        read(START, GOAL, tightspot={"format": "tightspot-geojson/9", "unit": "ft", "margn": 1})
    assert {problem.path for problem in caught.value.problems} == {
        "tightspot.format",
        "tightspot.unit",
        "tightspot.margn",
    }


def test_json_without_a_type_is_a_scene_file(tmp_path):
    path = tmp_path / "scene.json"
    path.write_text('{"start": {"x": 0, "y": 0, "theta": 0}, "goal": {"x": 5, "y": 0, "theta": 0}}')
    assert load(path).goal[0] == 5
    (tmp_path / "scene.geojson").write_text("[1, 2]")
    with pytest.raises(SceneError, match="is not GeoJSON"):
        load(tmp_path / "scene.geojson")
