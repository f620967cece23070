"""CommonRoad files on the command line: converted with their own options, refused with remedies that exist."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml

from tightspot.scenarios import builtin, load
from tightspot.scenarios.readers.commonroad import write_commonroad

MOVER = """<dynamicObstacle id="77"><type>car</type>
<shape><rectangle><length>4</length><width>2</width></rectangle></shape>
<initialState><position><point><x>40</x><y>40</y></point></position><orientation><exact>0</exact></orientation>
<time><exact>0</exact></time></initialState>
<occupancySet><occupancy><shape><circle><radius>1</radius></circle></shape><time><exact>1</exact></time></occupancy>
</occupancySet></dynamicObstacle>"""


@pytest.fixture
def traffic(tmp_path):
    """The built-in garage with a car that moves somewhere else."""
    path = tmp_path / "traffic.xml"
    write_commonroad(builtin("garage"), path)
    text = path.read_text()
    path.write_text(text.replace("<planningProblem", f"{MOVER}<planningProblem", 1))
    return path


def test_a_scene_becomes_commonroad_and_comes_back(cli):
    assert cli("convert", "garage", "garage.xml").code == 0
    assert cli("convert", "garage.xml", "garage.yaml").code == 0
    assert load("garage.yaml").to_dict() == builtin("garage").to_dict()


@pytest.mark.parametrize("command", [["plan"], ["convert"]])
def test_what_moves_is_refused_with_a_command_that_helps(command, cli, traffic):
    result = cli(*command, traffic, *(["out.yaml"] if command == ["convert"] else []))
    assert result.code == 2
    assert "1 obstacle is (77) moving" in result.err
    assert re.search(r"tightspot convert IN OUT --moving initial", result.err)
    done = cli("convert", traffic, "out.yaml", "--moving", "initial")
    assert done.code == 0, done.err
    assert [obstacle.name for obstacle in load("out.yaml").obstacles][-1] == "car-77"
    assert cli("convert", traffic, "out.yaml", "--moving", "ignore").code == 0
    assert len(load("out.yaml").obstacles) == len(builtin("garage").obstacles)


def test_reference_and_problem_are_options_of_their_own(cli, traffic):
    cli("convert", traffic, "rear.yaml", "--moving", "ignore", "--reference", "rear-axle", "--problem", "2")
    rear, centre = load("rear.yaml").start, builtin("garage").start
    assert abs(rear[:2] - centre[:2]).max() > 0.5
    assert "there are 2" in cli("convert", traffic, "x.yaml", "--problem", "3").err


def test_they_are_refused_for_other_formats(cli):
    result = cli("convert", "garage", "out.yaml", "--lanelets", "boundary")
    assert result.code == 2
    assert "--lanelets: garage is no CommonRoad file" in result.err


def test_a_scene_far_away_may_be_written_near_the_origin(cli):
    far = builtin("garage").to_dict()
    far["workspace"] = [[x + 4.5e9, y - 3e8] for x, y in far["workspace"]]
    for obstacle in far["obstacles"]:
        obstacle["vertices"] = [[x + 4.5e9, y - 3e8] for x, y in obstacle["vertices"]]
    for end in ("start", "goal"):
        far[end] |= {"x": far[end]["x"] + 4.5e9, "y": far[end]["y"] - 3e8}
    Path("far.yaml").write_text(yaml.safe_dump(far))
    assert cli("convert", "far.yaml", "far.xml").code == 0
    assert cli("convert", "far.yaml", "near.xml", "--recentred").code == 0
    assert abs(load("far.xml").offset).max() > 4e9
    assert abs(load("near.xml").workspace.vertices).max() < 200
    assert not load("near.xml").offset.any()
