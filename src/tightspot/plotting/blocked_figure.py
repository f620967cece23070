"""The picture of a start or goal where the vehicle cannot stand, with the nearest place where it can."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from tightspot.plotting import style
from tightspot.plotting.bodies import body_shape, draw_body, shape_patch
from tightspot.plotting.captions import put_legend, put_title, shortened
from tightspot.plotting.failure_figure import all_obstacles, forbidden_part, frame_window
from tightspot.plotting.layout import page
from tightspot.plotting.scene import draw_ends, draw_names, draw_scene
from tightspot.plotting.view import Box, frame_axes, view_box
from tightspot.scenarios import Blocked, Scenario
from tightspot.vehicles import VehicleModel

if TYPE_CHECKING:
    from tightspot.planner import Explanation

Array = NDArray[np.float64]

_LEGEND = 3.0
_DEPTHS = 4.0
_SMALLEST, _LARGEST = 0.3, 0.8


def figure_blocked(explanation: Explanation, caption: str) -> Figure:
    """The scene, and at its right the first blocked end with its surroundings.

    Args:
        explanation: With ``blocked``.
        caption: One line.
    """
    scenario, vehicle = explanation.scenario, explanation.vehicle
    bodies = [body_shape(vehicle, state) for end in explanation.blocked for state in _states(scenario, end)]
    bodies += [body_shape(vehicle, np.nan_to_num(state)) for state in (scenario.start, scenario.goal)]
    box = view_box(scenario, np.vstack([shapely.get_coordinates(body) for body in bodies]))
    places = page(box.aspect, detail=True, narrowest=11.0)
    with style.drawing():
        figure = style.new_figure(places.width, places.height)
        axes = figure.add_axes(places.scene.within(places.width, places.height), label="scene")
        _draw(axes, explanation, box)
        draw_names(axes, scenario)
        if places.detail is not None:
            first = explanation.blocked[0]
            window = _window(scenario, vehicle, first)
            frame_window(axes, window)
            detail = figure.add_axes(places.detail.within(places.width, places.height), label="detail")
            _draw(detail, explanation, window)
            detail.set(xlabel="", ylabel="")
            look: dict[str, Any] = {"fontsize": 10, "fontweight": "bold", "color": style.BAD, "parse_math": False}
            detail.set_title(shortened(_what(first), 60), loc="left", **look)
        words = [(shortened(caption, round(9.5 * places.width)), style.BAD, True)]
        put_title(figure, places.scene.left, scenario.name, words, path=False, more=_LEGEND)
        put_legend(figure, sweep=False, path=False, more=_handles(explanation))
    return figure


def _states(scenario: Scenario, end: Blocked) -> list[Array]:
    """The state at the blocked end and, if there is one, the nearest free one."""
    state = np.nan_to_num(getattr(scenario, end.end))
    if end.move is None:
        return [state]
    return [state, state + np.array([*end.move, 0.0, 0.0, 0.0])]


def _draw(axes: Axes, explanation: Explanation, box: Box) -> None:
    scenario, vehicle = explanation.scenario, explanation.vehicle
    draw_scene(axes, scenario)
    draw_ends(axes, scenario, vehicle)
    for end in explanation.blocked:
        state, *moved = _states(scenario, end)
        for place in moved:
            look: dict[str, Any] = {"facecolor": "none", "edgecolor": style.GOOD, "linewidth": 2.0}
            draw_body(axes, vehicle, place, mark_color=style.GOOD, zorder=7, gid="moved", **look)
        body = body_shape(vehicle, state)
        axes.add_patch(shape_patch(body, facecolor=(style.BAD, 0.16), edgecolor=style.BAD, linewidth=2, zorder=8))
        overlap = forbidden_part(scenario, body)
        if overlap.area > 0:
            look = {"facecolor": (style.BAD, 0.35), "edgecolor": style.BAD, "hatch": "////", "linewidth": 0.8}
            axes.add_patch(shape_patch(overlap, zorder=8.5, gid="overlap", **look))
        elif scenario.solids:
            line = shapely.shortest_line(body, all_obstacles(scenario))
            axes.plot(*shapely.get_coordinates(line).T, color=style.BAD, linewidth=1.4, zorder=8.5, gid="gap")
    frame_axes(axes, box, scenario.offset)


def _what(end: Blocked) -> str:
    """The worst of it in a few words."""
    if end.outside and end.outside > end.depth:
        return f"{end.end}: {end.outside:.3f} m outside"
    worst = end.obstacles[0]
    how = f"{-worst.value:.3f} m deep" if worst.value < 0 else f"{worst.value:.3f} m apart"
    return f"{end.end}: {shortened(f'{worst.part} / {worst.obstacle}', 32)}, {how}"


def _window(scenario: Scenario, vehicle: VehicleModel, end: Blocked) -> Box:
    """A square around the deepest overlap, or the place that is too near, some times as large as it is deep."""
    body = body_shape(vehicle, np.nan_to_num(getattr(scenario, end.end)))
    worst = end.obstacles[0].obstacle if end.obstacles else ""
    only = tuple(obstacle for obstacle in scenario.obstacles if obstacle.name == worst)
    scenario = scenario.with_(obstacles=only) if only and not end.outside > end.depth else scenario
    overlap = forbidden_part(scenario, body)
    if overlap.area > 0:
        pieces = shapely.get_parts(overlap)
        place = pieces[int(np.argmax(shapely.area(pieces)))].representative_point()
    else:
        place = shapely.centroid(shapely.shortest_line(body, all_obstacles(scenario)))
    size = float(np.ptp(shapely.get_coordinates(body), axis=0).max())
    half = min(max(_DEPTHS * end.depth, _DEPTHS * end.outside, _DEPTHS * end.margin, _SMALLEST), _LARGEST * size)
    return Box(place.x - half, place.x + half, place.y - half, place.y + half)


def _handles(explanation: Explanation) -> list[Line2D | Patch]:
    handles: list[Line2D | Patch] = [
        Patch(facecolor=(style.BAD, 0.2), edgecolor=style.BAD, linewidth=2, label="blocked")
    ]
    if any(end.move is not None for end in explanation.blocked):
        handles.append(Patch(facecolor="none", edgecolor=style.GOOD, linewidth=2, label="nearest free place"))
    return handles
