"""Each kind of failure has a scene, a sentence that names what to change, and numbers that shapely confirms."""

from __future__ import annotations

import json
import re
from typing import Any

import numpy as np
import pytest
import shapely

import tightspot
from tightspot.errors import BlockedError, InputError, PlanningError, SceneError
from tightspot.guesses import HybridAStar
from tightspot.planner import Explanation, FailureKind
from tightspot.planner.request import resolve
from tightspot.planner.sentences import solver_words
from tightspot.planner.solver_stop import SolverStop, WorstConstraint
from tightspot.scenarios import Scenario, builtin
from tightspot.scenarios.labels import labels
from tightspot.search import COARSE, HybridAStarOptions
from tightspot.solvers import Ipopt, SolveStatus
from tightspot.verification import Witness

from .scenes import MARGIN, WIDTH, alley, box, clearance, footprint, gap

QUICK = HybridAStar(HybridAStarOptions(resolutions=(COARSE,), margins=(MARGIN,)))
LIMITED = HybridAStar(HybridAStarOptions(resolutions=(COARSE,), margins=(MARGIN,), max_expansions=20))


def why(scenario: Scenario | str, **options: Any) -> Explanation:
    """The explanation of the failure that planning must end in; as data it is JSON."""
    with pytest.raises((PlanningError, BlockedError)) as failure:
        tightspot.plan(scenario, **options)
    explanation = failure.value.explanation
    assert isinstance(explanation, Explanation)
    data = json.loads(json.dumps(explanation.to_dict(), allow_nan=False))
    assert data["kind"] == explanation.kind.word
    assert explanation.sentence in str(explanation)
    if isinstance(failure.value, PlanningError):
        assert failure.value.reason == f"{explanation.sentence} {explanation.remedy}"
    for text in (explanation.sentence, explanation.remedy):
        assert text[0].isupper()
        assert text.endswith(".")
        assert "\n" not in text
        assert ".." not in text
    return explanation


def test_of_two_obstacles_at_the_same_body_the_body_is_named_once() -> None:
    found = why(gap(3.0, box("post", 3, 3.5, -1, 1), box("bin", -0.5, 0.0, -1, 1)))
    assert found.sentence.count("the vehicle's body") == 1
    assert "obstacle 'post'" in found.sentence
    assert " and overlaps obstacle " in found.sentence


def test_start_blocked_by_a_named_obstacle() -> None:
    found = why(gap(3.0, box("post", 3, 3.5, -1, 1)))
    assert found.kind is FailureKind.START_BLOCKED
    assert "cannot stand at the start" in found.sentence
    assert "overlaps obstacle 'post' by 0.699 m" in found.sentence
    assert "if moved by (-0.750, +0.000) m" in found.remedy
    (end,) = found.blocked
    assert end.move is not None
    assert end.depth == pytest.approx(0.699)
    moved = found.scenario.start[:3] + np.array([*end.move, 0])
    assert clearance(found.scenario, moved) >= MARGIN
    assert found.deeper is None


def test_goal_blocked_and_goal_outside_the_workspace() -> None:
    pocket = gap(5.0, box("upper", 10, 18, 1.02, 2), box("lower", 10, 18, -2, -1.02))
    found = why(pocket)
    assert found.kind is FailureKind.GOAL_BLOCKED
    assert "'upper'" in found.sentence
    assert "'lower'" in found.sentence
    assert "with a body 1.940 m wide (now 2.097 m)" in found.remedy
    outside = why(gap(5.0).with_(goal=[17.0, 0, 0, 0, 0]))
    assert outside.kind is FailureKind.GOAL_BLOCKED
    assert "out of the workspace on its right (+x) side" in outside.sentence
    assert outside.blocked[0].outside == pytest.approx(17 + 3.699 - 20)


def test_both_ends_blocked_are_both_told_the_start_first() -> None:
    scenario = gap(5.0, box("post", 3, 3.5, -1, 1), box("pole", 13, 13.2, 0, 0.2))
    found = why(scenario)
    assert found.kind is FailureKind.START_BLOCKED
    assert [end.end for end in found.blocked] == ["start", "goal"]
    assert "'pole'" in found.sentence


