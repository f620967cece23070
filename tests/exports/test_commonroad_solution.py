"""CommonRoad solutions: what is in the file, what is read back, and what CommonRoad's own checkers say."""

from __future__ import annotations

import dataclasses
import datetime
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import tightspot
from tightspot.errors import InputError
from tightspot.exports import write_commonroad_solution
from tightspot.scenarios.readers.commonroad import (
    Origin,
    read_commonroad,
    read_commonroad_solution,
    write_commonroad,
)
from tightspot.vehicles import CATALOGUE, vehicle
from tightspot.vehicles.commonroad import VEHICLE_TYPES
from tightspot.verification import Plan

from ..scenarios import commonroad_text as text
from .conftest import CAR, make_plan
from .oracles import CHECKS, checked, driven

WHEN = datetime.datetime(2026, 1, 7, 12, 30, 1, 999)


@pytest.mark.parametrize("reference", ["centre", "rear-axle"])
def test_it_is_the_motion_at_multiples_of_the_step(plan: Plan, reference: Any, tmp_path: Path) -> None:
    path = tmp_path / "solution.xml"
    assert write_commonroad_solution(plan, path, reference=reference, dt=0.1) == []
    read = read_commonroad_solution(path)
    count = 1 + int(np.ceil(plan.trajectory.duration / 0.1 - 1e-9))
    assert read.trajectory.t == pytest.approx(0.1 * np.arange(count))
    times = np.minimum(read.trajectory.t, plan.trajectory.t[-1])
    assert np.abs(read.trajectory.states - driven(plan, times)).max() < 1e-6
    assert (read.vehicle.name, read.vehicle_type, read.cost, read.problem) == (CAR, 2, "JB1", 2)


def test_the_centre_is_the_middle_of_the_body(plan: Plan, tmp_path: Path) -> None:
    for reference in ("centre", "rear-axle"):
        write_commonroad_solution(plan, tmp_path / f"{reference}.xml", reference=reference)
    rear = read_commonroad_solution(tmp_path / "rear-axle.xml", reference="rear-axle").trajectory
    raw = read_commonroad_solution(tmp_path / "centre.xml", reference="rear-axle").trajectory
    theta = rear.states[:, 2]
    ahead = (raw.states - rear.states)[:, :2]
    assert np.hypot(*ahead.T) == pytest.approx(1.4227170936)
    assert ahead == pytest.approx(1.4227170936 * np.column_stack([np.cos(theta), np.sin(theta)]))


def test_a_plan_that_ends_standing_still_stands_at_the_next_step(plan: Plan, tmp_path: Path) -> None:
    write_commonroad_solution(plan, tmp_path / "s.xml", dt=0.4)
    read = read_commonroad_solution(tmp_path / "s.xml")
    assert read.trajectory.t[-1] == pytest.approx(5.6)
    assert read.trajectory.states[-1, 3] == 0.0
    assert read.trajectory.states[-1] == pytest.approx(plan.sample(plan.trajectory.t[-1]), abs=1e-9)


def test_a_plan_that_ends_moving_is_driven_slower_on_the_same_path(moving_plan: Plan, tmp_path: Path) -> None:
    notes = write_commonroad_solution(moving_plan, tmp_path / "s.xml", dt=0.25)
    assert len(notes) == 1
    assert "ends moving; it is driven 9.4 % slower" in notes[0]
    read = read_commonroad_solution(tmp_path / "s.xml").trajectory
    slower = 1.75 / 1.6
    assert read.t[-1] == pytest.approx(1.75)
    expected = driven(moving_plan, read.t / slower)
    expected[:, 3] /= slower
    assert np.abs(read.states - expected).max() < 1e-6


def test_inputs_that_are_read_lead_from_state_to_state(plan: Plan, tmp_path: Path) -> None:
    write_commonroad_solution(plan, tmp_path / "s.xml", dt=0.1)
    read = read_commonroad_solution(tmp_path / "s.xml")
    copy = dataclasses.replace(plan, trajectory=read.trajectory, scenario=plan.scenario)
    assert np.abs(copy.sample(read.trajectory.t)[:, 3:] - read.trajectory.states[:, 3:]).max() < 1e-9
    assert np.abs(copy.sample(read.trajectory.t)[:, :2] - read.trajectory.states[:, :2]).max() < 0.05


