"""CommonRoad scenarios from elsewhere: shapes, poses, reference points, planning problems, roads, what moves."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import shapely
from shapely import affinity

from tightspot.errors import InputError, SceneError
from tightspot.scenarios import Scenario
from tightspot.scenarios.readers.commonroad import read_commonroad, reference_offset
from tightspot.scenarios.readers.commonroad.shapes import CIRCLE_TOLERANCE
from tightspot.vehicles import vehicle

from .commonroad_text import (
    circle,
    exact,
    goal,
    interval,
    lanelet,
    moving,
    polygon,
    problem,
    rectangle,
    scenario,
    state,
    static,
)

Read = Callable[..., Scenario]
BMW = "commonroad-bmw-320i"


@pytest.fixture
def read(tmp_path) -> Read:
    def read(*parts: str, text: str | None = None, **options: Any) -> Scenario:
        path = tmp_path / "scene.xml"
        path.write_text(text or scenario(*parts), encoding="utf-8")
        return read_commonroad(path, **options)

    return read


def area(scene: Scenario, index: int = 0) -> shapely.Polygon:
    obstacle = scene.obstacles[index]
    return shapely.Polygon(obstacle.exterior + scene.offset, [hole + scene.offset for hole in obstacle.holes])


def same(one: shapely.Polygon, other: shapely.Polygon) -> bool:
    return bool(one.symmetric_difference(other).area < 1e-9)


def test_a_parked_car_stands_where_its_initial_state_says(read):
    scene = read(static(12, rectangle(4.2, 1.9), state(9, -7, 0.7)))
    expected = affinity.translate(affinity.rotate(shapely.box(-2.1, -0.95, 2.1, 0.95), 0.7, (0, 0), True), 9, -7)
    assert same(area(scene), expected)
    assert scene.obstacles[0].name == "parkedVehicle-12"


def test_a_rectangle_s_own_orientation_adds_to_the_obstacle_s(read):
    scene = read(static(12, rectangle(4, 2, (0, 0), 0.4), state(9, -7, 0.3)))
    expected = affinity.translate(affinity.rotate(shapely.box(-2, -1, 2, 1), 0.7, (0, 0), True), 9, -7)
    assert same(area(scene), expected)


def test_a_polygon_at_the_origin_is_read_bit_for_bit(read):
    corners = [(9.1, 0.1 + 0.2), (1e-7, 17.3), (5.5, -3.0), (12.25, -8.0)]
    scene = read(static(12, polygon(*corners)))
    assert scene.obstacles[0].exterior.tolist() == [list(corner) for corner in corners]


@pytest.mark.parametrize("radius", [1e-3, 0.2, 1.0, 5.0, 30.0, 200.0])
def test_a_circle_is_covered_within_the_stated_tolerance(radius, read):
    centre = np.array([500.0, 40.0])
    scene = read(static(12, circle(radius), state(*centre)))
    ring = scene.obstacles[0].exterior
    beyond = np.hypot(*(ring - centre).T) - radius
    inside = shapely.Polygon(ring).exterior.distance(shapely.Point(centre)) - radius
    assert -1e-9 <= inside < 1e-6, "its edges touch the circle from outside"
    assert beyond.max() <= CIRCLE_TOLERANCE * (1 + 1e-6) or (len(ring) == 128 and beyond.max() < 0.07)


def test_groups_and_environment_obstacles_are_read_part_by_part(read):
    shape = f"<type>building</type><shape>{rectangle(2, 2, (30, 9), 0)}</shape>"
    house = f'<environmentObstacle id="7">{shape}</environmentObstacle>'
    group = f"<shapeGroup><shape>{circle(1)}</shape><shape>{rectangle(2, 1)}</shape></shapeGroup>"
    scene = read(house, static(12, rectangle(4, 2) + group, state(9, -7, 0)))
    assert [o.name for o in scene.obstacles] == ["building-7", *(f"parkedVehicle-12/{i}" for i in range(3))]
    assert same(area(scene), shapely.box(29, 8, 31, 10))
    assert same(area(scene, 3), shapely.box(8, -7.5, 10, -6.5))


def test_where_commonroad_s_programs_disagree_both_places_are_taken(read):
    corners = [(0, 0), (4, 0), (4, 2), (0, 2)]
    scene = read(static(12, polygon(*corners), state(20, -20, 0.5)))
    shape = shapely.Polygon(corners)
    about_origin = affinity.translate(affinity.rotate(shape, 0.5, (0, 0), True), 20, -20)
    about_centre = affinity.translate(affinity.rotate(shape, 0.5, "centroid", True), 20, -20)
    assert same(area(scene, 0), about_origin)
    assert same(area(scene, 1), about_centre)
    assert "both places are taken" in scene.description
    assert len(read(static(12, polygon(*corners), state(20, -20, 0))).obstacles) == 1


def test_the_2018b_form_of_an_obstacle_is_read(read):
    old = f"<role>static</role><type>car</type><shape>{rectangle(4, 2)}</shape>{state(9, 5, 0)}"
    scene = read(text=scenario(f'<obstacle id="4">{old}</obstacle>', version="2018b"))
    assert same(area(scene), shapely.box(7, 4, 11, 6))


MOVER = moving(33, (9, 9, 0), (9.5, 9, 0), (10, 9, 0))


def test_what_moves_is_refused_with_the_remedies(read, problems):
    parked = moving(34, (9, -9, 0), (9, -9, 0))
    found = problems(lambda: read(MOVER, parked))
    assert list(found) == ["dynamicObstacle"]
    for words in ("1 obstacle is (33) moving", "--moving initial", 'moving="ignore"'):
        assert words in found["dynamicObstacle"]


def test_what_moves_may_stand_or_be_left_out_and_the_scene_says_so(read):
    standing = read(MOVER, moving="initial")
    assert same(area(standing), shapely.box(7, 8, 11, 10))
    assert "read as standing where they begin" in standing.description
    gone = read(MOVER, moving="ignore")
    assert gone.obstacles == ()
    assert "left out" in gone.description


def test_a_dynamic_obstacle_whose_trajectory_stands_is_parked(read):
    scene = read(moving(34, (9, -9, 0), (9, -9, 0), (9, -9, 0)))
    assert same(area(scene), shapely.box(7, -10, 11, -8))
    assert "moving" not in scene.description


def test_sets_of_positions_count_as_moving(read, problems):
    spread = f"<occupancySet><occupancy><shape>{circle(1, (8, 8))}</shape>{exact('time', 1)}</occupancy></occupancySet>"
    phantom = f'<phantomObstacle id="9">{spread}</phantomObstacle>'
    assert "(9) moving" in problems(lambda: read(phantom))["dynamicObstacle"]
    assert area(read(phantom, moving="initial")).centroid.distance(shapely.Point(8, 8)) < 1e-9


def test_the_start_is_the_rear_axle_of_the_vehicle_whose_centre_is_given(read):
    centre, theta = np.array([3.0, -2.0]), 0.8
    problems = problem(start=state(*centre, theta, more=exact("velocity", 1.5)))
    for name in (BMW, "commonroad-truck", "tpcap"):
        scene = read(text=scenario(problems=problems), vehicle=name)
        body = shapely.unary_union([part.polygon.to_shapely() for part in vehicle(name).parts])
        x, y, heading, v, delta = scene.start
        placed = affinity.translate(affinity.rotate(body, heading, (0, 0), True), x, y)
        assert placed.centroid.distance(shapely.Point(centre)) < 1e-12
        assert (heading, v, delta) == (theta, 1.5, 0.0)
        assert scene.vehicle == name


def test_the_reference_point_can_be_the_rear_axle(read):
    text = scenario(problems=problem(start=state(3.0, -2.0, 0.8)))
    assert read(text=text, reference="rear-axle").start[:2].tolist() == [3.0, -2.0]
    offset = reference_offset(vehicle(BMW), "centre")
    moved = read(text=text, reference="centre").start[:2] - [3.0, -2.0]
    assert moved == pytest.approx(-offset[0] * np.array([math.cos(0.8), math.sin(0.8)]))
    assert offset[0] == pytest.approx(1.4227170936), "the distance from centre of gravity to rear axle"
    with pytest.raises(InputError, match="it is centre or rear-axle"):
        read(text=text, reference="front")


def test_a_yaw_rate_or_a_steering_angle_gives_the_wheels(read):
    driving = exact("velocity", 2.0) + exact("yawRate", 0.3)
    bmw = vehicle(BMW)
    scene = read(text=scenario(problems=problem(start=state(more=driving))))
    assert 2.0 * math.tan(scene.start[4]) / bmw.wheelbase == pytest.approx(0.3)
    scene = read(text=scenario(problems=problem(start=state(more=driving + exact("steeringAngle", -0.25)))))
    assert scene.start[4] == -0.25


def test_planning_problems_are_chosen_by_id(read, problems):
    text = scenario(problems=problem(5) + problem(8, start=state(1, 1, 0)))
    first, second = read(text=text), read(text=text, problem=8)
    assert "Planning problem 5 was taken; there are also 8." in first.description
    assert second.start[1] == 1
    assert "Planning problem" not in second.description
    assert "planning problem 8, time step 0.1 s" in second.source
    assert "there are 5, 8" in problems(lambda: read(text=text, problem=6))["planningProblem"]


def inside(scene: Scenario, region: shapely.Geometry, headings: tuple[float, float], name: str = BMW) -> bool:
    """Whether every pose within the scene's tolerances has its centre in the region and its heading in the interval."""
    offset = reference_offset(vehicle(name), "centre")[0]
    goal, tolerance = scene.goal, scene.tolerance
    for turn in np.linspace(-tolerance.heading, tolerance.heading, 9):
        theta = goal[2] + turn
        if not headings[0] - 1e-9 <= theta <= headings[1] + 1e-9:
            return False
        centre = goal[:2] + offset * np.array([math.cos(theta), math.sin(theta)])
        if not region.buffer(1e-5).contains(shapely.Point(centre).buffer(tolerance.position)):
            return False
    return True


