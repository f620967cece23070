"""CommonRoad scenarios written: given back bit for bit, by CommonRoad's schema and reader, and edited by others."""

from __future__ import annotations

import datetime
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from tightspot.errors import InputError
from tightspot.scenarios import Obstacle, Scenario, builtin, load, names
from tightspot.scenarios.readers.commonroad import read_commonroad, write_commonroad
from tightspot.scenarios.readers.commonroad.origin import Origin, benchmark_id

from .commonroad_text import scenario as foreign

EXAMPLES = Path(__file__).parents[2] / "examples"
RING = [(0.0, 3.0), (8.0, 3.0), (8.0, 9.0), (0.0, 9.0)]
HOLES = ([(1.0, 4.0), (3.0, 4.0), (3.0, 8.0)], [(5.0, 5.0), (7.0, 5.0), (7.0, 7.1), (5.0, 7.0)])


def given_back(scene: Scenario, path: Path, **options: Any) -> bool:
    write_commonroad(scene, path, **options)
    return read_commonroad(path).to_dict() == scene.to_dict()


def odd(scene: dict[str, Any]) -> Scenario:
    """A scene with everything that CommonRoad cannot hold."""
    hexagon = [[-10, -10], [20, -10], [25, 0], [20, 10], [-10, 10], [-12.5, 0.1]]
    scene |= {
        "name": 'odd -- "scene" <&> ü --',
        "description": "two\nlines --",
        "source": "--> somewhere",
        "margin": 0.07,
    }
    scene |= {"workspace": hexagon[:5], "tolerance": {"position": 0.3, "heading": 0.2, "speed": 0.1, "steering": 0.5}}
    scene["start"] |= {"theta": 7.0, "v": None, "delta": 0.1}
    scene["goal"] |= {"v": -0.5, "delta": None}
    closed = [[x, y - 12.0] for x, y in (RING[0], RING[1], RING[1], *RING[2:], RING[0])]
    scene["obstacles"] = [
        {
            "name": "ring -- 1",
            "vertices": [list(p) for p in RING],
            "holes": [[list(p) for p in hole] for hole in HOLES],
        },
        {"name": "closed and repeated", "vertices": closed},
        *scene["obstacles"],
    ]
    return Scenario.from_dict(scene)


@pytest.mark.parametrize("reference", ["centre", "rear-axle"])
@pytest.mark.parametrize("name", names())
def test_built_in_scenes_come_back_bit_for_bit(name, reference, tmp_path):
    assert given_back(builtin(name), tmp_path / "x.xml", reference=reference)


@pytest.mark.parametrize("file", sorted(EXAMPLES.glob("*.yaml")), ids=lambda path: path.stem)
def test_the_examples_come_back_bit_for_bit(file, tmp_path):
    assert given_back(load(file), tmp_path / "x.xml")


def test_the_competition_s_scenes_come_back_bit_for_bit(tpcap, tmp_path):
    files = sorted(tpcap.glob("*.csv"))
    assert len(files) == 9
    for file in files:
        assert given_back(load(file), tmp_path / f"{file.stem}.xml"), file.name


def test_what_commonroad_cannot_hold_comes_back_too(scene, tmp_path):
    assert given_back(odd(scene), tmp_path / "x.xml")


def test_a_workspace_that_is_not_convex_comes_back(scene, tmp_path):
    corners = [[-10, -10], [20, -10], [20, 3], [9, 3], [9, 9], [-10, 9]]
    for workspace in (corners, {"vertices": corners, "holes": [[[12, -9], [14, -9], [13, -7]]]}):
        there = Scenario.from_dict(scene | {"workspace": workspace, "obstacles": []})
        write_commonroad(there, tmp_path / "x.xml")
        text = (tmp_path / "x.xml").read_text()
        back = read_commonroad(tmp_path / "x.xml")
        assert back.to_dict() == there.to_dict()
        (tmp_path / "x.xml").write_text(re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL))
        walls = read_commonroad(tmp_path / "x.xml", vehicle="paper")
        assert walls.boundary is None
        assert covered(walls).symmetric_difference(covered(there)).area < 1e-9


def test_a_scene_far_away_comes_back_bit_for_bit(scene, tmp_path):
    for part in (*scene["obstacles"][0]["vertices"], *scene["obstacles"][1]["vertices"]):
        part[0] += 4484378812.7
        part[1] += -354286011.3
    for end in ("start", "goal"):
        scene[end]["x"] += 4484378812.7
        scene[end]["y"] += -354286011.3
    del scene["workspace"]
    assert given_back(Scenario.from_dict(scene), tmp_path / "x.xml")


