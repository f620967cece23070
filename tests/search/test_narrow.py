"""Places between walls: small steering angles and moves as long as there is room."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from tightspot.errors import InputError
from tightspot.geometry import ConvexPolygon
from tightspot.search import COARSE, MEDIUM, NARROW, HybridAStarOptions, Resolution, SearchStatus, search
from tightspot.search import hybrid_astar as module
from tightspot.vehicles import vehicle

PAPER = vehicle("paper")
BODY = PAPER.parts[0].polygon
KERB = 0.015


def kerb_slot(length: float):
    """A parallel slot of so many body lengths, its kerb 15 mm beside the goal; the start on the road above."""
    low, high = BODY.vertices.min(axis=0), BODY.vertices.max(axis=0)
    goal = np.array([0.0, 0.0, 0.0])
    room = (length - 1) * (high[0] - low[0]) / 2
    ends = low[0] - room, high[0] + room
    side = low[1] - KERB, high[1] + 0.3
    obstacles = [
        ConvexPolygon.rectangle(-15, ends[0], side[0], side[1]),
        ConvexPolygon.rectangle(ends[1], 20, side[0], side[1]),
        ConvexPolygon.rectangle(-15, 20, side[0] - 1, side[0]),
    ]
    workspace = ConvexPolygon.rectangle(-15, 20, side[0] - 1, 9)
    return workspace, obstacles, PAPER, np.array([-8.0, 3.5, 0.0]), goal


def test_a_slot_beside_a_kerb_needs_small_steering_angles():
    scene = kerb_slot(1.5)
    coarser = HybridAStarOptions(resolutions=(COARSE, MEDIUM), margins=(0.005,))
    assert search(*scene, coarser).status is SearchStatus.EXHAUSTED
    found = search(*scene, HybridAStarOptions(resolutions=(NARROW,), margins=(0.005,)))
    assert found.status is SearchStatus.FOUND
    obstacles = shapely.union_all([obstacle.to_shapely() for obstacle in scene[1]])
    clearances = [shapely.distance(obstacles, shapely.Polygon(placed(pose))) for pose in found.path.poses]
    assert min(clearances) >= 0.005 - 1e-3 * np.ptp(BODY.vertices[:, 1])
    assert search(*scene, HybridAStarOptions(margins=(0.005,))).status is SearchStatus.FOUND


def placed(pose):
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return BODY.vertices @ np.array([[c, s], [-s, c]]) + pose[:2]


def test_the_curvatures_are_halved():
    scene = kerb_slot(1.5)
    result = search(*scene, HybridAStarOptions(resolutions=(NARROW,), margins=(0.005,), shortcuts=False))
    full = 0.95 / PAPER.min_turning_radius
    parts = np.unique(np.round(np.abs(result.path.arcs[:, 1]) / full, 9))
    assert set(parts) <= {0.0, 0.125, 0.25, 0.5, 1.0}
    assert parts.min(initial=1.0, where=parts > 0) < 0.5


def test_of_winding_paths_the_cheapest_counts(monkeypatch):
    scene = kerb_slot(1.5)
    options = HybridAStarOptions(resolutions=(NARROW,), margins=(0.006, 0.004, 0.002), max_expansions=6000)
    first = search(*scene, options)
    monkeypatch.setattr(module, "WINDING", 0)
    monkeypatch.setattr(module, "SECONDS_MORE", 60.0)
    best = search(*scene, options)
    costs = [attempt.cost for attempt in best.attempts if attempt.cost is not None]
    assert len(costs) > 1
    assert best.attempts[-1].cost == min(costs) <= first.attempts[-1].cost
    assert best.path.gear_changes > 0


def test_halvings_of_the_steering_are_checked():
    with pytest.raises(InputError, match="steering_halvings"):
        Resolution("odd", 0.1, 72, 0.2, 1000, steering_halvings=11)