@pytest.mark.parametrize(
    ("shape", "region"),
    [
        (circle(1, (20, 3)), shapely.Point(20, 3).buffer(1, 256)),
        (circle(0.05, (20, 3)), shapely.Point(20, 3).buffer(0.05, 256)),
        (rectangle(6, 3, (20, 3), 0.4), affinity.rotate(shapely.box(17, 1.5, 23, 4.5), 0.4, "center", True)),
        (polygon((18, 0), (24, 0), (24, 6), (18, 6)), shapely.box(18, 0, 24, 6)),
        (polygon((18, 0), (26, 0), (26, 1), (19, 1), (19, 9), (18, 9)), None),
    ],
)
def test_every_pose_within_the_tolerances_is_in_the_goal(shape, region, read):
    scene = read(text=scenario(problems=problem(goals=goal(shape, interval("orientation", 0.1, 0.5)))))
    if region is None:  # an L, whose centroid is outside
        region = shapely.Polygon([(18, 0), (26, 0), (26, 1), (19, 1), (19, 9), (18, 9)])
    assert scene.goal[2] == pytest.approx(0.3)
    assert inside(scene, region, (0.1, 0.5))
    assert np.isnan(scene.goal[4])
    assert "between 0 s and 9.9 s; durations are free here" in scene.description