def test_a_second_writing_gives_the_same_bytes(scene, tmp_path):
    first, second = tmp_path / "a.xml", tmp_path / "b.xml"
    day = datetime.date(2020, 1, 7)
    write_commonroad(odd(scene), first, date=day)
    write_commonroad(read_commonroad(first), second, date=day)
    assert first.read_bytes() == second.read_bytes()


def test_a_foreign_scenario_keeps_its_id_problem_and_time_step(tmp_path):
    theirs, ours = tmp_path / "theirs.xml", tmp_path / "ours.xml"
    theirs.write_text(foreign(dt="0.04"))
    scene = read_commonroad(theirs)
    assert Origin.of(scene.source, scene.name) == Origin("DEU_Test-1_1_T-1", 5, 0.04)
    assert given_back(scene, ours)
    text = ours.read_text()
    assert 'benchmarkID="DEU_Test-1_1_T-1"' in text
    assert '<planningProblem id="5">' in text
    assert 'timeStepSize="0.04"' in text


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("vertical", "ZAM_Vertical-1_1"),
        ("my garage, 2nd floor", "ZAM_MyGarage2ndFloor-1_1"),
        ("DEU_Muc-28_1_T-1", "DEU_Muc-28_1_T-1"),
        ("日本", "ZAM_Scene-1_1"),
    ],
)
def test_names_become_benchmark_ids(name, expected):
    assert benchmark_id(name) == expected


def test_without_the_comment_the_scene_is_still_the_same_to_a_micrometre(scene, tmp_path):
    path = tmp_path / "x.xml"
    there = odd(scene)
    write_commonroad(there, path)
    path.write_text(re.sub(r"<!--.*?-->", "", path.read_text(), flags=re.DOTALL))
    back = read_commonroad(path, vehicle="paper")
    assert np.abs(back.start[:2] - there.start[:2]).max() < 1e-6
    assert np.abs(back.goal[:2] - there.goal[:2]).max() < 1e-6
    assert 0.1 < back.tolerance.position <= there.tolerance.position + 1e-9
    assert covered(back).symmetric_difference(covered(there)).area < 1e-9


def covered(scene: Scenario) -> shapely.Geometry:
    return shapely.union_all([part.to_shapely() for _, part in scene.obstacle_parts])


def moved(text: str, element: str) -> str:
    """The text with the first number inside the element changed."""
    where = text.index(f"<{element}")
    found = re.compile(r"<x>(.*?)</x>").search(text, where)
    assert found
    return f"{text[: found.start(1)]}{float(found[1]) + 0.125!r}{text[found.end(1) :]}"


@pytest.mark.parametrize(
    "element", ["initialState>\n      <position>\n        <point>", "goalState", "staticObstacle", "lanelet"]
)
def test_the_comment_never_overrules_an_edited_file(element, scene, tmp_path):
    path = tmp_path / "x.xml"
    there = odd(scene)
    write_commonroad(there, path)
    text = path.read_text()
    cut = text.index("<planningProblem") if element.startswith("initial") else 0
    path.write_text(text[:cut] + moved(text[cut:], element.split(">")[0]))
    back = read_commonroad(path)
    assert (back.name, back.margin, back.vehicle) == (there.name, 0.07, there.vehicle), (
        "what CommonRoad cannot hold stays"
    )
    if element.startswith("initial"):
        assert back.start[0] - there.start[0] == pytest.approx(0.125)
    if element == "goalState":
        assert back.goal[0] - there.goal[0] == pytest.approx(0.125)
    if element == "staticObstacle":
        assert len(back.obstacles) > len(there.obstacles), "the ring is now its convex parts"
        assert 0 < covered(back).symmetric_difference(covered(there)).area < 2
    if element == "lanelet":
        assert not back.workspace.to_shapely().equals(there.workspace.to_shapely())
    other = {"initialState": "start", "goalState": "goal"}.get(element.split(">")[0])
    for end in {"start", "goal"} - {other}:
        assert np.array_equal(getattr(back, end), getattr(there, end), equal_nan=True)


