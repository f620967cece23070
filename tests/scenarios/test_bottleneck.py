"""The proof that there is no way, against a flood fill; the narrowest place, against the gap that was built."""

from __future__ import annotations

import math
from collections import deque
from typing import Any

import numpy as np
import pytest
import shapely

from tightspot.geometry import ConvexPolygon
from tightspot.scenarios import Bottleneck, Obstacle, Scenario, bottleneck, builtin, names
from tightspot.scenarios.bottleneck import is_closed
from tightspot.vehicles import vehicle

PAPER = vehicle("paper")
WIDTH = 2.097
MARGIN = 0.05


def gap(width: float, place: tuple[float, float, float] = (0, 0, 0), **rings: Any) -> Scenario:
    """A corridor with a gap between ``left`` and ``right`` at x = 6 to 9, turned and shifted."""
    x, y, angle = place
    R = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])

    def at(points: Any) -> Any:
        return np.asarray(points, float) @ R.T + [x, y]

    def ring(x_min: float, x_max: float, y_min: float, y_max: float) -> Any:
        return at([[x_min, y_min], [x_max, y_min], [x_max, y_max], [x_min, y_max]])

    shapes = {"left": (6, 9, width / 2, 4), "right": (6, 9, -4, -width / 2), **rings}
    return Scenario(
        name="gap",
        workspace=ConvexPolygon.from_vertices(ring(-3, 20, -4, 4)),
        obstacles=tuple(Obstacle(name, ring(*sides)) for name, sides in shapes.items()),
        start=[*at([0, 0]), angle, 0, 0],
        goal=[*at([13, 0]), angle, 0, 0],
    )


@pytest.mark.parametrize("place", [(0, 0, 0), (3, -7, 2.1), (1e6, -2e6, 0.4)])
@pytest.mark.parametrize("shortage", [0.01, 0.05, 0.2, 1.0])
def test_a_gap_too_narrow_is_proved_placed_and_measured(shortage: float, place: tuple[float, float, float]) -> None:
    width = WIDTH + 2 * MARGIN - shortage
    scenario = gap(width, place)
    found = bottleneck(scenario, PAPER, MARGIN)
    assert isinstance(found, Bottleneck)
    assert found.needed == pytest.approx(WIDTH)
    assert found.room == pytest.approx(width - 2 * MARGIN, abs=2e-3)
    assert set(found.between) == {"left", "right"}
    x, y, angle = place
    back = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    along, across = back @ (found.place - [x, y])
    assert 6 <= along <= 9
    assert across == pytest.approx(0, abs=0.01)
    words = found.describe(scenario.offset)
    assert "between 'left' and 'right'" in words
    assert "the body needs 2.097 m" in words


@pytest.mark.parametrize("spare", [0.002, 0.05, 1.0])
def test_a_gap_wide_enough_is_no_bottleneck(spare: float) -> None:
    assert bottleneck(gap(WIDTH + 2 * MARGIN + spare), PAPER, MARGIN) is None


@pytest.mark.parametrize("name", names())
def test_scenes_that_can_be_planned_have_none(name: str) -> None:
    scenario = builtin(name)
    assert bottleneck(scenario, scenario.vehicle_model(), scenario.margin) is None


def test_the_largest_open_margin_is_exact() -> None:
    scenario = gap(2.15)
    found = bottleneck(scenario, PAPER, MARGIN)
    assert found is not None
    assert found.margin == pytest.approx((2.15 - WIDTH) / 2, abs=1e-3)
    assert not is_closed(scenario, PAPER, found.margin)
    assert is_closed(scenario, PAPER, found.margin + 0.001)
    none = bottleneck(gap(2.0), PAPER, MARGIN)
    assert none is not None
    assert none.margin is None


