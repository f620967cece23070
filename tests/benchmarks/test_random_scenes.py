"""Random scenes: always the same for a seed, valid, as tight as they say, and of every family."""

from __future__ import annotations

import math
import sys
from collections import Counter

import numpy as np
import pytest
import shapely
from benchmarks.random_scenes import CARS, FAMILIES, random_scene
from benchmarks.random_scenes.__main__ import main
from benchmarks.random_scenes.car import Car
from benchmarks.random_scenes.shapes import any_polygon, bracket, convex, star

from tightspot import scenarios

COUNT = 120


@pytest.fixture(scope="module")
def drawn():
    return [random_scene(11, index) for index in range(COUNT)]


def test_the_same_seed_and_index_give_the_same_scene(drawn):
    for index in (0, 7, 31):
        assert random_scene(11, index).scenario.to_dict() == drawn[index].scenario.to_dict()
    others = [random_scene(12, index).scenario.to_dict() for index in range(5)]
    assert all(other != drawn[index].scenario.to_dict() for index, other in enumerate(others))


def test_names_carry_seed_and_index(drawn):
    names = [scene.scenario.name for scene in drawn]
    assert len(set(names)) == COUNT
    assert all(name.endswith(f"-s11-i{index:04d}") for index, name in enumerate(names))


def test_every_family_and_vehicle_comes_as_often_as_it_should(drawn):
    for shares, found in (
        ({name: share for name, (share, _) in FAMILIES.items()}, Counter(scene.family for scene in drawn)),
        (CARS, Counter(scene.scenario.vehicle for scene in drawn)),
    ):
        assert sum(shares.values()) == pytest.approx(1)
        for name, share in shares.items():
            spread = math.sqrt(COUNT * share * (1 - share))
            assert abs(found[name] - COUNT * share) < 4 * spread, name


def test_start_and_goal_are_free_in_every_scene(drawn):
    for scene in drawn:
        scenarios.check(scene.scenario, scene.scenario.vehicle_model(), scene.scenario.margin)
        assert 1 <= len(scene.scenario.obstacles) <= 10
        assert 0 <= scene.scenario.margin <= 0.1


def test_a_disc_of_the_body_could_roll_from_start_to_goal(drawn):
    """What is drawn is at least not walled off."""
    for scene in drawn[:60]:
        s, car = scene.scenario, Car.of(scene.scenario.vehicle_model())
        walls = shapely.union_all([part.to_shapely() for _, part in s.obstacle_parts])
        free = shapely.Polygon(s.workspace.vertices).buffer(-car.disc + 1e-5).difference(walls.buffer(car.disc - 1e-5))
        pieces = [piece.buffer(2e-3) for piece in shapely.get_parts(free)]
        ends = [shapely.Point(s.start[:2]), shapely.Point(s.goal[:2])]
        assert any(piece.covers(ends[0]) and piece.covers(ends[1]) for piece in pieces), s.name


def test_slots_are_from_103_to_160_percent_of_the_vehicle_and_often_tight(drawn):
    slots = [s for s in drawn if s.family in ("perpendicular", "oblique")]
    ratios = np.array([scene.ratio for scene in slots])
    assert ratios.min() == pytest.approx(1.03)
    assert 1.45 < ratios.max() <= 1.6
    assert 0.2 < np.mean(ratios < 1.1) < 0.6
    for scene in slots:
        width = Car.of(scene.scenario.vehicle_model()).width
        sides = {o.name: shapely.Polygon(o.exterior) for o in scene.scenario.obstacles}
        assert sides["left"].distance(sides["right"]) / width == pytest.approx(scene.ratio, rel=0.02), (
            scene.scenario.name
        )


def test_every_kind_of_variety_is_there(drawn):
    scenes = [scene.scenario for scene in drawn]
    kinds = " ".join(scene.kind for scene in drawn)
    assert all(
        word in kinds for word in ("forward", "reverse", "undone", "round a corner", "gap", "garage", "dead end")
    )
    assert {0.0} < {scene.margin for scene in scenes}
    assert max(abs(scene.offset).max() for scene in scenes) > 1e5
    rings = [shapely.Polygon(o.exterior) for scene in scenes for o in scene.obstacles]
    convex_part = np.mean([ring.convex_hull.area < 1.001 * ring.area for ring in rings])
    assert 0.3 < convex_part < 0.95
    assert max(len(scene.obstacles) for scene in scenes) >= 8
    edges = np.array([scene.workspace.vertices[1] - scene.workspace.vertices[0] for scene in scenes])
    assert np.mean(np.abs(edges).min(axis=1) > 1e-3) > 0.6, "most scenes are turned"


@pytest.mark.parametrize("shape", [convex, star, bracket, any_polygon])
def test_polygons_are_simple_and_of_their_size(shape):
    rng = np.random.default_rng(5)
    shapes = [shapely.Polygon(shape(rng, 2.0)) for _ in range(100)]
    if shape is convex:
        assert all(polygon.convex_hull.area == pytest.approx(polygon.area) for polygon in shapes)
    assert all(polygon.is_valid for polygon in shapes)
    assert all(0.05 < polygon.area < 16 for polygon in shapes)


def test_a_car_is_placed_by_its_middle():
    car = Car.of(random_scene(11, 0).scenario.vehicle_model())
    box = car.placed(car.centred(3.0, -2.0, 0.7)).minimum_rotated_rectangle
    assert (box.centroid.x, box.centroid.y) == pytest.approx((3.0, -2.0))
    assert box.area == pytest.approx(car.length * car.width)


def test_the_program_writes_scene_files(tmp_path, monkeypatch, capsys):
    arguments = ["random_scenes", "--seed", "11", "--first", "3", "--count", "3", "--output", str(tmp_path / "new")]
    monkeypatch.setattr(sys, "argv", arguments)
    assert main() == 0
    written = sorted((tmp_path / "new").iterdir())
    assert len(written) == 3
    assert capsys.readouterr().out.startswith("seed 11\n")
    for path in written:
        index = int(path.stem[-4:])
        assert scenarios.load(path).to_dict() == random_scene(11, index).scenario.to_dict()
