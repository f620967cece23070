"""The picture of a judged motion's worst moment: deepest overlap, place of a fault, or the nearest approach."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from tightspot.plotting import style
from tightspot.plotting.bodies import body_shape, draw_body, shape_patch, swept_area
from tightspot.plotting.captions import gear_changes, put_legend, put_title, shortened
from tightspot.plotting.failure_figure import all_obstacles, forbidden_part, frame_window
from tightspot.plotting.judged import Judged, of_plan, of_table
from tightspot.plotting.layout import page
from tightspot.plotting.motion import travelled
from tightspot.plotting.profiles import draw_clearance
from tightspot.plotting.scene import draw_ends, draw_names, draw_path, draw_scene, draw_sweep
from tightspot.plotting.view import Box, frame_axes, view_box
from tightspot.verification import Certificate, Plan, TableVerdict
from tightspot.verification.certificate import WORKSPACE

_FAULT_WINDOW = 1.2
_DETAIL = (0.15, 2.5)
"""Smallest and largest half width of the detail, m."""
_TIMES_RADIUS, _TIMES_GAP = 12.0, 2.0
"""How many times wider it is than the largest circle in the overlap, or than the gap."""


def figure_judged_table(verdict: TableVerdict) -> Figure:
    """The worst moment of somebody's table."""
    return figure_worst_moment(of_table(verdict))


def figure_judged_plan(plan: Plan, certificate: Certificate) -> Figure:
    """The worst moment of a plan, whose trajectory got that certificate in the plan's scenario."""
    return figure_worst_moment(of_plan(plan, certificate))


def figure_worst_moment(judged: Judged) -> Figure:
    """Scene with the swept area, the body at the worst moment, the place magnified, clearance below."""
    scenario, vehicle = judged.scenario, judged.vehicle
    ends = [body_shape(vehicle, np.nan_to_num(state)) for state in (scenario.start, scenario.goal)]
    area = swept_area(vehicle, judged.motion.states)
    box = view_box(scenario, np.vstack([shapely.get_coordinates(shape) for shape in (*ends, area)]))
    places = page(box.aspect, detail=True, curve=True, narrowest=11.0)
    with style.drawing():
        figure = style.new_figure(places.width, places.height)
        axes = figure.add_axes(places.scene.within(places.width, places.height), label="scene")
        draw_scene(axes, scenario)
        draw_sweep(axes, vehicle, judged.motion.states, shape=area)
        draw_ends(axes, scenario, vehicle)
        frame_axes(axes, box, scenario.offset)
        legs = draw_path(axes, judged.motion, crowded=0.25 * box.width / places.scene.width)
        draw_names(axes, scenario)
        _draw_body(axes, judged, mark=True)
        if places.detail is not None:
            detail = figure.add_axes(places.detail.within(places.width, places.height), label="detail")
            frame_window(axes, _draw_detail(detail, judged))
        if places.curve is not None:
            curve = figure.add_axes(places.curve.within(places.width, places.height), label="clearance")
            _draw_curve(curve, judged)
        facts = f"{travelled(judged.motion.poses)[-1]:.1f} m, {gear_changes(len(legs) - 1)}, vehicle {vehicle.name}"
        sentence = ("✓ " if judged.upheld else "✗ ") + judged.sentence
        room = round(10.5 * places.width)
        words = [(shortened(sentence, room), judged.color, True)]
        if len(sentence) + len(facts) < room:
            words.append((f" ·   {facts}", style.SOFT_INK, False))
        put_title(figure, places.scene.left, scenario.name, words)
        label = "nearest approach" if judged.upheld else "worst moment"
        handle = Patch(facecolor=(judged.color, 0.2), edgecolor=judged.color, label=label)
        put_legend(figure, more=[handle])
    return figure


def _draw_body(axes: Axes, judged: Judged, *, mark: bool) -> None:
    """The body at the worst moment; what overlaps is hatched, else the nearest points are joined.

    Magnified, the triangle that marks its front would hide them.
    """
    look: dict[str, Any] = {"facecolor": (judged.color, 0.16), "edgecolor": judged.color, "linewidth": 2, "zorder": 8}
    draw_body(axes, judged.vehicle, judged.pose, mark=mark, mark_color=judged.color, gid="moment", **look)
    body = body_shape(judged.vehicle, judged.pose)
    overlap = forbidden_part(judged.scenario, body)
    if overlap.area > 0:
        look = {"facecolor": (style.BAD, 0.35), "edgecolor": style.BAD, "hatch": "////", "linewidth": 0.8}
        axes.add_patch(shape_patch(overlap, zorder=8.5, gid="overlap", **look))
    elif judged.obstacle and judged.obstacle != WORKSPACE and judged.scenario.solids:
        ends = shapely.get_coordinates(shapely.shortest_line(body, all_obstacles(judged.scenario)))
        axes.plot(*ends.T, color=judged.color, linewidth=1.8, marker=".", zorder=8.6, gid="gap")


