"""Occupancy maps: ROS's rules, where cells lie, that every occupied one is covered, and every way to be no map."""

from __future__ import annotations

import struct
import sys
import time
import zlib

import numpy as np
import pytest
import shapely
import yaml
from examples.garage_map import FREE, OCCUPIED, UNKNOWN, garage

from tightspot.errors import SceneError
from tightspot.scenarios import check, load
from tightspot.scenarios.readers.occupancy.outlines import count_sides, outlines

START, GOAL = (1.0, 1.0, 0.0), (3.0, 3.0, 0.0)
KEYS = {"image": "map.pgm", "resolution": 0.5, "origin": [0, 0, 0]}


def pgm(cells, largest=255, comment=b""):
    cells = np.asarray(cells)
    kind = np.uint8 if largest < 256 else ">u2"
    return b"P5\n%s%d %d\n%d\n" % (comment, *cells.shape[::-1], largest) + cells.astype(kind).tobytes()


@pytest.fixture
def read(tmp_path):
    def read(cells, keys=(), picture="map.pgm", start=START, goal=GOAL, **given):
        content = cells if isinstance(cells, bytes) else pgm(cells)
        (tmp_path / picture).write_bytes(content)
        (tmp_path / "map.yaml").write_text(yaml.safe_dump({**KEYS, "image": picture, **dict(keys)}))
        return load(tmp_path / "map.yaml", start=start, goal=goal, **given)

    return read


def covered(scenario):
    """Everything that is an obstacle, in the file's coordinates."""
    union = shapely.union_all([part.to_shapely() for _, part in scenario.obstacle_parts])
    return shapely.transform(union, lambda points: points + scenario.offset)


def blank(rows=12, columns=20):
    return np.full((rows, columns), FREE)


@pytest.mark.parametrize(
    ("turned", "origin"),
    [(0.0, (0.0, 0.0, 0.0)), (0.0, (-12.3, 4.5, 0.7)), (0.35, (0.0, 0.0, 0.0)), (0.2, (500_000.25, 5.5e6, -2.1))],
)
def test_every_occupied_cell_of_a_garage_is_covered_and_little_else(tmp_path, turned, origin):
    made = garage(turned=turned, origin=origin)
    scenario = load(made.write(tmp_path), start=made.start, goal=made.goal, vehicle="tpcap", margin=0.02)
    solid = covered(scenario)
    occupied = shapely.polygons(made.corners(*np.nonzero(made.occupied)))
    shapely.prepare(solid)
    assert shapely.covers(solid, occupied).all()
    free = made.corners(*np.nonzero(~made.occupied)).mean(axis=1)
    tree = shapely.STRtree(occupied)
    nearest = tree.query_nearest(shapely.points(free), return_distance=True, all_matches=False)[1]
    clear = nearest > 0.1 + 0.5 * np.sqrt(2) * made.resolution
    assert not shapely.contains_xy(solid, *free[clear].T).any()
    assert len(scenario.obstacle_parts) < 600
    check(scenario, scenario.vehicle_model(), scenario.margin)


def test_the_workspace_is_the_map_turned_with_it(tmp_path):
    made = garage(origin=(-3.0, 2.0, 0.7), noise=False)
    W = load(made.write(tmp_path), start=made.start, goal=made.goal).workspace
    np.testing.assert_allclose(W.vertices[0], [-3, 2], atol=1e-9)
    np.testing.assert_allclose(W.vertices[1] - W.vertices[0], 40 * np.array([np.cos(0.7), np.sin(0.7)]), atol=1e-9)
    assert W.area == pytest.approx(40 * 30)


def test_the_first_row_is_on_top(read):
    cells = blank()
    cells[0, 19] = OCCUPIED
    assert covered(read(cells)).equals_exact(shapely.box(9.5, 5.5, 10, 6), tolerance=1e-5, normalize=True)


@pytest.mark.parametrize(
    ("shade", "keys", "occupied", "free"),
    [
        (0, {}, True, False),
        (254, {}, False, True),
        (205, {}, False, False),  # 50/255 = 0.196 is not below 0.196
        (206, {}, False, True),
        (89, {}, True, False),  # 166/255 = 0.651
        (90, {}, False, False),
        (0, {"negate": 1}, False, True),
        (255, {"negate": True}, True, False),
        (204, {"occupied_thresh": 0.2, "free_thresh": 0.1}, False, False),  # 51/255 is 0.2, which is not above it
        (128, {"mode": "scale"}, False, False),
        (100, {"mode": "raw"}, True, False),
        (0, {"mode": "raw"}, False, True),
        (50, {"mode": "raw"}, False, False),
        (255, {"mode": "raw"}, False, False),
    ],
)
def test_thresholds_are_those_of_ros(read, shade, keys, occupied, free):
    cells = np.full((12, 20), shade)
    for policy, in_the_way in (("occupied", not free), ("free", occupied)):
        scenario = read(cells, keys, unknown=policy)
        assert bool(scenario.obstacles) == in_the_way


