"""The motion between the rows: what it is, that the lemma bounds it, and that the judge's verdict is true of it."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from tests.verification.tables.honest import drive, scene, text

from tightspot.geometry import ConvexPolygon, transform
from tightspot.scenarios import Obstacle, Scenario
from tightspot.vehicles import vehicle
from tightspot.verification import Table, judge_table
from tightspot.verification.tables import parse_table
from tightspot.verification.tables.clearance import STRETCH
from tightspot.verification.tables.motion import RowMotion, arc_length, sagitta

CAR = vehicle("tpcap")


def random_poses(seed, count=2, size=1.0):
    rng = np.random.default_rng(seed)
    return np.cumsum(rng.normal(size=(count, 3)) * [size, size, 0.7], axis=0)


def interpolated(poses, samples):
    """The documented interpolation, by NumPy: x, y and theta linear from row to row."""
    s = np.linspace(0, len(poses) - 1, samples)
    return np.stack([np.interp(s, np.arange(len(poses)), column) for column in poses.T], axis=1)


def test_straight_is_linear_in_every_coordinate():
    poses = random_poses(1, count=7)
    motion = RowMotion.of(CAR, poses, extent=10)
    assert motion.at(np.linspace(0, 6, 61)) == pytest.approx(interpolated(poses, 61), abs=1e-12)


@pytest.mark.parametrize("seed", range(20))
def test_arcs_are_arcs(seed):
    """Through both positions, at constant speed, turning by the heading's change, at most the sagitta away."""
    poses = random_poses(seed)
    arc = RowMotion.of(CAR, poses, extent=10, arcs=True).at(np.linspace(0, 1, 2001))
    assert arc[[0, -1]] == pytest.approx(poses, abs=1e-12)
    step = np.diff(arc[:, :2], axis=0)
    length = np.hypot(*step.T)
    assert length == pytest.approx(length.mean(), rel=1e-6)
    assert length.sum() == pytest.approx(arc_length(np.diff(poses, axis=0))[0], rel=1e-6)
    direction = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    turn = poses[1, 2] - poses[0, 2]
    assert direction[-1] - direction[0] == pytest.approx(turn * (1 - 1 / 2000), abs=1e-6)
    apart = np.hypot(*(arc - interpolated(poses, 2001))[:, :2].T).max()
    assert apart == pytest.approx(sagitta(poses)[0], rel=1e-3)


@pytest.mark.parametrize("arcs", [False, True])
@pytest.mark.parametrize("seed", range(20))
def test_the_lemma_bounds_the_bulge(seed, arcs):
    rng, poses = np.random.default_rng(seed), random_poses(seed)
    motion = RowMotion.of(CAR, poses, extent=10, arcs=arcs)
    cuts = np.sort(rng.uniform(0, 1, 2))
    s = np.linspace(*cuts, 801)
    part = np.zeros(801, dtype=np.intp)
    normal = np.array([np.cos(seed), np.sin(seed)])
    heights = (motion.vertices(part, motion.at(s)) @ normal).min(axis=1)
    before, after = motion.at(cuts[:1]), motion.at(cuts[1:])
    loss = motion.loss(part[:1], part[:1], before, after, np.diff(cuts))[0]
    assert heights.min() >= min(heights[0], heights[-1]) - loss - 1e-9


def around(poses, seed, count=4):
    """A scene with obstacles near the path and a workspace around it."""
    rng = np.random.default_rng(seed)
    rings = []
    for _ in range(count):
        x, y = poses[rng.integers(len(poses)), :2] + rng.normal(size=2) * 5
        w, h = rng.uniform(0.2, 1.5, 2)
        rings.append(ConvexPolygon.rectangle(-w, w, -h, h).transformed(x, y, rng.uniform(0, 3)).vertices)
    low, high = poses[:, :2].min(axis=0) - rng.uniform(4, 9), poses[:, :2].max(axis=0) + rng.uniform(4, 9)
    ends = [np.array([*pose[:2], 0, 0, 0]) for pose in (poses[0], poses[-1])]
    workspace = ConvexPolygon.rectangle(low[0], high[0], low[1], high[1])
    obstacles = tuple(Obstacle(f"o{i}", ring) for i, ring in enumerate(rings))
    return Scenario(name="random", workspace=workspace, obstacles=obstacles, start=ends[0], goal=ends[1])


