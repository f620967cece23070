"""The competition's CSV files: separators, lengths, obstacles without area, and all nine files we have."""

from __future__ import annotations

import numpy as np
import pytest
from shapely import LineString, Point, Polygon
from shapely.ops import unary_union

from tightspot.errors import InputError
from tightspot.scenarios import Scenario, check, clearance, load, workspace_excess

GOOD = "0,0,0.1,9,1,-0.2,2,4,3,3,3,5,3,5,5,3,5,3,-5,6,-5,6,-3"
CASES = (1, 2, 3, 5, 9, 10, 13, 16, 18)


@pytest.fixture
def read(tmp_path):
    def read(text: str | bytes) -> Scenario:
        path = tmp_path / "Case0.csv"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return load(path)

    return read


def with_obstacle(*points: tuple[float, float], origin: tuple[float, float] = (0, 0)) -> str:
    x, y = origin
    shifted = [f"{x + p:.17g},{y + q:.17g}" for p, q in points]
    return f"{x:.17g},{y:.17g},0,{x + 9:.17g},{y:.17g},0,1,{len(points)},{','.join(shifted)}"


def test_what_the_format_leaves_open_is_set(read):
    scenario = read(GOOD)
    assert (scenario.name, scenario.vehicle, scenario.margin) == ("Case0", "tpcap", 0.02)
    assert scenario.start.tolist() == [0, 0, 0.1, 0, 0]
    assert scenario.goal.tolist() == [9, 1, -0.2, 0, 0]
    assert [len(o.exterior) for o in scenario.obstacles] == [4, 3]
    assert scenario.workspace.vertices.min(axis=0).tolist() == [-15, -15]
    assert scenario.workspace.vertices.max(axis=0).tolist() == [24, 16]


@pytest.mark.parametrize(
    "text",
    [
        GOOD.replace(",", "\n"),
        GOOD.replace(",", "\r\n"),
        GOOD.replace(",", ";"),
        GOOD.replace(",", " , "),
        GOOD.replace(",", "\t"),
        "\ufeff" + GOOD,
        GOOD + ",,,\n\n",
        GOOD.replace(",2,", ",2\n", 1),
        GOOD.replace(",4,3,", ",4.0,3e0,", 1),
    ],
)
def test_any_usual_layout_is_read_alike(read, text):
    assert read(text).to_dict() == read(GOOD).to_dict()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("1,2,3", "holds 3 numbers where at least 7 were expected"),
        (GOOD.rsplit(",", 3)[0], "holds 20 numbers where 23 (2 obstacles of 7 vertices) were expected"),
        (GOOD + ",7", "holds 24 numbers where 23"),
        ("0,0,0,9,0,0,3,4", "holds 8 numbers where at least 10 (3 obstacles)"),
        ("0,0,0,9,0,0,1.5,4", "1.5 is not a number of obstacles"),
        ("0,0,0,9,0,0,-1", "-1 is not a number of obstacles"),
        ("0,0,0,9,0,0,1e300", "1e+300 is not a number of obstacles"),
        ("0,0,0,9,0,0,1,0", "0 is not a number of vertices"),
        ("0,0,0,9,0,0,1,3.5,1", "3.5 is not a number of vertices (value 8)"),
        ("0,0,0,9,0,0,1,1e9,1", "at most 50000 are read"),
        (GOOD.replace("0.1", "nan"), "'nan' in line 1 is not a finite number"),
        (GOOD.replace("0.1", "1e999"), "'1e999' in line 1 is not"),
        ("t,x,y\n0,0,0", "'t' in line 1 is not a finite number"),
        (GOOD.replace(",0.1,", ",,"), "nothing between two separators"),
        (GOOD.replace("0.1", "1_0"), "is not a finite number"),
        (b"\xff\xfe0", "not UTF-8"),
        (b"1," * 4_000_000, "holds more numbers than a scene of 50000 vertices"),
        (b"a\n" * 4_000_000, "and more problems"),
    ],
)
def test_files_of_the_wrong_length_or_kind_are_refused(read, problems, text, words):
    assert words in " | ".join(problems(lambda: read(text)).values())


def test_all_bad_tokens_are_told_with_their_lines(read, problems):
    found = problems(lambda: read("0\na\n0\n9,b,0\n0"))
    assert set(found) == {"value 2", "value 5"}
    assert "line 4" in found["value 5"]


def test_a_scene_without_obstacles_is_one(read):
    assert read("0,0,0,9,0,0,0").obstacles == ()