def test_unknown_cells_are_occupied_unless_told_otherwise(read):
    cells = blank()
    cells[5, 5] = UNKNOWN
    assert len(read(cells).obstacles) == 1
    assert read(cells, {"tightspot": {"unknown": "free"}}).obstacles == ()
    assert len(read(cells, {"tightspot": {"unknown": "free"}}, unknown="occupied").obstacles) == 1
    with pytest.raises(SceneError, match="'maybe' must be occupied or free"):
        read(cells, unknown="maybe")


def test_the_section_holds_what_a_map_cannot(read):
    section = {
        "start": {"x": 1, "y": 2, "theta": 0.1},
        "goal": {"x": 5, "y": 2, "theta": 0.2, "v": None},
        "vehicle": "tpcap",
        "margin": 0.1,
        "workspace": {"x": [0, 9], "y": [0, 5]},
        "tolerance": {"position": 0.05},
        "name": "hall",
    }
    scenario = read(blank(), {"tightspot": section}, start=None, goal=None)
    assert (scenario.name, scenario.vehicle, scenario.margin) == ("hall", "tpcap", 0.1)
    assert scenario.start.tolist() == [1, 2, 0.1, 0, 0]
    assert np.isnan(scenario.goal[3])
    assert scenario.workspace.area == 45
    assert read(blank(), {"tightspot": section}, start=(2, 2, 0)).start[0] == 2


def test_simplification_can_be_turned_off_and_up(read):
    cells = blank(60, 60)
    for k in range(10, 50):
        cells[k, 10 : k + 1] = OCCUPIED
    exact = read(cells, {"tightspot": {"simplify": 0}})
    assert len(exact.obstacles[0].exterior) == 2 * 40 + 2
    assert exact.obstacles[0].polygons[0].area == pytest.approx(0.25 * (40 * 41 / 2), rel=1e-4)
    assert len(read(cells, {"tightspot": {"simplify": 0.6}}).obstacles[0].exterior) <= 6


def test_what_is_far_from_both_ends_is_left_out(read):
    cells = blank(400, 400)
    cells[::40, ::40] = OCCUPIED
    scenario = read(cells, start=(10, 10, 0), goal=(12, 12, 0))
    assert scenario.workspace.vertices.max() == 62
    assert 4 <= len(scenario.obstacles) < 20


def test_shades_of_sixteen_bits_plain_text_and_comments(read):
    cells = blank(4, 5)
    cells[0, 0] = OCCUPIED
    expected = read(cells).to_dict()["obstacles"]
    plain = "P2 # plain\n5 4 # size\n# and\n255\n" + " ".join(map(str, cells.ravel())) + "\n"
    for content in (
        plain.encode(),
        pgm(cells * 257, largest=65_535),
        pgm(cells, comment=b"# CREATOR: map_generator.cpp 0.050 m/pix\n"),
    ):
        assert read(content).to_dict()["obstacles"] == expected


def test_pictures_that_pillow_reads(read, tmp_path):
    image = pytest.importorskip("PIL.Image")
    cells = blank(6, 5)
    cells[0, 0] = OCCUPIED
    expected = read(cells).to_dict()["obstacles"]
    grey = image.fromarray(cells.astype(np.uint8))
    clear = grey.convert("RGBA")
    clear.putpixel((4, 5), (0, 0, 0, 0))
    for name, picture in {
        "map.png": grey,
        "map.bmp": grey.convert("RGB"),
        "palette.png": grey.convert("P"),
        "sixteen.png": image.fromarray((cells * 257).astype(np.uint16)),
    }.items():
        picture.save(tmp_path / name)
        assert read((tmp_path / name).read_bytes(), picture=name).to_dict()["obstacles"] == expected
    clear.save(tmp_path / "clear.png")
    content = (tmp_path / "clear.png").read_bytes()
    assert len(read(content, picture="clear.png").obstacles) == 2  # what is transparent is unknown
    assert len(read(content, picture="clear.png", unknown="free").obstacles) == 1


def test_without_pillow_pgm_is_read_and_png_explained(read, monkeypatch):
    monkeypatch.setitem(sys.modules, "PIL", None)
    assert read(blank()).obstacles == ()
    with pytest.raises(SceneError, match=r'needs Pillow: pip install "tightspot\[readers\]"'):
        read(b"\x89PNG\r\n\x1a\n", picture="map.png")


def test_a_map_without_start_says_how_to_give_one(read):
    with pytest.raises(SceneError) as caught:
        read(blank(), start=None, goal=None)
    assert [problem.path for problem in caught.value.problems] == ["start", "goal"]
    assert "--goal x,y,theta" in str(caught.value)
    assert "tightspot: {goal:" in str(caught.value)


def test_the_picture_alone_names_its_map(read, tmp_path):
    read(blank())
    with pytest.raises(SceneError, match=r"only the picture of a map; give .*map\.yaml"):
        load(tmp_path / "map.pgm", start=START, goal=GOAL)
    (tmp_path / "other.png").write_bytes(b"x")
    with pytest.raises(SceneError, match="only a picture; give the YAML file"):
        load(tmp_path / "other.png")


def png(width, height, raw, extra=b""):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + header + extra + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b"")