def test_other_bad_input_has_no_explanation() -> None:
    with pytest.raises(SceneError) as failure:
        tightspot.plan(gap(5.0).with_(start=[0, 0, 0, 9, 0]))
    assert not isinstance(failure.value, BlockedError)
    with pytest.raises(InputError, match="steps"):
        tightspot.plan("oblique", steps=0)


@pytest.mark.parametrize(("x", "y", "angle"), [(0, 0, 0), (1e6, -2e6, 2.2)])
def test_a_gap_narrower_than_the_car_is_no_path(x: float, y: float, angle: float) -> None:
    found = why(gap(2.0, x=x, y=y, angle=angle), guess=QUICK)
    assert found.kind is FailureKind.NO_PATH
    assert "between 'left' and 'right'" in found.sentence
    assert found.bottleneck is not None
    assert found.bottleneck.room == pytest.approx(2.0 - 2 * MARGIN, abs=2e-3)
    assert "Widen it by at least 0.19" in found.remedy
    assert "--explain" in found.remedy
    place = found.to_dict()["bottleneck"]["place"]
    along = (np.array(place) - [x, y]) @ [np.cos(angle), np.sin(angle)]
    assert 6 <= along <= 9, "in the coordinates of the file"
    assert f"({place[0]:.2f}, {place[1]:.2f})" in found.sentence


