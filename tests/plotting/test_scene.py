"""The plan view's artists."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PathCollection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from tightspot.plotting import draw_path, draw_scene, draw_sweep, style
from tightspot.plotting.motion import dense_motion
from tightspot.plotting.scene import draw_names
from tightspot.plotting.view import Box, frame_axes, view_box
from tightspot.verification import Plan

from .conftest import make_plan


def test_scene_has_ground_obstacles_start_and_goal(plan: Plan, blank: Callable[[], Figure]) -> None:
    axes = blank().axes[0]
    draw_scene(axes, plan.scenario, plan.vehicle)
    colors = [to_hex(patch.get_facecolor()) for patch in axes.patches]
    assert colors.count(style.GROUND) == 1
    (obstacles,) = axes.collections
    assert len(obstacles.get_paths()) == len(plan.scenario.obstacles)
    assert {to_hex(color) for color in obstacles.get_facecolor()} == {style.OBSTACLE}
    ends = {patch.get_label(): patch for patch in axes.patches if patch.get_label() in ("start", "goal")}
    assert ends["start"].get_linestyle() != ends["goal"].get_linestyle()
    pose = plan.scenario.goal[:3]
    corners = plan.vehicle.parts[0].polygon.transformed(*pose).vertices
    drawn = ends["goal"].get_path().vertices
    assert all(np.hypot(*(drawn - corner).T).min() < 1e-9 for corner in corners)


def test_scene_without_vehicle_has_no_ends(plan: Plan, blank: Callable[[], Figure]) -> None:
    axes = blank().axes[0]
    draw_scene(axes, plan.scenario)
    assert len(axes.patches) == 1
    assert len(axes.collections[0].get_paths()) == len(plan.scenario.obstacles)


def test_obstacles_are_drawn_with_their_holes(plan: Plan, blank: Callable[[], Figure]) -> None:
    axes = blank().axes[0]
    draw_scene(axes, plan.scenario)
    axes.set(xlim=(-3, 17), ylim=(-5, 8))
    canvas = FigureCanvasAgg(axes.figure)
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())
    for point, color in (
        ((5.0, 5.5), style.GROUND),
        ((2.5, 4.5), style.OBSTACLE),
        ((10.0, 0.0), style.GROUND),
    ):
        x, y = axes.transData.transform(point)
        assert to_hex(pixels[-1 - round(y), round(x), :3] / 255) == color


def test_path_segments_by_gear_match_the_sign_of_speed(plan: Plan, blank: Callable[[], Figure]) -> None:
    motion = dense_motion(plan.vehicle, plan.trajectory)
    axes = blank().axes[0]
    legs = draw_path(axes, motion)
    lines = [line for line in axes.lines if line.get_gid() in ("forward", "reverse")]
    assert [line.get_gid() for line in lines] == ["forward", "reverse", "forward"]
    assert [line.get_color() for line in lines] == [style.FORWARD, style.REVERSE, style.FORWARD]
    for line, leg in zip(lines, legs, strict=True):
        stretch = slice(leg.first, leg.last + 1)
        assert np.array_equal(np.column_stack(line.get_data()), motion.states[stretch, :2])
        assert (motion.column("v")[stretch] * leg.gear > -1e-9).all()


def test_gear_changes_are_numbered_where_they_are(plan: Plan, blank: Callable[[], Figure]) -> None:
    motion = dense_motion(plan.vehicle, plan.trajectory)
    axes = blank().axes[0]
    draw_path(axes, motion)
    assert [text.get_text() for text in axes.texts] == ["1", "2"]
    for text, time in zip(axes.texts, (8.0, 14.0), strict=True):
        assert text.xy == pytest.approx(motion.states[np.searchsorted(motion.t, time - 1e-9), :2])


def test_crowded_gear_changes_share_a_label(plan: Plan, blank: Callable[[], Figure]) -> None:
    axes = blank().axes[0]
    draw_path(axes, dense_motion(plan.vehicle, plan.trajectory), crowded=20.0)
    assert [text.get_text() for text in axes.texts] == ["1, 2"]


def test_arrows_point_where_the_vehicle_moves(plan: Plan, blank: Callable[[], Figure]) -> None:
    motion = dense_motion(plan.vehicle, plan.trajectory)
    axes = blank().axes[0]
    draw_path(axes, motion)
    arrows = [line for line in axes.lines if line.get_gid() == "arrow"]
    assert len(arrows) >= 3
    for arrow in arrows:
        k = int(np.argmin(np.hypot(*(motion.states[:, :2] - np.ravel(arrow.get_xydata())).T)))
        tip = arrow._marker.get_transform().transform((1.0, 0.0))
        forward = tip @ [np.cos(motion.states[k, 2]), np.sin(motion.states[k, 2])] > 0
        assert forward == (arrow.get_markerfacecolor() == style.FORWARD)


def test_sweep_draws_area_and_outlines(plan: Plan, blank: Callable[[], Figure]) -> None:
    states = dense_motion(plan.vehicle, plan.trajectory).states
    axes = blank().axes[0]
    draw_sweep(axes, plan.vehicle, states, spacing=2.0)
    area = next(patch for patch in axes.patches if patch.get_label() == "swept area")
    assert area.get_path().contains_point(states[100, :2])
    (outlines,) = [artist for artist in axes.collections if isinstance(artist, PathCollection)]
    assert 5 <= len(outlines.get_paths()) <= 9


def test_names_are_written_literally_where_there_is_room(plan: Plan, blank: Callable[[], Figure]) -> None:
    axes = blank().axes[0]
    frame_axes(axes, view_box(plan.scenario))
    draw_names(axes, plan.scenario)
    assert {text.get_text() for text in axes.texts} == {"box", "ring"}
    for text in axes.texts:
        assert not text.get_parse_math()
    ring = next(text for text in axes.texts if text.get_text() == "ring")
    assert not 3 < ring.get_position()[0] < 7 or not 5 < ring.get_position()[1] < 6


def test_view_is_the_workspace_and_ignores_far_obstacles(plan: Plan) -> None:
    box = view_box(plan.scenario, [(-0.9, -1.0), (9.7, 1.4)])
    assert box.x_min == pytest.approx(-3 - 0.4)
    assert box.y_max == pytest.approx(8 + 0.4)


def test_view_zooms_in_when_the_workspace_is_huge() -> None:
    huge = make_plan(workspace=(-500.0, 500.0, -500.0, 500.0))
    points = dense_motion(huge.vehicle, huge.trajectory).states[:, :2]
    box = view_box(huge.scenario, points)
    assert box.width < 15
    assert Box.around(points).x_min > box.x_min
    assert Box.around(points).x_max < box.x_max


@pytest.mark.parametrize("offset", [(0.0, 0.0), (0.3, -7.25), (4_484_378_812.7, -354_286_011.3)])
def test_ticks_are_round_numbers_of_the_users_coordinates(
    offset: tuple[float, float], blank: Callable[[], Figure]
) -> None:
    axes = blank().axes[0]
    frame_axes(axes, Box(-3.1, 17.2, -5.3, 8.1), offset)
    for axis, shift in zip((axes.xaxis, axes.yaxis), offset, strict=True):
        ticks = np.array(axis.get_majorticklocs())
        labels = [float(axis.get_major_formatter()(tick).replace("\N{MINUS SIGN}", "-")) for tick in ticks]
        base = sum(axis_base(axis.get_label_text()))
        assert ticks + shift == pytest.approx(np.array(labels) + base, abs=1e-5)
        assert all(abs(label * 2 - round(label * 2)) < 1e-5 for label in labels)
        assert max(map(abs, labels)) < 1000


def axis_base(label: str) -> list[float]:
    """The number that an axis label like ``x − 4 484 378 810 (m)`` says the ticks count from."""
    digits = label.replace("\N{THIN SPACE}", "").split()[1:-1]
    if not digits:
        return [0.0]
    sign, number = digits
    return [float(number) * (1.0 if sign == "\N{MINUS SIGN}" else -1.0)]