def test_another_vehicle_reads_the_same_centre(scene, tmp_path):
    path = tmp_path / "x.xml"
    there = Scenario.from_dict(scene)
    write_commonroad(there, path)
    back = read_commonroad(path, vehicle="commonroad-truck")
    assert back.vehicle == "commonroad-truck"
    assert np.hypot(*(back.start - there.start)[:2]) == pytest.approx(abs(1.8 - (4.628 / 2 - 0.929)))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"reference": "bumper"}, "reference: 'bumper' is not known"),
        ({"obstacle_type": "house"}, "must be one of unknown, parkedVehicle"),
        ({"dt": 0.0}, "dt: 0.0 s must be a time above 0"),
        ({"dt": float("nan")}, "dt: nan s must be a time above 0"),
    ],
)
def test_impossible_arguments_leave_no_file(options, words, scene, tmp_path):
    with pytest.raises(InputError, match=words):
        write_commonroad(Scenario.from_dict(scene), tmp_path / "x.xml", **options)
    assert list(tmp_path.iterdir()) == []


ORACLE = """
import json, sys, warnings
warnings.simplefilter("ignore")
from pathlib import Path
import commonroad, lxml.etree as etree
from commonroad.common.file_reader import CommonRoadFileReader
(xsd,) = Path(commonroad.__file__).parent.rglob("XML_commonRoad_XSD.xsd")
schema = etree.XMLSchema(etree.parse(str(xsd)))
facts = []
for name in sys.argv[1:]:
    problems = [] if schema.validate(etree.parse(name)) else [str(entry) for entry in schema.error_log]
    scenario, problem_set = CommonRoadFileReader(name).open()
    (problem,) = problem_set.planning_problem_dict.values()
    (goal,) = problem.goal.state_list
    (road,) = scenario.lanelet_network.lanelets
    facts.append({
        "schema": problems,
        "id": str(scenario.scenario_id),
        "dt": scenario.dt,
        "obstacles": [o.occupancy_at_time(0).shape.vertices.tolist() for o in scenario.static_obstacles],
        "start": [*problem.initial_state.position.tolist(), problem.initial_state.orientation],
        "goal": [*goal.position.center.tolist(), goal.position.radius],
        "headings": [goal.orientation.start, goal.orientation.end],
        "road": road.polygon.vertices.tolist(),
    })
print(json.dumps(facts))
"""


@pytest.fixture(scope="module")
def theirs(tmp_path_factory) -> list[tuple[Scenario, dict[str, Any]]]:
    """Scenes, and what CommonRoad's own schema and reader find in the files made of them."""
    pytest.importorskip("lxml", reason="needs commonroad-io")
    if subprocess.run([sys.executable, "-W", "ignore", "-c", "import commonroad"], check=False).returncode:
        pytest.skip("needs commonroad-io")
    directory = tmp_path_factory.mktemp("theirs")
    ring = Obstacle("ring", RING, HOLES)
    scenes = [*(builtin(name) for name in names()), load(EXAMPLES / "courtyard.yaml")]
    garage = builtin("garage")
    scenes.append(garage.with_(name="with a hole", obstacles=(ring,)))
    corners = [[-30, -20], [30, -20], [30, 3], [9, 3], [9, 20], [-30, 20]]
    scenes.append(Scenario.from_dict(garage.to_dict() | {"name": "not convex", "workspace": corners}))
    files = [directory / f"{index}.xml" for index in range(len(scenes))]
    for scene, file in zip(scenes, files, strict=True):
        write_commonroad(scene, file, reference="rear-axle")
    command = [sys.executable, "-W", "ignore", "-c", ORACLE, *map(str, files)]
    done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return list(zip(scenes, json.loads(done.stdout), strict=True))


def test_commonroad_s_schema_has_no_complaint(theirs):
    for scene, facts in theirs:
        assert facts["schema"] == [], scene.name


def test_commonroad_s_reader_sees_the_same_scene(theirs):
    for scene, facts in theirs:
        assert facts["id"] == benchmark_id(scene.name)
        assert facts["dt"] == 0.1
        assert facts["start"][:2] == scene.start[:2].tolist()
        assert facts["start"][2] == pytest.approx(scene.start[2])
        assert facts["goal"][:2] == scene.goal[:2].tolist()
        assert facts["goal"][2] == scene.tolerance.position
        assert np.mean(facts["headings"]) == pytest.approx(scene.goal[2])
        road = shapely.Polygon(facts["road"])
        assert road.symmetric_difference(scene.workspace.to_shapely()).area < 1e-9
        blocked = shapely.union_all([shapely.Polygon(ring) for ring in facts["obstacles"]])
        assert blocked.symmetric_difference(covered(scene)).area < 1e-9, scene.name