def test_how_far_the_search_came_is_true() -> None:
    scenario = gap(2.0)
    reach = why(scenario, guess=QUICK).reach
    assert reach is not None
    assert reach.resolution == "coarse"
    assert reach.is_exhaustive
    assert reach.limit == ""
    assert reach.expansions > 100
    for poses, side in ((reach.from_start, -1), (reach.from_goal, 1)):
        assert len(poses) > 1000
        assert (side * (poses[:, 0] - 7.5) > 0).mean() > 0.99, "no pose beyond the gap"
        for pose in poses[:: len(poses) // 40]:
            assert clearance(scenario, pose) >= MARGIN - 2e-3
    assert clearance(scenario, reach.closest) >= MARGIN - 2e-3
    assert reach.distance == pytest.approx(float(np.hypot(*(reach.closest[:2] - [13, 0]))))
    straight_ahead = reach.from_start[np.abs(reach.from_start[:, 2]) < 0.05]
    assert reach.closest[0] >= straight_ahead[:, 0].max() - 0.4
    assert footprint(reach.closest).bounds[2] > 5.5, "its front is at the gap"
    assert reach.enclosed == ""


def test_a_goal_that_cannot_be_turned_into_is_walled_in() -> None:
    found = why(alley(3.0), guess=QUICK)
    assert found.kind is FailureKind.NO_PATH
    assert found.bottleneck is None, "the car's discs get in"
    assert found.reach is not None
    assert found.reach.enclosed == "goal"
    assert "coarse resolution" in found.sentence
    assert "the goal is walled in" in found.sentence
    assert "Make room around the goal" in found.remedy


def test_a_search_that_was_limited_proves_nothing() -> None:
    found = why("dead-end", guess=LIMITED)
    assert found.kind is FailureKind.NO_PATH
    assert found.reach is not None
    assert not found.reach.is_exhaustive
    assert "which is no proof" in found.sentence
    assert "the limit on expansions" in found.sentence
    assert "let the search run longer" in found.remedy


def test_a_goal_that_touches_a_wall_is_told_and_nothing_is_proved() -> None:
    found = why(gap(4.0, box("bar", 16.699 - 5e-10, 17, -4.1, 4.1)), margin=0.0, guess="hybrid-astar", effort="fast")
    assert found.kind is FailureKind.NO_PATH
    assert found.reach is not None
    assert not found.reach.is_proof
    assert "no room to spare at the goal, where the body is 0.000 m from obstacle 'bar'" in found.sentence
    assert found.remedy.startswith("Move the goal")


def test_a_scene_in_other_units_is_suspected() -> None:
    scene = Scenario.from_dict(
        {
            "name": "millimetres",
            "workspace": {"x": [-12000, 14000], "y": [-6000, 8000]},
            "obstacles": [box("left", -6000, -1300, -6000, 0), box("right", 1300, 6000, -6000, 0)],
            "start": {"x": -8000, "y": 3000, "theta": 0},
            "goal": {"x": 0, "y": -4500, "theta": 1.57},
        }
    )
    found = why(scene, guess=LIMITED, effort="fast")
    assert "The goal is 10966 m from the start." in found.sentence
    assert found.remedy.startswith("Check that the scene is in metres.")


def test_a_wall_leaves_nothing_to_widen() -> None:
    found = why(gap(4.0, box("bar", 11, 11.2, -4.1, 4.1)))
    assert found.kind is FailureKind.NO_PATH
    assert "closed by 'bar'" in found.sentence
    assert found.remedy == "Open a way through obstacle 'bar': no margin and no narrower body helps."
    assert found.reach is not None
    assert 7.0 < found.reach.closest[0] < 7.3, "the front reaches the bar"


def test_a_margin_that_closes_the_way_is_what_to_change() -> None:
    found = why(gap(2.4), margin=1.3)
    assert found.kind is FailureKind.NO_PATH
    assert "if the margin is kept" in found.sentence
    assert found.bottleneck is not None
    assert found.bottleneck.margin == pytest.approx((2.4 - WIDTH) / 2, abs=1e-3)
    assert found.remedy.startswith("Ask for a margin of 0.151 m or less")


def test_solver_stopped_names_constraint_obstacle_and_time() -> None:
    found = why("oblique", guess="linear", solver=Ipopt(max_iterations=4), refinements=0, effort="fast")
    assert found.kind is FailureKind.SOLVER_STOPPED
    stop = found.solver
    assert stop is not None
    assert stop.status.name == "ITERATION_LIMIT"
    assert stop.worst is not None
    assert str(stop.worst) in found.sentence
    assert found.trajectory is not None
    tightest = stop.tightest
    assert tightest is not None, "from a straight line through the obstacles something is still violated"
    assert tightest.kind == "separation"
    assert tightest.part == "body"
    assert tightest.label in {obstacle.name for obstacle in builtin("oblique").obstacles}
    assert 0 <= tightest.start <= tightest.end <= found.trajectory.duration
    assert 1e-3 < tightest.violation <= stop.worst.violation
    assert f"obstacle '{tightest.label}'" in found.sentence
    assert f"{tightest.end:.2f} s" in found.sentence
    assert "iteration limit" in found.sentence
    assert "more iterations" in found.remedy
    assert f"make room at obstacle '{tightest.label}'" in found.remedy
    k = int(np.argmin(np.abs(found.trajectory.t - tightest.end)))
    assert clearance(found.scenario, found.trajectory.states[k]) < MARGIN, "it does come too near there"
    data = found.to_dict()["solver"]
    assert data["worst_separation"]["label"] == tightest.label
    assert data["status"] == "ITERATION_LIMIT"


def test_solver_stopped_in_its_dynamics_names_the_nearest_obstacle() -> None:
    found = why("parallel", guess="linear", solver=Ipopt(max_iterations=15), refinements=0, effort="fast")
    stop = found.solver
    assert stop is not None
    assert stop.worst is not None
    assert stop.nearest is not None
    assert found.trajectory is not None
    k = int(np.argmin(np.abs(found.trajectory.t - stop.nearest.time)))
    distance = clearance(found.scenario, found.trajectory.states[k])
    assert max(stop.nearest.clearance, 0) == pytest.approx(distance, abs=1e-6)
    assert distance == pytest.approx(min(clearance(found.scenario, state) for state in found.trajectory.states))
    if stop.tightest is None:
        assert f"the nearest obstacle is {stop.nearest.obstacle[:-2]!r}, {distance:.3f} m away" in found.sentence


def test_solver_stopped_by_time_asks_for_time() -> None:
    found = why("oblique", solver=Ipopt(time_limit=1e-3), refinements=0, effort="fast")
    assert found.kind is FailureKind.SOLVER_STOPPED
    assert found.solver is not None
    assert found.solver.status.name == "TIME_LIMIT"
    assert "--time-limit" in found.remedy


def test_only_penetrating_says_where_when_and_how_deep() -> None:
    """From a straight line through a gap that is 10 cm narrower than the car: 5 cm on each side, or less on one."""
    found = why(gap(2.0), guess="linear", time_limit=1.5, effort="fast")
    assert found.kind is FailureKind.ONLY_PENETRATING
    least = found.penetration
    assert least is not None
    assert sum({c.obstacle: c.depth for c in least.contacts}.values()) == pytest.approx(WIDTH - 2.0, abs=0.01)
    deepest = least.contacts[0]
    overlap = footprint(deepest.pose).intersection(
        shapely.Polygon({o.name: o.exterior for o in found.scenario.obstacles}[deepest.obstacle[:-2]])
    )
    assert overlap.area > 0
    assert overlap.buffer(1e-6).contains(shapely.Point(deepest.place))
    assert f"penetrates obstacle '{deepest.obstacle[:-2]}' at {deepest.time:.2f} s" in found.sentence
    assert f"by {deepest.depth:.3f} m" in found.sentence
    assert found.witness is not None
    assert found.witness.clearance == -deepest.depth
    assert found.trajectory is least.trajectory
    assert "Widen it" in found.remedy


def test_only_nearer_than_the_margin_names_the_margin_that_is_left() -> None:
    found = why(gap(2.15), guess="linear", time_limit=1.5, effort="fast")
    assert found.kind is FailureKind.ONLY_PENETRATING
    assert found.penetration is not None
    assert found.penetration.depth == 0
    assert found.penetration.nearest is not None
    nearest = -found.penetration.nearest.depth
    assert nearest == pytest.approx(clearance(found.scenario, found.penetration.nearest.pose), abs=1e-6)
    assert 0 <= nearest <= (2.15 - WIDTH) / 2 + 1e-3
    assert f"comes within {nearest:.3f} m" in found.sentence
    assert "or a margin of 0.026 m or less" in found.remedy


def test_not_certified_offers_the_margin_that_this_trajectory_keeps() -> None:
    found = why("oblique", formulation="separating-line", steps=20, refinements=0, effort="fast")
    assert found.kind is FailureKind.NOT_CERTIFIED
    assert found.witness is not None
    assert str(found.witness) in found.sentence
    assert "swept-line" in found.remedy
    assert "more refinements" in found.remedy
    kept = re.search(r"a margin of (\S+) m, which this very trajectory keeps", found.remedy)
    assert kept
    margin = float(kept.group(1))
    assert 0 < margin < found.witness.clearance < MARGIN
    assert found.trajectory is not None
    assert tightspot.verify(found.scenario, found.vehicle, found.trajectory, margin=margin).certified
    assert not tightspot.verify(found.scenario, found.vehicle, found.trajectory, margin=margin + 0.001).certified


def test_not_certified_with_a_collision_offers_no_margin() -> None:
    found = why("parallel", formulation="separating-line", steps=12, refinements=0, effort="fast")
    assert found.kind is FailureKind.NOT_CERTIFIED
    assert found.certificate is not None
    assert not found.certificate.certified
    assert "overlaps" in found.sentence
    assert "which this very trajectory keeps" not in found.remedy


def test_every_kind_has_a_word_and_a_sentence() -> None:
    words = {kind.word for kind in FailureKind}
    assert words == {
        "start-blocked",
        "goal-blocked",
        "no-path",
        "solver-stopped",
        "only-penetrating",
        "not-certified",
    }
    assert all(kind.sentence.endswith(".") for kind in FailureKind)


@pytest.mark.parametrize(("x", "named"), [(4.0, "post"), (14.0, "bar")])
def test_a_line_that_stands_wrong_does_not_blame_a_far_obstacle(x: float, named: str) -> None:
    scene = gap(4.0, box("post", 3.9, 4.1, 1.5, 1.7), box("bar", 17, 17.2, -1, 1))
    request = resolve(scene, None, None, None, None, None, None, None, 0, 1.0)
    worst = WorstConstraint("separation", "body", "bar/0", "bar", 1.0, 2.0, 9.0)
    parts = {label: name for name, label in labels(scene).items()}
    near = Witness(3.0, "body", parts["post"], -0.2, (4.0, 1.0, 0.0), "collision")
    pose = (x, 1.0, 0.0)
    stop = SolverStop(SolveStatus.TIME_LIMIT, 7, 1, 9.0, worst, worst, pose, near, MARGIN)
    sentence, remedy = solver_words(request, stop, None, None, None)
    assert "obstacle 'bar' from 1.00 s to 2.00 s" in sentence
    assert f"make room at obstacle '{named}'" in remedy
    assert ("of the obstacles 'post' is nearest: body overlaps it by 0.200 m at 3.00 s" in sentence) == (
        named == "post"
    )
