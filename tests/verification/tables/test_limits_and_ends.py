"""The vehicle's limits in columns and between rows, and how far a table is from the scene's start and goal."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.verification.tables.honest import changed, drive, scene, text

from tightspot.vehicles import Limits, vehicle
from tightspot.verification import Table, judge_table
from tightspot.verification.tables import parse_table

CAR = vehicle("tpcap")
OWN = CAR.limits


def with_limits(**changes):
    return replace(CAR, limits=replace(OWN, **changes))


TIGHTER = {
    "speed": (lambda m: {"speed": (-0.5 * np.abs(m.states[:, 3]).max(), 0.5 * np.abs(m.states[:, 3]).max())}, "v"),
    "acceleration": (lambda m: {"acceleration": (-0.4, 0.4)}, "a"),
    "steering": (lambda m: {"steering": 0.6 * float(np.abs(m.states[:, 4]).max())}, "sigma"),
    "steering rate": (lambda m: {"steering_rate": 0.25}, "omega"),
}
WITH_ALL = ("t", "x", "y", "theta", "v", "sigma", "a", "omega")


@pytest.mark.parametrize("name", TIGHTER)
def test_limits_are_seen_in_columns_and_without_them(name):
    motion = drive(CAR, 6, seconds=10, hold=1.0)
    tighter, column = TIGHTER[name]
    car = with_limits(**tighter(motion))
    told = judge_table(scene(motion), car, parse_table(text(motion, columns=WITH_ALL)))
    assert told.finding(name).passed is False
    assert told.finding(name).source == "column"
    assert told.finding(f"{name} between rows").passed is False
    rates = {"sigma": {"sigma", "omega"}}.get(column, {column})  # omega means nothing without an angle
    for columns in (tuple(c for c in WITH_ALL if c not in rates), ("t", "x", "y", "theta")):
        verdict = judge_table(scene(motion), car, parse_table(text(motion, columns=columns)))
        assert verdict.finding(name).passed is None
        assert verdict.finding(f"{name} between rows").passed is False, verdict.summary()
        assert verdict.finding(f"{name} between rows").source == "derived"


def test_a_limit_in_one_direction():
    motion = drive(CAR, 6, seconds=10, hold=1.0)
    slowest = motion.states[:, 3].min()
    assert slowest < -0.2
    car = with_limits(speed=(0.5 * slowest, 2.5))
    verdict = judge_table(scene(motion), car, parse_table(text(motion)))
    assert {f.name for f in verdict.failed} == {"speed", "speed between rows"}


def test_exactly_the_limits_are_within_them():
    """Bang-bang inputs, rounded up by the last digit."""
    limits = Limits(speed=(-1.0, 1.0), acceleration=(-0.6667, 0.6667), steering=0.5, steering_rate=0.33333)
    car = replace(CAR, limits=limits)
    motion = drive(car, 8, hold=3.0)
    for decimals in (3, 4, None):
        verdict = judge_table(scene(motion), car, parse_table(text(motion, decimals=decimals)))
        assert verdict.upheld, verdict.summary()


def test_the_largest_value_and_its_place():
    motion = changed(drive(CAR, 6), 3, lambda v: np.full_like(v, 9.0), since=5.0)
    finding = judge_table(scene(motion), CAR, parse_table(text(motion))).finding("speed")
    assert finding.value == pytest.approx(9.0 - OWN.speed[1])
    assert "9 m/s at t = 5.000 s" in finding.sentence


def test_turning_on_the_spot_is_impossible():
    theta = np.linspace(0, 0.5, 11)
    still = {"x": np.zeros(11), "y": np.zeros(11), "theta": theta}
    for more in ({}, {"t": np.linspace(0, 1, 11)}):
        verdict = judge_table(scene(drive(CAR, 0, seconds=1)), CAR, Table.from_columns(still | more))
        assert verdict.finding("steering between rows").passed is False


def test_standing_still_is_not():
    still = {"t": np.linspace(0, 1, 11), "x": np.zeros(11), "y": np.zeros(11), "theta": np.full(11, 0.7)}
    verdict = judge_table(scene(drive(CAR, 0, seconds=1)), CAR, Table.from_columns(still))
    assert all(f.passed is not False for f in verdict.findings if f.group in ("kinematics", "limits", "start"))


ENDS = {
    "position": (0, 0.02),
    "heading": (2, 0.05),
    "speed": (3, 0.05),
}


@pytest.mark.parametrize("end", ["start", "goal"])
@pytest.mark.parametrize("group", ENDS)
def test_missed_ends(end, group):
    motion = drive(CAR, 1)
    scenario = scene(motion)
    table = parse_table(text(motion, decimals=6))
    assert judge_table(scenario, CAR, table).upheld
    place, by = ENDS[group]
    moved = getattr(scenario, end).copy()
    moved[place] += by
    verdict = judge_table(scenario.with_(**{end: moved}), CAR, table)
    assert [f.name for f in verdict.failed] == [f"{end} {group}"]
    assert verdict.failed[0].value == pytest.approx(by, abs=1e-4)
    assert verdict.failed[0].row == (0 if end == "start" else table.rows - 1)


def test_whole_turns_do_not_count():
    motion = drive(CAR, 1)
    turned = changed(motion, 2, lambda theta: theta + 2 * np.pi)
    assert judge_table(scene(motion), CAR, parse_table(text(turned))).upheld


def test_what_the_scene_leaves_free_is_not_asked_for():
    motion = drive(CAR, 1)
    scenario = scene(motion)
    goal = scenario.goal.copy()
    goal[3:] = np.nan
    verdict = judge_table(scenario.with_(goal=goal), CAR, parse_table(text(motion)))
    assert verdict.upheld
    with pytest.raises(KeyError):
        verdict.finding("goal speed")


def test_the_steering_angle_at_the_ends_is_told_but_not_judged():
    motion = drive(CAR, 1)
    scenario = scene(motion)
    goal = scenario.goal.copy()
    goal[4] += 0.3
    verdict = judge_table(scenario.with_(goal=goal), CAR, parse_table(text(motion)))
    assert verdict.upheld
    assert verdict.finding("goal steering").passed is None
    assert verdict.finding("goal steering").value == pytest.approx(0.3, abs=1e-3)