@pytest.mark.parametrize("seed", range(24))
def test_the_verdict_is_true_by_shapely(seed):
    """Proved clearances are below the densely sampled ones, but not by much; witnesses overlap what they name."""
    car = vehicle(["paper", "forklift"][seed % 2])
    poses = random_poses(seed, count=6, size=[0.3, 1.0][seed % 2])
    scenario = around(poses, seed)
    verdict = judge_table(scenario, car, Table.from_columns(dict(zip(["x", "y", "theta"], poses.T, strict=True))))
    samples = interpolated(verdict.poses, 4001)
    bodies = [shapely.polygons(transform(part.polygon.vertices, samples)) for part in car.parts]
    obstacles = shapely.union_all([polygon.to_shapely() for _, polygon in scenario.obstacle_parts])
    distance = min(shapely.distance(body, obstacles).min() for body in bodies)
    overlap = max(shapely.area(shapely.intersection(body, obstacles)).max() for body in bodies)
    inside = scenario.workspace.to_shapely().buffer(1e-6, join_style="mitre")
    stays = all(shapely.contains(inside, body).all() for body in bodies)
    reading = verdict.clearances.interpolated
    if overlap > 1e-6:
        assert verdict.collision == "collides"
    if verdict.collision == "collides":
        witness = reading.obstacles[0]
        body = next(part for part in car.parts if part.name == witness.part).polygon.transformed(*witness.pose)
        obstacle = dict(scenario.obstacle_parts)[witness.obstacle]
        assert body.to_shapely().intersection(obstacle.to_shapely()).area > 0
        assert witness.pose == pytest.approx(verdict.clearances.interpolated and _pose_at(verdict.poses, witness.time))
        assert not verdict.finding("obstacles").passed
    else:
        assert verdict.collision == "free"
        assert reading.clearance <= distance + 1e-9
        if distance < 1:
            assert distance < reading.clearance + 3e-3
    assert verdict.finding("workspace").passed == (not reading.workspace)
    if verdict.finding("workspace").passed:
        assert stays
    else:
        assert not stays or reading.workspace[0].clearance > -1e-5


def _pose_at(poses, row):
    return [np.interp(row, np.arange(len(poses)), column) for column in poses.T]


def thin_wall(x, y=0.0):
    return [(x, y - 1), (x + 0.1, y - 1), (x + 0.1, y + 1), (x, y + 1)]


def straight(t, x, **more):
    zero = np.zeros(len(t))
    return Table.from_columns({"t": t, "x": x, "y": zero, "theta": zero, **more})


def test_what_is_jumped_over_between_rows_is_found():
    """At both rows the car is 2 m away from the wall."""
    motion = drive(CAR, 0, seconds=1, heading=0.0)
    scenario = scene(motion, [thin_wall(8)])
    verdict = judge_table(scenario, CAR, straight([0, 10], [0.0, 12.0]))
    assert verdict.collision == "collides"
    witness = verdict.witnesses[0]
    assert (witness.part, witness.obstacle) == ("body", "o0/0")
    assert 0.3 < witness.time < 0.9
    assert verdict.to_dict()["witnesses"][0]["where"]["time"] == pytest.approx(10 * witness.time)


