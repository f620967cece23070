"""Hypothesis: shortest words never beaten, and paths through random crowds free of collisions."""

from __future__ import annotations

import numpy as np
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from tightspot.geometry import ConvexPolygon
from tightspot.search import HybridAStarOptions, Path, SearchStatus, search, shortest_path
from tightspot.vehicles import vehicle

coordinate = st.floats(-20, 20)
angle = st.floats(-10, 10)
pose = st.tuples(coordinate, coordinate, angle)
drive = st.lists(st.tuples(st.floats(-4, 4), st.sampled_from([-1.0, 0.0, 1.0])), min_size=1, max_size=5)


@given(pose, drive)
def test_no_drive_is_shorter_than_the_shortest_path(start, arcs):
    radius = 2.0
    driven = np.array([(length, turn / radius) for length, turn in arcs])
    end = Path.from_arcs(start, driven).poses[-1]
    assert shortest_path(start, end, radius).length <= np.abs(driven[:, 0]).sum() + 1e-6


@given(pose, pose)
def test_shortest_paths_are_symmetric_and_no_shorter_than_the_straight_line(start, goal):
    there = shortest_path(start, goal, 3.0).length
    assert there == shortest_path(goal, start, 3.0).length or abs(
        there - shortest_path(goal, start, 3.0).length
    ) <= 1e-6 * (1 + there)
    assert there >= np.hypot(goal[0] - start[0], goal[1] - start[1]) - 1e-9


crowds = st.lists(
    st.tuples(st.floats(4, 16), st.floats(-8, 8), st.floats(0.3, 1.5), angle, st.integers(3, 7)),
    max_size=6,
)


@settings(max_examples=25)
@given(crowds, st.tuples(st.floats(18, 22), st.floats(-5, 5), angle))
def test_paths_through_random_crowds_keep_their_margin(crowd, goal):
    car = vehicle("paper")
    workspace = ConvexPolygon.rectangle(-7, 30, -12, 12)
    obstacles = []
    for x, y, size, turn, corners in crowd:
        around = turn + 2 * np.pi * np.arange(corners) / corners
        obstacles.append(ConvexPolygon.from_vertices(np.c_[x + size * np.cos(around), y + size * np.sin(around)]))
    result = search(workspace, obstacles, car, (0, 0, 0), goal, HybridAStarOptions(margins=(0.05,), time_limit=2))
    if result.path is None:
        assert result.status is not SearchStatus.FOUND
        return
    body = car.parts[0].polygon
    fine = Path.from_arcs((0, 0, 0), result.path.arcs, 0.05)
    bodies = [body.transformed(*at).to_shapely() for at in fine.poses]
    assert (shapely.get_coordinates(bodies) @ workspace.A.T <= workspace.b + 3e-3).all()
    for obstacle in obstacles:
        assert shapely.distance(bodies, obstacle.to_shapely()).min() >= 0.05 - 3e-3