def test_a_boundary_that_crosses_itself_is_refused_with_its_obstacle(read, problems):
    text = with_obstacle((3, 3), (4, 4), (4, 3), (3, 4))
    assert "crosses" in problems(lambda: read(text))["obstacles[0].vertices"]


@pytest.mark.parametrize("origin", [(0, 0), (4484378811, -354286007)])
@pytest.mark.parametrize(
    "points",
    [
        [(3, 4)],
        [(3, 4), (3, 4), (3, 4)],
        [(3, 4), (6, 5)],
        [(3, 4), (6, 5), (3, 4), (6, 5)],
        [(3, 4), (4.5, 4.5), (6, 5), (3.3, 4.1)],
        [(3, 4), (3, 4.0000001), (6, 4)],
    ],
    ids=["point", "repeated point", "segment", "there and back", "collinear", "sliver"],
)
def test_obstacles_without_area_are_thickened_not_dropped(read, points, origin):
    scenario = read(with_obstacle(*points, origin=origin))
    assert len(scenario.obstacles) == 1
    drawn = np.array(points) + origin - scenario.offset
    spine = LineString(drawn) if len(np.unique(drawn, axis=0)) > 1 else Point(drawn[0])
    cover = unary_union([part.to_shapely() for part in scenario.obstacles[0].parts])
    assert cover.buffer(2e-6).covers(spine)
    assert cover.hausdorff_distance(spine) < 0.001
    width = sorted(np.hypot(*np.diff(cover.minimum_rotated_rectangle.exterior.coords, axis=0).T))[0]
    assert width == pytest.approx(0.001, abs=2e-6)


def test_thin_but_real_obstacles_stay_as_they_are(read):
    ring = [(3, 4), (6, 4), (6, 4.002), (3, 4.002)]
    assert read(with_obstacle(*ring)).obstacles[0].exterior == pytest.approx(np.array(ring))


def test_headings_are_wrapped(read):
    scenario = read("0,0,7.0,9,1,-6.2,0")
    assert scenario.start[2] == pytest.approx(7.0 - 2 * np.pi)
    assert scenario.goal[2] == pytest.approx(2 * np.pi - 6.2)


@pytest.mark.parametrize("case", CASES)
def test_every_file_of_the_competition_is_a_scene_that_its_car_can_take(tpcap, case):
    path = tpcap / f"Case{case}.csv"
    scenario = load(path)
    model = scenario.vehicle_model()
    check(scenario, model, scenario.margin)
    for state in (scenario.start, scenario.goal):
        assert clearance(scenario, model, state).value > 0.2
        assert workspace_excess(scenario, model, state)[0] < -5
        assert abs(state[2]) <= np.pi
    values = np.array(path.read_text().replace(",", " ").split(), dtype=float)
    assert len(scenario.obstacles) == values[6]
    counts = values[7 : 7 + len(scenario.obstacles)].astype(int)
    rings = np.split(values[7 + len(counts) :].reshape(-1, 2), np.cumsum(counts)[:-1])
    for obstacle, ring in zip(scenario.obstacles, rings, strict=True):
        local = Polygon(ring - scenario.offset)
        cover = unary_union([part.to_shapely() for part in obstacle.parts])
        assert cover.symmetric_difference(local).area < 1e-9 * max(1, local.area)


@pytest.mark.parametrize("case", CASES)
def test_the_competitions_scenes_make_the_round_trip(tpcap, case):
    data = load(tpcap / f"Case{case}.csv").to_dict()
    assert Scenario.from_dict(data).to_dict() == data


def test_coordinates_near_five_billion_metres_are_recentred(tpcap):
    scenario = load(tpcap / "Case13.csv")
    assert scenario.offset.tolist() == [4484378811, -354286007]
    assert np.abs(scenario.start[:2]).max() <= 0.5
    assert max(np.abs(o.exterior).max() for o in scenario.obstacles) < 30


def test_numbers_may_be_in_quotes(tmp_path):
    numbers = [str(number) for number in (0, 0, 0, 9, 1, 0, 1, 3, 4, 4, 6, 4, 6, 6)]
    plain, quoted, odd = (tmp_path / name for name in ("plain.csv", "quoted.csv", "odd.csv"))
    plain.write_text(",".join(numbers))
    quoted.write_text(",".join(f'"{number}"' for number in numbers))
    odd.write_text('"' + ",".join(numbers))
    assert load(quoted).to_dict()["obstacles"] == load(plain).to_dict()["obstacles"]
    with pytest.raises(InputError, match="value 1"):
        load(odd)
