"""The picture of a search that found no path: what it reached from either end, and where it is too narrow."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch
from numpy.typing import NDArray

from tightspot.plotting import style
from tightspot.plotting.bodies import draw_body, placed_parts, shape_patch
from tightspot.plotting.captions import put_legend, put_title, shortened
from tightspot.plotting.layout import page
from tightspot.plotting.scene import draw_ends, draw_names, draw_scene
from tightspot.plotting.view import Box, frame_axes
from tightspot.scenarios import Bottleneck
from tightspot.vehicles import VehicleModel

if TYPE_CHECKING:
    from tightspot.planner import Explanation, Reach

Array = NDArray[np.float64]

_NARROWEST = 12.0
_LEGEND = 5.0
_CELL = 0.4
_TURN = np.radians(20)
_FROM_START, _FROM_GOAL = style.REACHED, style.GOOD


def figure_reach(explanation: Explanation, caption: str) -> Figure:
    """The whole workspace with the areas that the vehicle can cover from the start and before the goal.

    Args:
        explanation: With ``reach`` or ``bottleneck`` or both.
        caption: One line.
    """
    scenario, vehicle = explanation.scenario, explanation.vehicle
    box = Box.around(scenario.workspace.vertices)
    box = box.grown(0.02 * max(box.width, box.height))
    places = page(box.aspect, narrowest=_NARROWEST)
    handles: list[Line2D | Patch] = []
    with style.drawing():
        figure = style.new_figure(places.width, places.height)
        axes = figure.add_axes(places.scene.within(places.width, places.height), label="scene")
        draw_scene(axes, scenario)
        frame_axes(axes, box, scenario.offset)
        draw_names(axes, scenario)
        if explanation.reach is not None:
            handles += _draw_reach(axes, vehicle, explanation.reach)
        draw_ends(axes, scenario, vehicle)
        if explanation.bottleneck is not None:
            handles.append(_draw_bottleneck(axes, explanation.bottleneck, explanation.margin))
        words = [(shortened(caption, round(9.5 * places.width)), style.BAD, True)]
        put_title(figure, places.scene.left, scenario.name, words, path=False, more=_LEGEND)
        put_legend(figure, sweep=False, path=False, more=handles)
    return figure


def covered(vehicle: VehicleModel, poses: Array) -> Any:
    """The area of the body at the poses (n, 3), thinned to one a cell of place and heading, a shapely geometry."""
    cells = np.column_stack([np.round(poses[:, :2] / _CELL), np.round(poses[:, 2] % (2 * np.pi) / _TURN)])
    chosen = np.unique(cells, axis=0, return_index=True)[1]
    bodies = [shapely.polygons(vertices) for vertices in placed_parts(vehicle, poses[chosen])]
    return shapely.union_all(np.concatenate(bodies))


def _draw_reach(axes: Axes, vehicle: VehicleModel, reach: Reach) -> list[Line2D | Patch]:
    areas = (
        ("reached from the start", reach.from_start, _FROM_START, "reached"),
        ("leads to the goal", reach.from_goal, _FROM_GOAL, "leads to goal"),
    )
    handles: list[Line2D | Patch] = []
    for label, poses, color, gid in areas:
        look: dict[str, Any] = {"facecolor": (color, 0.22), "edgecolor": (color, 0.9), "linewidth": 1.0}
        axes.add_patch(shape_patch(covered(vehicle, poses), zorder=3, gid=gid, **look))
        handles.append(Patch(label=label, **look))
    look = {"facecolor": "none", "edgecolor": style.BAD, "linewidth": 1.8}
    draw_body(axes, vehicle, reach.closest, mark_color=style.BAD, zorder=6, gid="closest", **look)
    return [*handles, Patch(label="closest pose", **look)]


def _draw_bottleneck(axes: Axes, narrow: Bottleneck, margin: float) -> Patch:
    """A circle that fills the gap, margin included."""
    look: dict[str, Any] = {"facecolor": (style.BAD, 0.15), "edgecolor": style.BAD, "linewidth": 1.6}
    x, y = narrow.place.tolist()
    axes.add_patch(Circle((x, y), max(narrow.room / 2 + margin, 0.15), zorder=7, gid="bottleneck", **look))
    return Patch(label="too narrow" if narrow.room else "closed", **look)