def test_the_header_names_vehicle_cost_scenario_and_version(plan: Plan, tmp_path: Path) -> None:
    write_commonroad_solution(plan, tmp_path / "s.xml", cost="SM1", date=WHEN)
    header = (tmp_path / "s.xml").read_text().splitlines()[1]
    assert 'benchmark_id="KS2:SM1:ZAM_ByHand-1_1:2020a"' in header
    assert 'date="2026-01-07T12:30:01"' in header
    assert 'computation_time="1.5"' in header


def test_a_scene_that_was_read_remembers_what_its_solution_must_name(plan: Plan, tmp_path: Path) -> None:
    theirs = plan.scenario.with_(source=str(Origin("DEU_Muc-4_2_T-1", 77, 0.04)))
    write_commonroad_solution(dataclasses.replace(plan, scenario=theirs), tmp_path / "s.xml")
    read = read_commonroad_solution(tmp_path / "s.xml")
    assert (read.scenario, read.problem) == ("DEU_Muc-4_2_T-1", 77)
    assert np.diff(read.trajectory.t) == pytest.approx(0.04)


def test_a_scenario_file_is_compared_with_the_plan(plan: Plan, tmp_path: Path) -> None:
    scenario = tmp_path / "scenario.xml"
    write_commonroad(plan.scenario, scenario, dt=0.2)
    assert write_commonroad_solution(plan, tmp_path / "s.xml", scenario_file=scenario) == []
    assert np.diff(read_commonroad_solution(tmp_path / "s.xml").trajectory.t) == pytest.approx(0.2)
    text = scenario.read_text()
    scenario.write_text(text.replace("<intervalEnd>100000<", "<intervalEnd>20<"))
    (note,) = write_commonroad_solution(plan, tmp_path / "s.xml", scenario_file=scenario)
    assert note == "the goal is reached at time step 27; the planning problem wants it between 0 and 20"
    write_commonroad(plan.scenario.with_(start=plan.scenario.start + np.array([0, 3, 0, 0, 0])), scenario)
    with pytest.raises(InputError, match="the plan 3 m from there; is it a plan of this scenario"):
        write_commonroad_solution(plan, tmp_path / "t.xml", scenario_file=scenario)
    assert not (tmp_path / "t.xml").exists()


def test_a_recentred_scenario_file_gets_a_recentred_solution(far_plan: Plan, tmp_path: Path) -> None:
    there, near = tmp_path / "there.xml", tmp_path / "near.xml"
    write_commonroad(far_plan.scenario, there)
    write_commonroad(far_plan.scenario.with_(offset=np.zeros(2)), near)
    starts = []
    for file in (there, near):
        write_commonroad_solution(far_plan, tmp_path / "s.xml", scenario_file=file)
        starts.append(read_commonroad_solution(tmp_path / "s.xml").trajectory.states[0, :2])
    assert starts[0] == pytest.approx(far_plan.sample(0.0)[:2], abs=1e-6)
    assert starts[1] == pytest.approx(far_plan.trajectory.sample(0.0)[:2], abs=1e-6)
    assert np.abs(starts[1]).max() < 100