def test_a_margin_is_proved_or_refuted():
    motion = drive(CAR, 0, seconds=1, heading=0.0)
    width = CAR.parts[0].polygon.vertices[:, 1].max()
    beside = scene(motion, [[(4, width + 0.05), (5, width + 0.05), (5, width + 2), (4, width + 2)]])
    table = straight([0, 10], [0.0, 8.0])
    for margin, passed in ((0.0, True), (0.049, True), (0.051, False)):
        verdict = judge_table(beside, CAR, table, margin=margin)
        assert verdict.collision == "free"
        assert verdict.finding("obstacles").passed is passed
    assert verdict.witnesses[0].kind == "margin"
    assert verdict.witnesses[0].clearance == pytest.approx(0.05)


def test_touching_is_not_decided():
    motion = drive(CAR, 0, seconds=1, heading=0.0)
    width = CAR.parts[0].polygon.vertices[:, 1].max()
    scenario = scene(motion, [[(4, width), (5, width), (5, width + 2), (4, width + 2)]])
    verdict = judge_table(scenario, CAR, straight([0, 10], [0.0, 8.0]))
    assert verdict.collision == "undecided"
    assert not verdict.upheld


def test_rows_too_far_apart_are_told():
    """A quarter circle in one step: straight, the car cuts the corner; on the arc it does not, and the other way."""
    poses = np.array([[0, 0, 0], [6, 6, np.pi / 2]])
    table = Table.from_columns({"x": poses[:, 0], "y": poses[:, 1], "theta": poses[:, 2]})
    corner = [(2.5, 3.5), (2.7, 3.5), (2.7, 3.7), (2.5, 3.7)]
    outside = [(5.6, 1.15), (5.75, 1.15), (5.75, 1.3), (5.6, 1.3)]
    box = ConvexPolygon.rectangle(-20, 30, -20, 30)
    ends = {"start": [0, 0, 0, 0, 0], "goal": [6, 6, np.pi / 2, 0, 0]}
    found = {}
    for name, ring in (("corner", corner), ("outside", outside)):
        scenario = Scenario(name=name, workspace=box, obstacles=(Obstacle(name, ring),), **ends)
        found[name] = judge_table(scenario, CAR, table)
    assert found["corner"].collision == "collides"
    assert found["corner"].finding("arcs").passed
    assert "too far apart to tell" in found["corner"].finding("arcs").sentence
    assert found["outside"].collision == "free"
    assert not found["outside"].finding("arcs").passed
    assert "give the table more rows" in found["outside"].finding("arcs").sentence
    assert not found["outside"].upheld


def test_long_tables_are_judged_in_stretches():
    motion = drive(CAR, 5, seconds=10)
    place = motion.states[4500, :2] + [0.0, 0.05]
    ring = place + np.array([[0, 0], [0.2, 0], [0.2, 0.2], [0, 0.2]])
    table = parse_table(text(motion, dt=0.004, decimals=6))
    assert table.rows > 5 * STRETCH
    verdict = judge_table(scene(motion, [ring]), CAR, table)
    coarse = judge_table(scene(motion, [ring]), CAR, parse_table(text(motion, dt=0.1, decimals=6)))
    assert verdict.collision == coarse.collision == "collides"
    assert len(verdict.witnesses) == 1
    assert verdict.witnesses[0].clearance == pytest.approx(coarse.witnesses[0].clearance, abs=2e-3)


def test_coordinates_are_those_of_the_scene_file():
    """A scene far from the origin is recentred on load; tables stay where the file is."""
    motion = drive(CAR, 2, seconds=4)
    far = np.array([4.5e6, -2e6])
    moved = motion._replace(states=motion.states + np.array([*far, 0, 0, 0]))
    ring = np.array(thin_wall(*(motion.states[-1, :2] + [6, 0])))
    here = judge_table(scene(motion, [ring]), CAR, parse_table(text(motion)))
    there = judge_table(scene(motion, [ring], offset=far), CAR, parse_table(text(moved)))
    assert there.upheld == here.upheld
    assert there.clearances.interpolated.clearance == pytest.approx(here.clearances.interpolated.clearance, abs=1e-6)
    nearest = there.to_dict()["nearest"]
    if nearest is not None:
        assert nearest["pose"][0] > 4e6