def test_a_lanelet_as_goal_is_its_middle_along_its_direction(read):
    road = lanelet(3, [(10, 2), (20, 12)], [(12, 0), (22, 10)])
    scene = read(text=scenario(road, problems=problem(goals=goal('<lanelet ref="3"/>', ""))))
    direction = np.array([math.cos(scene.goal[2]), math.sin(scene.goal[2])])
    assert scene.goal[2] == pytest.approx(math.pi / 4)
    assert scene.goal[:2] + reference_offset(vehicle(BMW), "centre")[0] * direction == pytest.approx([16, 6])
    assert scene.tolerance.position <= math.sqrt(2)


@pytest.mark.parametrize(
    ("velocity", "expected", "slack"),
    [
        ("", 0.0, 0.01),
        (interval("velocity", -1, 3), 0.0, 1.0),
        (interval("velocity", 0, 3), 0.0, 1e-6),
        (interval("velocity", 2, 3), 2.5, 0.5),
    ],
)
def test_the_goal_s_speed_is_standing_if_the_file_allows_it(velocity, expected, slack, read):
    scene = read(text=scenario(problems=problem(goals=goal(more=velocity))))
    assert scene.goal[3] == expected
    assert scene.tolerance.speed == pytest.approx(slack)


def test_a_free_orientation_takes_the_region_s_or_the_start_s(read):
    lying = read(text=scenario(problems=problem(goals=goal(rectangle(6, 3, (20, 3), 0.4), ""))))
    assert lying.goal[2] == pytest.approx(0.4)
    round_one = read(text=scenario(problems=problem(start=state(0, 0, 1.1), goals=goal(more=""))))
    assert round_one.goal[2] == pytest.approx(1.1)
    assert "orientation is free" in round_one.description


ROAD = (
    lanelet(1, [(-10, 4), (30, 4)], [(-10, 0), (30, 0)]),
    lanelet(2, [(-10, -0.005), (30, -0.005)], [(-10, -4), (30, -4)]),
)


