"""Pictures of failures: what is drawn is what was found, and nothing stands outside the picture."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from matplotlib.figure import Figure

import tightspot
from tightspot.errors import BlockedError, PlanningError
from tightspot.guesses import HybridAStar
from tightspot.plotting import figure_explanation, save
from tightspot.plotting.reach_figure import covered
from tightspot.scenarios import Scenario
from tightspot.search import COARSE, HybridAStarOptions
from tightspot.solvers import Ipopt

QUICK = HybridAStar(HybridAStarOptions(resolutions=(COARSE,), margins=(0.05,)))


def box(name: str, x_min: float, x_max: float, y_min: float, y_max: float) -> dict[str, Any]:
    return {"name": name, "vertices": [[x_min, y_min], [x_max, y_min], [x_max, y_max], [x_min, y_max]]}


def road(*obstacles: dict[str, Any], shift: float = 0.0, **changes: Any) -> Scenario:
    data: dict[str, Any] = {
        "name": "a road with a name that is too long for any picture " * 3,
        "workspace": {"x": [shift - 3, shift + 20], "y": [-4, 4]},
        "obstacles": [{**o, "vertices": [[x + shift, y] for x, y in o["vertices"]]} for o in obstacles],
        "start": {"x": shift, "y": 0, "theta": 0},
        "goal": {"x": shift + 13, "y": 0, "theta": 0},
    }
    return Scenario.from_dict(data | changes)


GAP = (box("left", 6, 9, 1, 4), box("right", 6, 9, -4, -1))


def why(scenario: Scenario | str, **options: Any) -> tightspot.Explanation:
    with pytest.raises((PlanningError, BlockedError)) as failure:
        tightspot.plan(scenario, **options)
    return failure.value.explanation


def drawn(explanation: tightspot.Explanation, path: Path) -> tuple[Figure, set[str], str]:
    """The figure, the gids of what is in it, and its words; all its axes stand inside it."""
    figure = figure_explanation(explanation)
    save(figure, path / "failure.png")
    assert (path / "failure.png").stat().st_size > 10_000
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    width, height = figure.get_size_inches() * figure.dpi
    for axes in figure.axes:
        tight = axes.get_tightbbox(renderer)
        assert tight.x0 >= -1
        assert tight.y0 >= -1
        assert tight.x1 <= width + 1
        assert tight.y1 <= height + 1
    title, legend = figure.texts[0].get_window_extent(renderer), figure.legends[0].get_window_extent(renderer)
    assert title.x1 < legend.x0, "the title leaves room for the legend"
    gids = {str(artist.get_gid()) for axes in figure.axes for artist in (*axes.patches, *axes.lines)}
    words = " ".join(area.get_text() for artist in figure.artists for area in artist.get_child().get_children())
    return figure, gids, words


def panel(figure: Figure, label: str) -> Any:
    return next(axes for axes in figure.axes if axes.get_label() == label)


def test_a_blocked_start_with_its_overlap_and_the_nearest_free_place(tmp_path: Path) -> None:
    explanation = why(road(box("post", 3, 3.5, -1, 1)))
    figure, gids, words = drawn(explanation, tmp_path)
    assert {"overlap", "moved"} <= gids
    assert "start blocked: the vehicle's body overlaps obstacle 'post' by 0.699 m" in words
    detail = panel(figure, "detail")
    assert "post" in detail.get_title(loc="left")
    assert detail.get_xlim()[0] < 3 < 3.5 < detail.get_xlim()[1]


def test_a_goal_that_is_only_too_near_or_outside(tmp_path: Path) -> None:
    near = why(road(box("upper", 10, 18, 1.07, 2), box("lower", 10, 18, -2, -1.07)))
    figure, gids, _ = drawn(near, tmp_path)
    assert "overlap" not in gids
    assert "gap" in gids
    assert panel(figure, "detail").get_title(loc="left").endswith("0.022 m apart")
    outside = why(road(goal={"x": 17, "y": 0, "theta": 0}))
    figure, gids, _ = drawn(outside, tmp_path)
    assert "overlap" in gids, "what is outside"
    assert "0.699 m outside" in panel(figure, "detail").get_title(loc="left")


def test_a_blocked_pose_without_remedy_is_drawn(tmp_path: Path) -> None:
    tiny = road(workspace={"x": [-1, 14], "y": [-1, 1]})
    explanation = why(tiny)
    assert explanation.blocked[0].move is None
    _, gids, _ = drawn(explanation, tmp_path)
    assert "moved" not in gids


@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_the_reached_region_the_closest_pose_and_the_narrow_place(shift: float, tmp_path: Path) -> None:
    explanation = why(road(*GAP, shift=shift), guess=QUICK)
    figure, gids, words = drawn(explanation, tmp_path)
    assert {"reached", "leads to goal", "closest", "bottleneck"} <= gids
    assert "room for 1.900 m, the body needs 2.097 m" in words
    circle = next(patch for patch in panel(figure, "scene").patches if patch.get_gid() == "bottleneck")
    assert circle.get_radius() == pytest.approx(1.0, abs=2e-3), "it fills the gap"
    json.dumps(explanation.to_dict())


def test_the_covered_area_is_that_of_the_bodies() -> None:
    explanation = why(road(*GAP), guess=QUICK)
    assert explanation.reach is not None
    area = covered(explanation.vehicle, explanation.reach.from_start)
    walls = shapely.union_all([shapely.Polygon(obstacle.exterior) for obstacle in explanation.scenario.obstacles])
    assert area.intersection(walls).area < 1e-6
    assert area.covers(shapely.Point(0, 0))
    assert area.bounds[2] < 9
    assert area.area > 50


def test_a_search_without_bottleneck_is_drawn(tmp_path: Path) -> None:
    alley = road(
        box("walk", -4, 8, -4.5, 0.5),
        box("shop", 10.4, 21, -4.5, 0.5),
        workspace={"x": [-3, 20], "y": [-6, 3.5]},
        start={"x": 0, "y": 2, "theta": 0},
        goal={"x": 9.2, "y": -4.9, "theta": math.pi / 2},
    )
    explanation = why(alley, guess=QUICK)
    assert explanation.bottleneck is None
    _, gids, words = drawn(explanation, tmp_path)
    assert {"reached", "leads to goal", "closest"} <= gids
    assert "bottleneck" not in gids
    assert "no path with a margin of 0.05 m: the nearest pose is" in words


def test_the_last_iterate_with_its_worst_moment(tmp_path: Path) -> None:
    few = Ipopt(max_iterations=4)
    explanation = why("oblique", guess="linear", solver=few, refinements=0, effort="fast")
    assert explanation.trajectory is not None
    figure, gids, words = drawn(explanation, tmp_path)
    assert "iterate" in gids
    assert "the solver stopped: the iteration limit was reached" in words
    line = next(line for line in panel(figure, "scene").lines if line.get_gid() == "iterate")
    np.testing.assert_allclose(line.get_xydata(), explanation.trajectory.poses[:, :2])
    assert "clearance" not in {axes.get_label() for axes in figure.axes}, "the iterate is no motion"


def test_the_least_penetration_with_all_contacts(tmp_path: Path) -> None:
    explanation = why(road(*GAP), guess="linear", effort="fast", time_limit=1.0)
    assert explanation.kind is tightspot.FailureKind.ONLY_PENETRATING
    assert explanation.penetration is not None
    figure, gids, words = drawn(explanation, tmp_path)
    assert {"contact", "overlap"} <= gids
    contacts = [patch for patch in panel(figure, "scene").patches if patch.get_gid() == "contact"]
    assert len(contacts) == len(explanation.penetration.contacts) >= 1
    assert "only trajectories that come too near" in words
    assert "clearance" in {axes.get_label() for axes in figure.axes}


def test_what_was_not_certified_with_the_witness(tmp_path: Path) -> None:
    explanation = why("parallel", formulation="separating-line", steps=12, refinements=0, effort="fast")
    figure, gids, words = drawn(explanation, tmp_path)
    assert "overlap" in gids
    assert f"not certified: {explanation.witness}" in words
    assert "detail" in {axes.get_label() for axes in figure.axes}