def _draw_detail(axes: Axes, judged: Judged) -> Box:
    """The place of the moment, magnified: the overlap, the gap, or the rear axle and where it really moves."""
    body = body_shape(judged.vehicle, judged.pose)
    draw_scene(axes, judged.scenario)
    draw_ends(axes, judged.scenario, judged.vehicle, mark=False)
    window = _window(judged, body)
    _draw_body(axes, judged, mark=not judged.obstacle)
    axes.plot(*judged.motion.poses[:, :2].T, color=style.INK, linewidth=1.2, zorder=9)
    if judged.rows is not None:
        axes.plot(*judged.rows.T, ".", color=style.INK, markersize=4, zorder=9.1, gid="rows")
    if judged.directions:
        _draw_directions(axes, judged)
    frame_axes(axes, window, judged.scenario.offset)
    axes.set(xlabel="", ylabel="")
    look: dict[str, Any] = {"fontsize": 10, "fontweight": "bold", "color": judged.color, "parse_math": False}
    axes.set_title(_what(judged), loc="left", **look)
    return window


def _window(judged: Judged, body: Any) -> Box:
    """A square around where the overlap is widest, or the gap, some times as large as it is; else the rear axle."""
    (x, y), half = judged.pose[:2].tolist(), _FAULT_WINDOW
    if judged.obstacle:
        pieces = shapely.get_parts(forbidden_part(judged.scenario, body))
        largest: Any = pieces[int(np.argmax(shapely.area(pieces)))] if len(pieces) else shapely.Point()
        line, times = None, _TIMES_GAP
        if largest.area > 0:
            line, times = shapely.maximum_inscribed_circle(largest, 1e-4), _TIMES_RADIUS
        elif judged.scenario.obstacles:
            line = shapely.shortest_line(body, all_obstacles(judged.scenario))
        if line is not None and not line.is_empty:
            x, y = shapely.get_coordinates(line)[0].tolist()
            half = float(np.clip(times * line.length, *_DETAIL))
    return Box(x - half, x + half, y - half, y + half)


def _what(judged: Judged) -> str:
    if not judged.obstacle:
        return "where the fault is largest"
    overlap = forbidden_part(judged.scenario, body_shape(judged.vehicle, judged.pose))
    return "overlap" if overlap.area > 0 else "nearest points"


def _draw_directions(axes: Axes, judged: Judged) -> None:
    """Where the body points, dashed, and where the rear-axle midpoint moves."""
    x, y, theta = judged.pose.tolist()
    poses, at = judged.motion.poses, judged.motion.t
    k = int(np.clip(np.searchsorted(at, judged.at), 1, len(at) - 1))
    step = poses[k, :2] - poses[k - 1, :2]
    size = 0.8 * _FAULT_WINDOW
    heading = np.array([np.cos(theta), np.sin(theta)])
    axes.plot([x, x + size * heading[0]], [y, y + size * heading[1]], "--", color=style.INK, linewidth=1.4, zorder=9.2)
    moved = float(np.hypot(*step))
    if moved > 0:
        way = step / moved * size
        look: dict[str, Any] = {"arrowprops": {"arrowstyle": "-|>", "color": judged.color, "lw": 2.0}, "zorder": 9.3}
        axes.annotate("", (x + way[0], y + way[1]), xytext=(x, y), **look)
    handles = [
        Line2D([], [], color=style.INK, linestyle="--", label="heading"),
        Line2D([], [], color=judged.color, linewidth=2, label="direction of motion"),
    ]
    axes.legend(handles=handles, loc="lower left", fontsize=8.5, frameon=True, framealpha=0.9)


def _draw_curve(axes: Axes, judged: Judged) -> None:
    """Clearance of obstacles along the motion, or of the workspace's boundary if that was crossed."""
    outside = judged.obstacle == WORKSPACE
    values = judged.series.workspace if outside else judged.series.clearance
    draw_clearance(axes, judged.series.t, values, margin=judged.margin if judged.margin > 0 and not outside else None)
    value = float(np.interp(judged.at, judged.series.t, values))
    top = axes.get_ylim()[1]
    if np.isfinite(value):
        axes.plot([judged.at], [min(value, top)], "o", color=judged.color, markersize=6, zorder=7, clip_on=False)
    axes.axvline(judged.at, color=judged.color, linewidth=0.9, linestyle=":", zorder=2)
    axes.set_xlabel(judged.axis)
    if outside:
        axes.set_ylabel("inside W (m)")
