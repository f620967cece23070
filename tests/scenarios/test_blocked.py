"""What frees a blocked start or goal, judged with shapely alone: every remedy cures, no smaller one does."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import shapely
from shapely import Polygon, affinity

from tightspot.errors import BlockedError, SceneError
from tightspot.geometry import ConvexPolygon
from tightspot.scenarios import Obstacle, Scenario, blocked, check
from tightspot.vehicles import VehicleModel, narrowed, vehicle

PAPER = vehicle("paper")  # body x in [-0.929, 3.699], y in [-1.0485, 1.0485]
MARGIN = 0.05


def ring(x_min: float, x_max: float, y_min: float, y_max: float) -> list[list[float]]:
    return [[x_min, y_min], [x_max, y_min], [x_max, y_max], [x_min, y_max]]


def scene(rings: dict[str, Any], goal: tuple[float, float, float] = (0, 0, 0), **more: Any) -> Scenario:
    workspace = more.pop("workspace", ConvexPolygon.rectangle(-20, 20, -20, 20))
    return Scenario(
        name="test",
        workspace=workspace,
        obstacles=tuple(Obstacle(name, corners) for name, corners in rings.items()),
        start=[-12, -12, 0, 0, 0],
        goal=[*goal, 0, 0],
        **more,
    )


def pocket(width: float) -> Scenario:
    """A bay from the right between two blocks, closed at its left end, with the goal in its middle."""
    half = width / 2
    blocks = {"upper": ring(-2, 6, half, half + 3), "lower": ring(-2, 6, -half - 3, -half)}
    return scene(blocks | {"end": ring(-3, -2, -6, 6)})


def moved(scenario: Scenario, angle: float, x: float, y: float, mirror: bool = False) -> Scenario:
    """The scene turned about the origin, shifted, and mirrored at the x axis before that if wanted."""
    sign = -1.0 if mirror else 1.0
    R = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])

    def place(points: Any) -> Any:
        return (np.asarray(points) * [1.0, sign]) @ R.T + [x, y]

    def state(given: Any) -> Any:
        return [*place(given[:2]), sign * given[2] + angle, *given[3:]]

    return scenario.with_(
        workspace=ConvexPolygon.from_vertices(place(scenario.workspace.vertices)),
        obstacles=tuple(Obstacle(o.name, place(o.exterior)) for o in scenario.obstacles),
        start=state(scenario.start),
        goal=state(scenario.goal),
    )


def footprint(car: VehicleModel, x: float, y: float, theta: float) -> Any:
    parts = shapely.union_all([Polygon(part.polygon.vertices) for part in car.parts])
    return affinity.translate(affinity.rotate(parts, theta, origin=(0, 0), use_radians=True), x, y)


def is_free(scenario: Scenario, car: VehicleModel, pose: Any, margin: float = MARGIN, slack: float = 1e-7) -> bool:
    body = footprint(car, *pose[:3])
    obstacles = [Polygon(obstacle.exterior, obstacle.holes) for obstacle in scenario.obstacles]
    inside = Polygon(scenario.workspace.vertices).buffer(slack).contains(body)
    return inside and all(body.distance(obstacle) >= margin - slack for obstacle in obstacles)


def clutter(seed: int, car: str) -> Scenario:
    """A goal among quadrangles, some of them over it."""
    rng = np.random.default_rng(seed)
    rings = {}
    for index in range(6):
        centre, angles = rng.uniform(-4, 5, 2), np.sort(rng.uniform(0, 2 * np.pi, 5))
        corners = centre + rng.uniform(0.3, 1.2) * np.column_stack([np.cos(angles), np.sin(angles)])
        rings[f"o{index}"] = shapely.get_coordinates(shapely.MultiPoint(corners).convex_hull)[:-1]
    walls = ConvexPolygon.rectangle(-6, 7, -5, rng.uniform(1, 6))
    scenario = scene(rings, (0, 0, rng.uniform(-3, 3)), workspace=walls, vehicle=car)
    return scenario.with_(start=[30, 30, 0, 0, 0])


@pytest.mark.parametrize("car", ["paper", "forklift", "obca"])
@pytest.mark.parametrize("seed", range(8))
def test_every_remedy_cures_and_no_smaller_one_does(seed: int, car: str) -> None:
    scenario, model = clutter(seed, car), vehicle(car)
    found = blocked(scenario, model, MARGIN, "goal")
    if found is None:
        assert is_free(scenario, model, scenario.goal)
        return
    pose = scenario.goal[:3]
    assert not is_free(scenario, model, pose)
    if found.move is not None:
        assert is_free(scenario, model, pose + np.array([*found.move, 0]))
    length = math.inf if found.move is None else math.hypot(*found.move) - 0.004
    for radius in np.linspace(0.02, 4.0, 30):
        for angle in np.linspace(0, 2 * np.pi, 24):
            if radius < length:
                step = [radius * math.cos(angle), radius * math.sin(angle), 0]
                assert not is_free(scenario, model, pose + step), "a shorter move would do"
    largest = math.pi if found.turn is None else abs(found.turn) - math.radians(0.11)
    if found.turn is not None:
        assert is_free(scenario, model, pose + np.array([0, 0, found.turn]))
    for angle in np.radians(np.arange(0.5, 180, 2.5)):
        if angle < largest:
            assert not is_free(scenario, model, pose + np.array([0, 0, angle]))
            assert not is_free(scenario, model, pose - np.array([0, 0, angle]))
    if found.width is not None:
        factor = found.width / found.width_now
        assert 0.5 <= factor < 1
        assert is_free(scenario, narrowed(model, factor), pose)
        assert not is_free(scenario, narrowed(model, factor + 0.002), pose)


@pytest.mark.parametrize("shortage", [0.01, 0.05, 0.2])
@pytest.mark.parametrize("place", [(0, 0, 0), (0.7, 3, -2), (-2.5, 1e6, -1e6)])
@pytest.mark.parametrize("mirror", [False, True])
def test_a_pocket_too_narrow_says_which_width_it_takes(shortage: float, place: Any, mirror: bool) -> None:
    width = 2.097 + 2 * MARGIN - shortage
    scenario = moved(pocket(width), *place, mirror=mirror)
    found = blocked(scenario, PAPER, MARGIN, "goal")
    assert found is not None
    assert {item.obstacle for item in found.obstacles} == {"upper", "lower"}
    assert found.width == pytest.approx(2.097 - shortage, abs=1.1e-3)
    assert found.move is not None
    assert is_free(scenario, PAPER, scenario.goal[:3] + np.array([*found.move, 0]), slack=1e-6)
    if shortage < 2 * MARGIN:
        assert found.depth == 0
        assert found.margin_that_fits == pytest.approx(MARGIN - shortage / 2, abs=1.1e-3)
        check(scenario, PAPER, found.margin_that_fits)
    else:
        assert found.depth == pytest.approx(shortage / 2 - MARGIN, abs=1e-6)
        assert found.margin_that_fits is None
    assert f"{found.width:.3f} m wide (now 2.097 m)" in found.remedy


def test_several_faults_are_named_and_one_move_cures_them_all() -> None:
    blocks = {"left": ring(1, 2, 0.9, 3), "front": ring(3.6, 5, -2, 2)}
    scenario = scene(blocks, workspace=ConvexPolygon.rectangle(-20, 20, -20, 1.0), vehicle="paper")
    with pytest.raises(BlockedError) as caught:
        check(scenario, PAPER, MARGIN)
    messages = [problem.message for problem in caught.value.problems]
    assert len(messages) == 3
    assert any("'left'" in message for message in messages)
    assert any("'front' by 0.099 m" in message for message in messages)
    assert any("upper (+y) side" in message for message in messages)
    (end,) = caught.value.ends
    assert (end.end, end.side) == ("goal", "upper (+y)")
    assert end.outside == pytest.approx(0.0485)
    assert end.depth == pytest.approx(1.0485 - 0.9)
    assert is_free(scenario, PAPER, scenario.goal[:3] + np.array([*end.move, 0]))
    check(scenario.with_(goal=scenario.goal + np.array([*end.move, 0, 0, 0])), PAPER, MARGIN)


def test_an_inescapable_heading_is_said_and_a_turn_offered() -> None:
    slot = {"left": ring(-20, -1.2, -20, 20), "right": ring(1.2, 20, -20, 20)}
    scenario = scene(slot).with_(start=[0, -12, math.pi / 2, 0, 0])
    found = blocked(scenario, PAPER, MARGIN, "goal")
    assert found is not None
    assert found.move is None
    assert found.turn is not None
    assert abs(abs(found.turn) - math.pi / 2) < 0.1
    assert "no other place in the workspace would do with this heading" in found.remedy


def test_a_part_of_the_body_is_named() -> None:
    forklift = vehicle("forklift")
    scenario = scene({"pallet": ring(2.5, 3.5, 0.25, 1.5)}, vehicle="forklift")
    found = blocked(scenario, forklift, MARGIN, "goal")
    assert found is not None
    assert [(item.obstacle, item.part) for item in found.obstacles] == [("pallet", "left tine")]
    data = found.to_dict()
    assert data["obstacles"] == [{"name": "pallet", "part": "left tine", "clearance": pytest.approx(-0.11)}]
    assert data["workspace_side"] is None


def test_a_vehicle_larger_than_the_workspace_fits_nowhere() -> None:
    small = scene({}, workspace=ConvexPolygon.rectangle(-1, 1, -1, 1))
    found = blocked(small, PAPER, 0.0, "goal")
    assert found is not None
    assert (found.move, found.turn, found.margin_that_fits) == (None, None, None)
    assert "fits nowhere" in found.remedy


def test_limits_alone_are_no_blocked_pose() -> None:
    fast = scene({}).with_(goal=[0, 0, 0, 9, 0])
    with pytest.raises(SceneError) as caught:
        check(fast, PAPER, MARGIN)
    assert not isinstance(caught.value, BlockedError)


@pytest.mark.parametrize("car", ["paper", "forklift"])
@pytest.mark.parametrize(
    "corners",
    [
        [[-4, -6], [8, -6], [8, -5], [1, -5], [1, -0.5], [0, -0.5], [0, -5], [-4, -5]],  # a comb with one tooth
        [[1, -3], [6, -3], [6, 3], [1, 3], [1, 2], [2, 2], [2, -2], [1, -2]],  # a bracket around the front
        [[2, 0.4], [2.5, 1.1], [3.6, 0.7], [3.2, -0.1], [2.6, 0.45]],
    ],
)
def test_the_depth_is_that_of_the_whole_obstacle(corners: Any, car: str) -> None:
    scenario = scene({"thing": corners}, goal=(0.3, 0.1, 0.2))
    found = blocked(scenario, vehicle(car), MARGIN, "goal")
    assert found is not None
    body, thing = footprint(vehicle(car), *scenario.goal[:3]), Polygon(corners)
    assert body.intersects(thing)

    def overlaps(distance: float) -> list[bool]:
        angles = np.linspace(0.0, 2 * np.pi, 1441)
        moves = [affinity.translate(body, distance * math.cos(a), distance * math.sin(a)) for a in angles]
        return [move.intersection(thing).area > 0 for move in moves]

    assert all(overlaps(found.depth - 1e-3)), "no shorter way leads out"
    assert not all(overlaps(found.depth + 2e-3)), "this far does"
    assert found.overlapped[0].obstacle == "thing"