PICTURES = [
    (b"", "not readable as a picture"),
    (b"hello", "not readable as a picture"),
    (b"P5", "not readable as PGM"),
    (b"P5\n" + b"#" * 100_000, "not readable as PGM"),
    (b"P5\n0 5\n255\n", "has 0 x 5 cells"),
    (b"P5\n5 5\n0\n" + bytes(25), "0 as its largest value"),
    (b"P5\n5 5\n70000\n" + bytes(25), "70000 as its largest value"),
    (b"P5\n5 5\n255\n" + bytes(24), "holds 24 of 5 x 5 cells"),
    (b"P5\n5 5\n256\n" + bytes(25), "holds 12 of 5 x 5 cells"),
    (b"P5\n999999999 999999999\n255\n", "at most 16777216 are read"),
    (b"P5\n5 5\n100\n" + bytes([101] * 25), "has a value 101 above 100"),
    (b"P2\n2 2\n255\n1 2 3", "holds 3 of 2 x 2 cells"),
    (b"P2\n2 2\n255\n1 2 3 x", "a value is not a whole number"),
    (b"P2\n2 2\n255\n1 2 3 -4", "a value is not a whole number"),
    (png(100_000, 100_000, bytes(1000)), "exceeds limit"),
    (png(5000, 5000, bytes(1000)), "has 5000 x 5000 cells"),
    (png(40, 30, bytes(41 * 30))[:50], "not readable as a picture"),
    (png(4, 4, bytes(20))[:20], "not readable as a picture"),
]


@pytest.mark.parametrize(("content", "words"), PICTURES, ids=range(len(PICTURES)))
def test_pictures_that_are_none_are_refused_at_once(read, content, words, tmp_path):
    began = time.monotonic()
    with pytest.raises(SceneError) as caught:
        read(content)
    assert time.monotonic() - began < 5
    (problem,) = caught.value.problems
    assert problem.path == str(tmp_path / "map.pgm")
    assert words in problem.message
    assert "0x" not in problem.message


MISTAKES = [
    ({"resolution": 0}, "resolution", "more than"),
    ({"resolution": "a"}, "resolution", "must be a number"),
    ({"resolution": None}, "resolution", "missing"),
    ({"origin": 5}, "origin", "[x, y, yaw]"),
    ({"origin": [0, 1e300, 0]}, "origin[1]", "farther than"),
    ({"origin": [0, 0, float("nan")]}, "origin[2]", "not finite"),
    ({"negate": 2}, "negate", "0 or 1"),
    ({"negate": 1, "mode": "raw"}, "negate", "no meaning"),
    ({"mode": "blue"}, "mode", "trinary, scale or raw"),
    ({"occupied_thresh": 65}, "occupied_thresh", "less than 1"),
    ({"free_thresh": 0.7}, "free_thresh", "not below occupied_thresh"),
    ({"occupied_tresh": 0.7}, "occupied_tresh", "did you mean 'occupied_thresh'"),
    ({"image": ["a"]}, "image", "must be text"),
    ({"tightspot": 5}, "tightspot", "an object"),
    ({"tightspot": {"simplify": -1}}, "tightspot.simplify", "at least 0"),
    ({"tightspot": {"unknwon": "free"}}, "tightspot.unknwon", "did you mean 'unknown'"),
    ({"tightspot": {"obstacles": []}}, "tightspot.obstacles", "not a known key"),
    ({"tightspot": {"margin": -1}}, "margin", "at least 0"),
]


@pytest.mark.parametrize(("keys", "path", "words"), MISTAKES, ids=range(len(MISTAKES)))
def test_mistakes_in_the_map_file_are_named(read, keys, path, words):
    with pytest.raises(SceneError) as caught:
        read(blank(), keys)
    found = {problem.path: problem.message for problem in caught.value.problems}
    assert path in found
    assert words in found[path]


def test_keys_of_other_tools_are_ignored(read):
    assert read(blank(), {"map_id": 7, "type": "occupancy"}).obstacles == ()


def test_a_picture_of_noise_is_refused_with_a_count(read):
    cells = np.random.default_rng(0).integers(0, 2, (300, 400)) * 254
    with pytest.raises(SceneError, match=r"outline has \d{6} sides, at most 30000 are read"):
        read(cells, {"resolution": 0.05})


def test_outlines_are_the_union_of_the_cells():
    rng = np.random.default_rng(0)
    for density in (0.1, 0.4, 0.6, 0.9):
        mask = rng.uniform(size=(23, 31)) < density
        rows, columns = np.nonzero(mask)
        union = shapely.union_all(shapely.box(columns, rows, columns + 1, rows + 1))
        found = outlines(mask)
        assert all(polygon.is_valid for polygon in found)
        assert shapely.union_all(found).symmetric_difference(union).area == 0
        assert sum(polygon.area for polygon in found) == mask.sum()
        assert count_sides(mask) == pytest.approx(sum(polygon.length for polygon in found))


@pytest.mark.parametrize("value", [False, True])
def test_outlines_of_all_or_nothing(value):
    found = outlines(np.full((3, 4), value))
    assert [polygon.area for polygon in found] == ([12] if value else [])