def test_other_vehicles_need_to_say_as_which_they_shall_be_judged(tmp_path: Path) -> None:
    plan = make_plan(car="tpcap")
    with pytest.raises(InputError, match="'tpcap' is none of CommonRoad's"):
        write_commonroad_solution(plan, tmp_path / "s.xml")
    assert list(tmp_path.iterdir()) == []
    write_commonroad_solution(plan, tmp_path / "s.xml", vehicle_type=3)
    read = read_commonroad_solution(tmp_path / "s.xml")
    assert read.vehicle.name == "commonroad-vw-vanagon"
    assert read.trajectory.states[0, :2] == pytest.approx(plan.sample(0.0)[:2])


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"vehicle_type": 5}, "5 must be one of 1, 2, 3, 4"),
        ({"cost": "cheap"}, "'cheap' is not known"),
        ({"reference": "roof"}, "it is centre or rear-axle"),
        ({"dt": 0.0}, "must be a positive time"),
        ({"dt": 1e-7}, "more than 200000 states"),
        ({"scenario_file": "nowhere.xml"}, "does not exist"),
    ],
)
def test_impossible_arguments_leave_no_file(options: dict[str, Any], words: str, plan: Plan, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        write_commonroad_solution(plan, tmp_path / "s.xml", **options)
    assert list(tmp_path.iterdir()) == []


def test_the_file_s_own_step_is_needed_only_for_files_from_elsewhere(plan: Plan, tmp_path: Path) -> None:
    path = tmp_path / "s.xml"
    write_commonroad_solution(plan, path)
    path.write_text(re.sub("<!--.*?-->", "", path.read_text()))
    with pytest.raises(InputError, match="give the scenario's time step"):
        read_commonroad_solution(path)
    assert read_commonroad_solution(path, dt=0.1).trajectory.duration == pytest.approx(5.3)
    with pytest.raises(InputError, match="solves no planning problem 9"):
        read_commonroad_solution(path, dt=0.1, problem=9)


def test_the_catalogue_has_commonroad_s_vehicles() -> None:
    parameters = pytest.importorskip("vehiclemodels.vehicle_parameters")
    for number, name in VEHICLE_TYPES.items():
        car, theirs = vehicle(name), parameters.setup_vehicle_parameters(vehicle_id=number)
        corners = car.parts[0].polygon.vertices
        assert name in CATALOGUE
        assert car.wheelbase == theirs.a + theirs.b
        assert np.ptp(corners, axis=0) == pytest.approx([theirs.l, theirs.w])
        assert corners.mean(axis=0) == pytest.approx([theirs.b, 0.0])
        assert (car.limits.steering, car.limits.steering_rate) == (theirs.steering.max, theirs.steering.v_max)
        assert theirs.longitudinal.v_min <= car.limits.speed[0]
        assert car.limits.speed[1] <= theirs.longitudinal.v_max
        assert car.limits.acceleration[1] <= theirs.longitudinal.a_max


def test_commonroad_s_checkers_accept_scenario_and_solution(plan: Plan, moving_plan: Plan, tmp_path: Path) -> None:
    pairs = []
    crash = plan.scenario.with_(
        obstacles=(dataclasses.replace(plan.scenario.obstacles[0], exterior=[(4, 0), (6, 0), (5, 2)]),)
    )
    plans = [plan, moving_plan, dataclasses.replace(plan, scenario=crash)]
    for index, each in enumerate(plans):
        scenario, solution = tmp_path / f"scenario{index}.xml", tmp_path / f"solution{index}.xml"
        write_commonroad(each.scenario, scenario)
        assert read_commonroad(scenario).to_dict() == each.scenario.to_dict()
        write_commonroad_solution(each, solution, scenario_file=scenario)
        pairs.append((scenario, solution))
    good, moving, bad = checked(*pairs)
    for facts in (good, moving):
        assert {name: facts[name] for name in CHECKS} == dict.fromkeys(CHECKS, True)
    assert good["benchmark"] == "KS2:JB1:ZAM_ByHand-1_1:2020a"
    assert good["states"] == 54
    assert "collision" in str(bad["free"]), "the oracle is awake"


def test_a_scenario_from_elsewhere_is_planned_and_its_solution_accepted(tmp_path: Path) -> None:
    """Whatever their reader takes for occupied, ours does, too; and the plan reaches their goal."""
    goal = text.goal(
        text.rectangle(3, 2, (24, 4), 0.1),
        text.interval("orientation", -0.1, 0.3) + text.interval("velocity", 0, 1),
        400,
    )
    road = text.lanelet(1, [(-15, 12), (40, 12)], [(-15, -12), (40, -12)])
    parked = [
        text.static(12, text.rectangle(4.2, 1.9), text.state(9, 2.5, 0.3)),
        text.static(13, text.circle(1.5), text.state(15, -4, 1.0)),
        text.static(14, text.polygon((-1, -1), (2, -1), (2, 0), (0, 0.5), (-1, 2)), text.state(17, 7, 0.0)),
    ]
    theirs, solution = tmp_path / "theirs.xml", tmp_path / "solution.xml"
    theirs.write_text(text.scenario(road, *parked, problems=text.problem(7, goals=goal)))
    scene = read_commonroad(theirs)
    plan = tightspot.plan(scene)
    assert write_commonroad_solution(plan, solution) == []
    (facts,) = checked((theirs, solution))
    assert {name: facts[name] for name in CHECKS} == dict.fromkeys(CHECKS, True)
    assert facts["benchmark"] == "KS2:JB1:DEU_Test-1_1_T-1:2020a"
    ours = shapely.union_all([part.to_shapely() for _, part in scene.obstacle_parts])
    circles = [shapely.Point(x, y).buffer(radius, 64) for x, y, radius in facts["circles"]]
    blocked = shapely.union_all([*map(shapely.Polygon, facts["polygons"]), *circles])
    assert len(circles) == 1
    assert blocked.difference(ours).area < 1e-9
    assert ours.difference(blocked).area < 2 * np.pi * 1.5 * 0.02
