"""Scenes side by side with one or more motions each: the paper's figures 1 and 2."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tightspot.plotting import style
from tightspot.plotting.scene import draw_path, draw_scene, draw_sweep
from tightspot.plotting.view import frame_axes, view_box
from tightspot.scenarios import Scenario
from tightspot.trajectory import Trajectory
from tightspot.vehicles import VehicleModel
from tightspot.verification import replay

_LOOKS = ((style.FORWARD, "-"), (style.REVERSE, "--"), (style.GOOD, "-."), (style.REACHED, ":"))
_SAMPLE = 0.1


@dataclass(frozen=True)
class Panel:
    """One scene of a figure.

    Attributes:
        scenario: The scene.
        vehicle: Drawn at start and goal.
        title: Above it.
        paths: Name to motion: rear-axle paths in different colours and line styles, straight between their knots.
        solution: A motion that is replayed and drawn with the area it sweeps, or ``None``.
    """

    scenario: Scenario
    vehicle: VehicleModel
    title: str
    paths: Mapping[str, Trajectory] = field(default_factory=dict)
    solution: Trajectory | None = None


def figure_panels(panels: Sequence[Panel]) -> Figure:
    """The scenes side by side; equal names have equal looks in all panels, explained once below."""
    names = list(dict.fromkeys(name for panel in panels for name in panel.paths))
    with style.drawing():
        figure = style.new_figure(5.2 * len(panels), 4.6 if names else 4.3)
        width = 1 / len(panels)
        bottom = 0.16 if names else 0.1
        for index, panel in enumerate(panels):
            place = (index * width + 0.2 * width, bottom, 0.76 * width, 0.9 - bottom)
            axes = figure.add_axes(place, label=panel.title)
            draw_scene(axes, panel.scenario, panel.vehicle)
            if panel.solution is not None:
                _draw_solution(axes, panel, panel.solution)
            for name, motion in panel.paths.items():
                colour, line = _LOOKS[names.index(name) % len(_LOOKS)]
                axes.plot(*motion.poses[:, :2].T, line, color=colour, linewidth=2.0, label=name, zorder=7)
            frame_axes(axes, view_box(panel.scenario), panel.scenario.offset)
            axes.set_title(panel.title, fontsize=11, fontweight="bold", parse_math=False)
        if names:
            handles = {
                handle.get_label(): handle
                for axes in figure.axes
                for handle in axes.lines
                if handle.get_label() in names
            }
            figure.legend([handles[name] for name in names], names, loc="lower center", ncol=len(names))
    return figure


def _draw_solution(axes: Axes, panel: Panel, solution: Trajectory) -> None:
    """The motion as the vehicle drives it, not as straight lines between the knots."""
    played = replay(panel.vehicle, solution)
    t = played.dense(_SAMPLE)
    states = played.at(t)
    draw_sweep(axes, panel.vehicle, states)
    interval = np.searchsorted(solution.t, t[:-1], "right") - 1
    inputs = solution.inputs[np.clip(interval, 0, solution.steps - 1)]
    draw_path(axes, Trajectory(t, states, inputs, solution.state_names, solution.input_names))
