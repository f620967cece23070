"""Scores against fine quadrature; headings that are told from positions; what a verdict is as data."""

from __future__ import annotations

import itertools
import json

import numpy as np
import pytest
from tests.verification.tables.honest import ISSUE, drive, scene, text

from tightspot.errors import InputError, TableError
from tightspot.scenarios import builtin
from tightspot.vehicles import vehicle
from tightspot.verification import Table, judge_table, plan_scores
from tightspot.verification.tables import parse_table
from tightspot.verification.tables.heading import headings
from tightspot.verification.tables.scores import gear_changes

CAR = vehicle("tpcap")


def integral(values, t):
    return float((0.5 * np.diff(t) * (values[1:] + values[:-1])).sum())


def test_scores_by_quadrature():
    motion = drive(CAR, 6, seconds=10, hold=1.0)
    v, delta, (a, omega) = motion.states[:, 3], motion.states[:, 4], motion.inputs.T
    effort, bend = integral(a**2 + (v * omega) ** 2, motion.t), integral(delta**2, motion.t)
    length = np.hypot(*np.diff(motion.states[:, :2], axis=0).T).sum()
    for columns in (ISSUE, ("t", "x", "y", "theta", "v", "delta")):
        scores = judge_table(scene(motion), CAR, parse_table(text(motion, dt=0.02, decimals=6, columns=columns))).scores
        assert scores.duration == pytest.approx(10)
        assert scores.integral_a2_v2omega2 == pytest.approx(effort, rel=5e-3)
        assert scores.integral_delta2 == pytest.approx(bend, rel=1e-3)
        assert scores.path_length == pytest.approx(length, rel=1e-4)
        assert scores.gear_changes == _changes(v, motion.t)


def _changes(v, t):
    """Sign changes of the speed between legs of more than 1 cm, by counting."""
    legs, way = [], 0.0
    for step in (0.5 * np.diff(t) * (v[1:] + v[:-1])).tolist():
        if way * step < 0:
            legs.append(way)
            way = 0.0
        way += step
    legs = [leg for leg in [*legs, way] if abs(leg) > 0.01]
    return sum(before * after < 0 for before, after in itertools.pairwise(legs))


def test_the_exact_formula_is_the_trapezium_rule():
    t, v, a = np.array([0, 1, 3.0]), np.array([0, 1, -1.0]), np.array([1, 1, -1.0])
    delta, omega = np.array([0, 0.1, 0.3]), np.array([0.1, 0.1, 0.1])
    columns = {"t": t, "x": [0, 0.5, 0.5], "y": np.zeros(3), "theta": np.zeros(3)}
    more = {"v": v, "a": a, "delta": delta, "omega": omega}
    scores = judge_table(builtin("vertical"), CAR, Table.from_columns(columns | more)).scores
    f = a**2 + (v * omega) ** 2
    assert scores.integral_a2_v2omega2 == pytest.approx((f[0] + f[1]) / 2 + (f[1] + f[2]))
    assert scores.integral_delta2 == pytest.approx(0.005 + 0.1)


def test_paths_have_no_scores_that_take_time():
    motion = drive(CAR, 1)
    scores = judge_table(scene(motion), CAR, parse_table(text(motion, columns=("x", "y", "theta")))).scores
    assert scores.duration is scores.integral_a2_v2omega2 is scores.integral_delta2 is None
    assert scores.path_length > 0
    assert sum("not known" in line for line in scores.summary()) == 3


@pytest.mark.parametrize("noise", [0.0, 0.004])
def test_noise_about_standing_still_is_no_gear_change(noise):
    rng = np.random.default_rng(0)
    way = np.concatenate([np.full(50, 0.02), np.zeros(40), np.full(50, -0.02), np.zeros(30), np.full(9, -0.01)])
    assert gear_changes(way + rng.uniform(-noise, noise, way.size), 0.05) == 1
    assert gear_changes(np.zeros(5), 0.01) == 0


def test_a_plan_has_the_scores_of_its_samples(plan):
    scores = plan_scores(plan)
    t = np.linspace(0, plan.trajectory.duration, 20_001)
    states, inputs = plan.sample(t), plan.sample_inputs(t)
    assert scores.integral_a2_v2omega2 == pytest.approx(
        integral(inputs[:, 0] ** 2 + (states[:, 3] * inputs[:, 1]) ** 2, t), rel=1e-3
    )
    assert scores.integral_delta2 == pytest.approx(integral(states[:, 4] ** 2, t), rel=1e-6)
    assert scores.path_length == pytest.approx(np.hypot(*np.diff(states[:, :2], axis=0).T).sum(), rel=1e-6)
    assert scores.gear_changes == 0