def test_a_wall_closes_the_way_whatever_the_width() -> None:
    scenario = gap(4.0, bar=(11, 11.2, -4.1, 4.1))
    found = bottleneck(scenario, PAPER, MARGIN)
    assert found is not None
    assert found.room == 0
    np.testing.assert_allclose(found.place, [11.1, 0.0], atol=0.01)
    assert found.describe(np.array([100.0, 0.0])) == "the way is closed by 'bar' near (111.10, 0.00)"
    assert found.to_dict(np.array([100.0, 0.0]))["place"] == pytest.approx([111.1, 0.0], abs=0.01)


def test_the_first_of_two_places_is_told() -> None:
    """Two equally narrow gaps one after the other: the nearer one to the start."""
    two = gap(2.0, upper=(12, 14, 1.0, 4), lower=(12, 14, -4, -1.0)).with_(goal=[16, 0, 0, 0, 0])
    found = bottleneck(two, PAPER, MARGIN)
    assert found is not None
    assert 6 <= found.place[0] <= 9


def test_a_body_of_parts_needs_room_for_its_largest() -> None:
    """The chassis is 1.2 m wide, the tines are 0.14 m each."""
    assert not is_closed(gap(1.31), vehicle("forklift"), MARGIN)
    found = bottleneck(gap(1.25), vehicle("forklift"), MARGIN)
    assert found is not None
    assert found.needed == pytest.approx(1.2)


def flooded(scenario: Scenario, radius: float, step: float) -> bool:
    """Whether a point gets from start to goal on a grid, ``radius`` away from obstacles and W's border."""
    car = PAPER.parts[0].polygon
    centre = (car.vertices.min(axis=0) + car.vertices.max(axis=0)) / 2
    ends = [state[:2] + centre for state in (scenario.start, scenario.goal)]
    low, high = scenario.workspace.vertices.min(axis=0), scenario.workspace.vertices.max(axis=0)
    x, y = np.arange(low[0], high[0], step), np.arange(low[1], high[1], step)
    points = shapely.points(*np.meshgrid(x, y, indexing="ij"))
    taken = shapely.union_all([shapely.Polygon(obstacle.exterior) for obstacle in scenario.obstacles])
    border = shapely.boundary(shapely.Polygon(scenario.workspace.vertices))
    shapely.prepare([taken, border])
    free = (shapely.distance(points, taken) >= radius + MARGIN) & (shapely.distance(points, border) >= radius)
    start, goal = (tuple(np.round((end - low) / step).astype(int)) for end in ends)
    free[start] = free[goal] = True
    queue, seen = deque([start]), {start}
    while queue:
        i, j = queue.popleft()
        for cell in ((i + a, j + b) for a in (-1, 0, 1) for b in (-1, 0, 1)):
            if cell not in seen and 0 <= cell[0] < len(x) and 0 <= cell[1] < len(y) and free[cell]:
                seen.add(cell)
                queue.append(cell)
    return goal in seen


@pytest.mark.parametrize("seed", range(12))
def test_closed_means_closed_for_a_flood_fill_and_open_means_open(seed: int) -> None:
    """On a grid of 10 cm: a way found there is a way; without one even for a disc 15 cm smaller there is none."""
    rng = np.random.default_rng(seed)
    obstacles = []
    for index in range(9):
        corners = np.array([rng.uniform(3.9, 9.1), rng.uniform(-5, 5)]) + rng.normal(0, 0.8, (6, 2))
        hull = shapely.get_coordinates(shapely.MultiPoint(corners).convex_hull)[:-1]
        if hull[:, 0].min() > 3.8 and hull[:, 0].max() < 11.9:
            obstacles.append(Obstacle(f"o{index}", hull))
    scenario = Scenario(
        name="clutter",
        workspace=ConvexPolygon.rectangle(-1.5, 18, -5, 5),
        obstacles=tuple(obstacles),
        start=[0, 0, 0, 0, 0],
        goal=[13, 0, 0, 0, 0],
    )
    closed = is_closed(scenario, PAPER, MARGIN)
    if flooded(scenario, WIDTH / 2, 0.1):
        assert not closed
    if not flooded(scenario, WIDTH / 2 - 0.15, 0.1):
        assert closed
