"""Whatever polygons a scene has: what is planned with covers them and stays near; files hold them bit for bit."""

import json

import numpy as np
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from tightspot.errors import SceneError
from tightspot.scenarios import Scenario
from tightspot.scenarios.solids import TOLERANCE

grid = st.integers(0, 16).map(lambda k: k / 4)
nudge = st.sampled_from([0.0, 0.0, 0.0, 1e-15, 1e-11, 1e-9, 1e-7, 3e-4, -1e-12, -1e-8, -4e-4])
points = st.tuples(grid, grid, nudge, nudge).map(lambda p: [p[0] + p[2], p[1] + p[3]])
rings = st.lists(points, min_size=3, max_size=9)
offsets = st.sampled_from([(0.0, 0.0), (1e5, -3e5), (4.484e9, -3.54e8)])


@st.composite
def boxes(draw):
    (x, y), width, height = draw(points), draw(st.integers(1, 8)) / 4, draw(st.integers(1, 8)) / 4
    ring = [[x, y], [x + width, y], [x + width, y + height], [x, y + height]]
    return ring[:: draw(st.sampled_from([1, -1]))] + ring[:1] * draw(st.booleans())


def scene(obstacles, offset):
    shift = np.array(offset)
    return {
        "obstacles": [{"vertices": (np.array(ring) + shift).tolist()} for ring in obstacles],
        "start": {"x": shift[0] - 8.25, "y": shift[1], "theta": 0},
        "goal": {"x": shift[0] - 4, "y": shift[1] + 1, "theta": 0},
    }


def inside(ring, points):
    """Even-odd rule: whether a ray in direction +x crosses the ring's edges an odd number of times."""
    (x0, y0), (x1, y1) = ring.T[:, :, None], np.roll(ring, -1, axis=0).T[:, :, None]
    x, y = points.T
    with np.errstate(divide="ignore", invalid="ignore"):
        crosses = ((y0 <= y) != (y1 <= y)) & (x < x0 + (y - y0) / (y1 - y0) * (x1 - x0))
    return crosses.sum(axis=0) % 2 == 1


@settings(max_examples=120)
@given(st.lists(st.one_of(rings, boxes()), max_size=6), offsets)
def test_parts_cover_the_obstacles_and_stay_near(obstacles, offset):
    try:
        scenario = Scenario.from_dict(scene(obstacles, offset))
    except SceneError:
        return
    solid = [polygon for obstacle in scenario.obstacles for polygon in obstacle.polygons]
    given_area, cover = (
        shapely.union_all(solid),
        shapely.union_all([p.to_shapely() for _, p in scenario.obstacle_parts]),
    )
    assert given_area.difference(cover).area <= 1e-10 * max(1.0, cover.length)
    assert cover.difference(given_area.buffer(TOLERANCE + 1e-7, quad_segs=32)).is_empty
    for obstacle in scenario.obstacles:
        probes = np.random.default_rng(0).uniform(-1, 8, (200, 2)) + np.subtract(offset, scenario.offset)
        assert shapely.contains_xy(cover.buffer(1e-9), *probes[inside(obstacle.exterior, probes)].T).all()
    data = scenario.to_dict()
    assert [o["vertices"] for o in data["obstacles"]] == [o["vertices"] for o in scene(obstacles, offset)["obstacles"]]
    again = Scenario.from_dict(json.loads(json.dumps(data)))
    assert again.to_dict() == data
    assert [(name, part.vertices.tolist()) for name, part in again.obstacle_parts] == [
        (name, part.vertices.tolist()) for name, part in scenario.obstacle_parts
    ]


@settings(max_examples=60)
@given(rings, offsets)
def test_free_space_is_inside_the_boundary(ring, offset):
    data = scene([], offset) | {"workspace": (np.array(ring) + offset).tolist()}
    try:
        scenario = Scenario.from_dict(data)
    except SceneError:
        return
    outside = shapely.union_all([part.to_shapely() for _, part in scenario.obstacle_parts])
    free = scenario.workspace.to_shapely().difference(outside)
    allowed = scenario.boundary.polygon if scenario.boundary else scenario.workspace.to_shapely()
    assert free.difference(allowed).area <= 1e-12
    assert allowed.difference(free.buffer(TOLERANCE + 1e-7)).area <= 2 * TOLERANCE * allowed.length
    assert Scenario.from_dict(scenario.to_dict()).to_dict() == scenario.to_dict()