def test_headings_from_positions():
    """On an arc forward, then back on another: the headings are the arcs' tangents, through the gear change."""
    s = np.linspace(0, 1.2, 31)
    forward = np.column_stack([5 * np.sin(s), 5 - 5 * np.cos(s), s])
    end = forward[-1]
    u = np.linspace(0, 0.8, 21)[1:]  # reverse on a circle to the right of the heading
    centre = end[:2] + 4 * np.array([np.sin(end[2]), -np.cos(end[2])])
    theta = end[2] + u
    back = np.column_stack([centre[0] - 4 * np.sin(theta), centre[1] + 4 * np.cos(theta), theta])
    poses = np.concatenate([forward, back])
    assert headings(poses[:, 0], poses[:, 1], 0.3, 0.0) == pytest.approx(poses[:, 2], abs=0.01)
    turned = headings(poses[:, 0], poses[:, 1], 0.3 + np.pi, 0.0)  # the scene starts the other way: reverse first
    assert turned == pytest.approx(poses[:, 2] + np.pi, abs=0.01)


def test_headings_that_positions_do_not_tell():
    with pytest.raises(TableError, match="forward or reverse cannot be told"):
        headings(np.arange(5.0), np.zeros(5), np.pi / 2, 0.0)
    with pytest.raises(TableError, match="give the headings"):
        headings(np.zeros(5), np.zeros(5), 0.0, 0.0)


def test_points_alone_are_judged_with_their_directions():
    motion = drive(CAR, 6, seconds=10, hold=1.0)
    verdict = judge_table(scene(motion), CAR, parse_table(text(motion, columns=("x", "y"), decimals=6)))
    assert verdict.upheld, verdict.summary()
    assert any("directions of motion" in note for note in verdict.notes)
    assert verdict.finding("side slip").passed is None
    assert verdict.poses[:, 2] == pytest.approx(
        np.interp(np.arange(201), np.arange(5001) / 25, motion.states[:, 2]), abs=0.1
    )


def test_a_verdict_as_data():
    motion = drive(CAR, 1)
    ring = motion.states[2000, :2] + np.array([[0, 0], [0.2, 0], [0.2, 0.2], [0, 0.2]])
    verdict = judge_table(scene(motion, [ring]), CAR, parse_table(text(motion)), margin=0.01)
    data = json.loads(json.dumps(verdict.to_dict(), allow_nan=False))
    keys = (
        "status kind collision margin clearance nearest witnesses arcs checks reasons scores scene vehicle table notes"
    )
    assert set(data) == set(keys.split())
    assert (data["status"], data["collision"], data["margin"]) == ("not-upheld", "collides", 0.01)
    witness = data["witnesses"][0]
    assert witness["obstacle"] == "o0"
    assert witness["obstacle_part"] == "o0/0"
    assert witness["penetration"] == -witness["clearance"] > 0
    assert witness["where"]["line"] == 2 + int(witness["where"]["row"])
    assert witness["where"]["time"] == pytest.approx(0.05 * witness["where"]["row"], abs=1e-6)
    assert data["clearance"] <= witness["clearance"] <= data["clearance"] + 1e-3
    assert [check["name"] for check in data["checks"]] == [finding.name for finding in verdict.findings]
    slip = next(check for check in data["checks"] if check["name"] == "side slip")
    assert slip["rate"] == pytest.approx(slip["value"] / slip["span"])
    assert data["reasons"] == [check["sentence"] for check in data["checks"] if check["passed"] is False]
    assert data["table"]["columns"]["delta"] == "sigma"
    assert set(data["scores"]) == {"duration", "path_length", "gear_changes", "integral_a2_v2omega2", "integral_delta2"}
    lines = verdict.summary()
    assert lines[:2] == ["the trajectory is NOT upheld", "collision: the interpolated motion collides"]
    assert [line[:6] for line in lines[2 : 2 + len(verdict.failed)]] == ["FAILED"] * len(verdict.failed)


def test_bad_arguments():
    table = Table.from_columns({"x": [0, 1], "y": [0, 0], "theta": [0, 0]})
    for margin in (-0.1, np.nan, np.inf):
        with pytest.raises(InputError, match="margin"):
            judge_table(builtin("vertical"), CAR, table, margin=margin)
    with pytest.raises(InputError, match="single-track"):
        judge_table(builtin("vertical"), object(), table)
