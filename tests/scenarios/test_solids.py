"""Dirty geometry: obstacles that touch are one solid, in few parts that never fall short."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from tightspot.scenarios import Scenario, clearances, load
from tightspot.scenarios.solids import TOLERANCE


def box(x0, x1, y0, y1, name=None):
    return {"name": name, "vertices": [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]}


@pytest.fixture
def solids(scene):
    def solids(*obstacles):
        scene["obstacles"] = list(obstacles)
        return checked(Scenario.from_dict(scene)).solids

    return solids


def checked(scenario):
    """The scenario, after shapely has seen that its parts cover the obstacles and stay near."""
    given = shapely.union_all([polygon for obstacle in scenario.obstacles for polygon in obstacle.polygons])
    cover = shapely.union_all([part.to_shapely() for _, part in scenario.obstacle_parts])
    assert given.difference(cover).area < 1e-12
    assert given.buffer(TOLERANCE, quad_segs=64).covers(cover)
    return scenario


def test_obstacles_that_stand_alone_are_left_alone(scene):
    scenario = checked(Scenario.from_dict(scene))
    assert [solid.name for solid in scenario.solids] == ["block", "L"]
    for solid, obstacle in zip(scenario.solids, scenario.obstacles, strict=True):
        assert solid.members == (obstacle.name,)
        assert solid.parts == obstacle.parts


def test_touching_panels_become_one_wall(solids):
    panels = [box(i, i + 1, 5, 5.2, f"panel {i}") for i in range(10)]
    (wall,) = solids(*panels)
    assert wall.name == "panel 0+panel 1+8 more"
    assert wall.members == tuple(f"panel {i}" for i in range(10))
    (part,) = wall.parts
    np.testing.assert_array_equal(np.ptp(part.vertices, axis=0), [10, 5.2 - 5])


@pytest.mark.parametrize(("gap", "count"), [(0.0, 1), (1e-12, 1), (5e-4, 1), (2e-3, 2), (-0.3, 1)])
def test_gaps_of_less_than_a_millimetre_are_closed(solids, gap, count):
    found = solids(box(0, 1, 5, 6, "a"), box(1 + gap, 2, 5, 6, "b"))
    assert len(found) == count
    assert sum(len(solid.parts) for solid in found) == count
    assert found[0].name == ("a+b" if count == 1 else "a")


def test_overlapping_obstacles_that_make_no_convex_one_keep_their_labels(solids):
    (cross,) = solids(box(0, 3, 5, 6, "beam"), box(1, 2, 4, 7, "post"))
    assert cross.name == "beam+post"
    assert cross.labels == ("beam", "post")


def test_an_obstacle_inside_another_vanishes_in_it(solids):
    (solid,) = solids(box(0, 3, 5, 8, "house"), box(1, 2, 6, 7, "table"))
    assert len(solid.parts) == 1
    assert solid.labels == ("house+table",)


def test_names_of_solids_differ_even_if_obstacles_are_named_alike(solids):
    found = solids(box(0, 1, 5, 6, "a"), box(0.5, 2, 5, 6, "b"), box(6, 7, 5, 6, "a+b"))
    assert [solid.name for solid in found] == ["a+b", "a+b-2"]


def test_corners_that_a_ring_repeats_or_almost_repeats_go(solids):
    (solid,) = solids({"vertices": [[0, 5], [1, 5], [1, 5], [1, 5.9999], [0.9999, 6], [0, 6], [0, 5.5]]})
    (part,) = solid.parts
    np.testing.assert_allclose(part.vertices, [[0, 5], [1, 5], [1, 6], [0, 6]], atol=1e-12)


def test_a_round_pillar_gets_fewer_corners(solids):
    angle = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    (solid,) = solids({"vertices": np.stack([3 + 0.3 * np.cos(angle), 7 + 0.3 * np.sin(angle)], axis=1).tolist()})
    assert len(solid.parts[0].vertices) < 100


def test_the_nearest_obstacle_is_named_not_the_whole_solid(scene):
    scene["obstacles"] = [box(0, 3, 5, 6, "beam"), box(1, 2, 4, 7, "post")]
    scenario = Scenario.from_dict(scene)
    found = clearances(scenario, scenario.vehicle_model(), scenario.start)
    assert [item.obstacle for item in found] == ["post", "beam"]


def test_solids_are_kept_by_a_copy_with_the_same_obstacles(scene):
    scenario = Scenario.from_dict(scene)
    before = scenario.solids
    assert scenario.with_(margin=0.2).solids is before
    assert scenario.with_(obstacles=scenario.obstacles[:1]).solids is not before


def test_the_competition_scenes_are_covered(tpcap):
    for path in sorted(tpcap.glob("*.csv")):
        checked(load(path))


def test_a_heap_of_thousands_is_one_solid_of_few_parts(scene):
    rng = np.random.default_rng(0)
    heap = [box(x, x + w, y, y + h) for x, y, w, h in rng.uniform((4, 4, 0.5, 0.5), (8, 8, 3, 3), (500, 4))]
    scene["obstacles"] = [*heap, box(-5, -4, -5, -4, "aside"), box(0, 1, 20, 21), box(1, 2, 20, 21)]
    scenario = checked(Scenario.from_dict(scene))
    assert [len(solid.members) for solid in scenario.solids] == [500, 1, 2]
    assert len(scenario.obstacle_parts) < 60


def test_a_thousand_vertices_a_polygon_are_covered(scene):
    rng = np.random.default_rng(0)
    angle = np.linspace(0, 2 * np.pi, 1000, endpoint=False)
    rings = []
    for centre in [(-100, 0), (-100, 60)]:
        radius = 20 + rng.uniform(-0.5, 0.5, len(angle))
        rings.append(np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1) + centre)
    scene["obstacles"] = [{"vertices": ring.tolist()} for ring in rings]
    scenario = Scenario.from_dict(scene)
    assert len(scenario.obstacle_parts) < 0.7 * 2000
    union = shapely.union_all([part.to_shapely() for _, part in scenario.obstacle_parts])
    assert shapely.union_all([shapely.Polygon(ring) for ring in rings]).difference(union).area < 1e-9