def test_the_road_is_no_boundary_unless_that_is_asked_for(read):
    plain = read(*ROAD)
    assert plain.obstacles == ()
    assert "The 2 lanelets are no boundary here" in plain.description
    scene = read(*ROAD, lanelets="boundary")
    assert scene.workspace.to_shapely().equals(shapely.box(-10, -4, 30, 4))
    assert scene.obstacles == (), "the gap of 5 mm between the lanes belongs to the road"


def test_beside_the_road_are_obstacles(read):
    side = lanelet(3, [(8, 4), (8, 20)], [(12, 4), (12, 20)])
    scene = read(*ROAD, side, lanelets="boundary")
    road = shapely.union_all([shapely.box(-10, -4, 30, 4), shapely.box(8, 4, 12, 20)])
    blocked = shapely.union_all([area(scene, i) for i in range(len(scene.obstacles))])
    assert same(blocked, road.envelope.difference(road))
    assert same(scene.workspace.to_shapely(), road.envelope)


def test_a_road_without_lanelets_is_no_road(read, problems):
    assert "there is none" in problems(lambda: read(lanelets="boundary"))["lanelet"]


def test_unknown_policies_are_refused_with_those_there_are(read):
    for option in ("moving", "lanelets"):
        with pytest.raises(InputError, match="ignore"):
            read(**{option: "maybe"})


def test_all_problems_are_told_at_once_with_their_places(read, problems):
    found = problems(
        lambda: read(
            static(12, rectangle("wide", 2)),
            static(13, circle(-1)),
            static(14, polygon((0, 0), (1, 1))),
            static(15, "<truckShape/>"),
            static(16, rectangle(4, 2), state(theta="north")),
            MOVER,
            text=None,
        )
    )
    assert found["staticObstacle[12].shape.rectangle.length"] == "'wide' is not a finite number"
    assert "must be more than 0" in found["staticObstacle[13].shape.circle.radius"]
    assert "needs at least 3" in found["staticObstacle[14].shape.polygon"]
    assert "write it as one of rectangle, circle, polygon" in found["staticObstacle[15].shape.truckShape"]
    assert "'north'" in found["staticObstacle[16].initialState.orientation.exact"]
    assert "dynamicObstacle" in found


def test_a_polygon_that_is_none_is_told_by_its_obstacle(read, problems):
    found = problems(lambda: read(static(8, rectangle(1, 1)), static(12, polygon((30, 0), (31, 1), (31, 0), (30, 1)))))
    assert list(found) == ["staticObstacle[12].vertices"]


@pytest.mark.parametrize(
    ("text", "path", "words"),
    [
        (scenario(problems=""), "", "has no planningProblem"),
        (scenario(problems=problem(goals=goal(position=""))), "planningProblem[5].goalState", "has no position"),
        (scenario(problems=problem(goals=goal('<lanelet ref="77"/>'))), "lanelet", "'77', which is not in the file"),
        (
            scenario(problems=problem(goals=goal(more=interval("orientation", 1, -1)))),
            "goalState.orientation",
            "ends at -1 before it begins at 1",
        ),
        (
            scenario(problems='<planningProblem id="5"><initialState/></planningProblem>'),
            "planningProblem[5]",
            "has no goalState",
        ),
        (scenario(problems=problem(start=state(0, 0, 90))), "initialState.orientation", "90 deg = 1.5708 rad"),
        (scenario(dt="-1"), "timeStepSize", "not a time above 0 s"),
        (scenario(dt="nan"), "timeStepSize", "not a time above 0 s"),
        (scenario(version="2017a"), "scene.xml", "2020a and 2018b are read"),
        ("<CommonRoadSolution/>", "scene.xml", "give the scenario it solves"),
        ("<svg/>", "scene.xml", "holds <svg>, not a CommonRoad scenario"),
    ],
)
def test_what_cannot_be_a_scene_says_why(text, path, words, read):
    with pytest.raises(SceneError) as caught:
        read(text=text)
    (found,) = caught.value.problems
    assert path in found.path
    assert words in found.message


def test_coordinates_far_from_the_origin_are_recentred(read):
    start, corners = state(4.5e9, -3e8, 0.3), [(4.5e9 + 9, -3e8), (4.5e9 + 12, -3e8), (4.5e9 + 12, -3e8 + 2)]
    text = scenario(
        static(3, polygon(*corners)), problems=problem(start=start, goals=goal(circle(1, (4.5e9 + 30, -3e8))))
    )
    scene = read(text=text, reference="rear-axle")
    assert np.abs(scene.start[:2]).max() < 1
    assert (scene.obstacles[0].exterior + scene.offset).tolist() == [list(corner) for corner in corners]
