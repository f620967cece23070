"""A workspace that is not convex: W is its hull, and the rest of the hull is in the way."""

from __future__ import annotations

import json

import numpy as np
import pytest
import shapely

from tightspot.errors import SceneError
from tightspot.geometry import ConvexPolygon
from tightspot.scenarios import Scenario, check

L_SHAPE = [[-10, -10], [20, -10], [20, 2], [2, 2], [2, 10], [-10, 10]]
PILLAR = [[10, -8], [11, -8], [11, -7], [10, -7]]


def outside(scenario):
    return shapely.union_all([part.to_shapely() for _, part in scenario.obstacle_parts])


def test_a_convex_workspace_needs_no_boundary(scene):
    scene["workspace"] = [[-10, -10], [20, -10], [20, 10], [20, 10], [-10, 10], [-10, -10]]
    assert Scenario.from_dict(scene).boundary is None


@pytest.mark.parametrize("holes", [[], [PILLAR]])
@pytest.mark.parametrize("reverse", [False, True])
def test_hull_minus_boundary_is_covered_by_solids(scene, holes, reverse):
    ring = L_SHAPE[::-1] if reverse else L_SHAPE
    scene |= {"obstacles": [], "workspace": {"vertices": ring, "holes": holes} if holes else ring}
    scenario = Scenario.from_dict(scene)
    hull = shapely.Polygon(L_SHAPE).convex_hull
    assert scenario.workspace.to_shapely().equals(hull)
    expected = hull.difference(shapely.Polygon(L_SHAPE, holes))
    assert outside(scenario).symmetric_difference(expected).area < 1e-12
    assert all(solid.members == ("boundary",) for solid in scenario.solids)
    assert scenario.to_dict()["workspace"] == scene["workspace"]
    assert Scenario.from_dict(json.loads(json.dumps(scenario.to_dict()))).to_dict() == scenario.to_dict()


def test_a_start_beyond_the_boundary_is_refused_by_name(scene):
    scene |= {"obstacles": [], "workspace": L_SHAPE, "goal": {"x": 14, "y": 6, "theta": 0}}
    scenario = Scenario.from_dict(scene)
    with pytest.raises(SceneError, match="goal: the vehicle's body overlaps obstacle 'boundary'"):
        check(scenario, scenario.vehicle_model(), 0.05)


def test_an_obstacle_at_the_wall_is_one_with_it(scene):
    scene |= {"workspace": L_SHAPE, "obstacles": [{"name": "shelf", "vertices": [[5, 1], [8, 1], [8, 2], [5, 2]]}]}
    (solid,) = Scenario.from_dict(scene).solids
    assert solid.name == "shelf+boundary"


def test_a_boundary_of_many_corners_gets_the_box_as_workspace(scene):
    angle = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    radius = 30 + np.sin(40 * angle)
    ring = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    scene |= {"obstacles": [], "workspace": ring.tolist()}
    scenario = Scenario.from_dict(scene)
    assert len(scenario.workspace.vertices) == 4
    free = scenario.workspace.to_shapely().difference(outside(scenario))
    assert free.difference(shapely.Polygon(ring)).area < 1e-9
    assert shapely.Polygon(ring).difference(free).area < 0.05  # 240 m of boundary, 0.2 mm on average


def test_a_dent_within_rounding_is_kept_out_of_the_free_space(scene):
    scene |= {"obstacles": [], "workspace": [[-10, -10], [5, -10 + 1e-7], [20, -10], [20, 10], [-10, 10]]}
    scenario = Scenario.from_dict(scene)
    assert scenario.boundary is not None
    assert outside(scenario).covers(shapely.Polygon([(-10, -10), (5, -10 + 1e-7), (20, -10)]).buffer(-1e-12))


def test_recentring_moves_the_boundary_too(scene):
    scene |= {"workspace": {"vertices": L_SHAPE, "holes": [PILLAR]}}
    base = Scenario.from_dict(scene)
    step = np.array([30_000.0, -20_000.0])
    far = base.with_(
        workspace=base.workspace.transformed(*step, 0.0),
        boundary=base.boundary.shifted(step),
        obstacles=tuple(obstacle.shifted(step) for obstacle in base.obstacles),
        start=base.start + np.array([*step, 0, 0, 0]),
        goal=base.goal + np.array([*step, 0, 0, 0]),
    )
    near = far.recentred()
    assert outside(near).symmetric_difference(outside(base)).area < 1e-6
    assert Scenario.from_dict(far.to_dict()).to_dict() == far.to_dict()


def test_a_scenario_made_in_python_needs_no_boundary(scene):
    assert Scenario.from_dict(scene).with_(workspace=ConvexPolygon.rectangle(-9, 9, -9, 9)).boundary is None
