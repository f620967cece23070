"""Pictures of the speed benchmark: times against size, and their distribution over starts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from tightspot.plotting import style

OURS, THEIRS, PLAN = style.FORWARD, style.REVERSE, style.GOOD
SCENE_COLOURS = (style.FORWARD, style.REVERSE, style.REACHED, style.GOOD)
SCENE_LINES = ("-", "--", ":", "-.")
PARTS = {
    "search": (style.FORWARD, ""),
    "set_up": (style.SWEEP, "//"),
    "solve": (style.REVERSE, ".."),
    "judge": (style.FAINT, "xx"),
    "other": (style.OBSTACLE, ""),
}
"""Of a plan's time, with colour and hatch."""

LABELS = {"steps": "steps", "obstacles": "obstacles", "vertices": "vertices of an obstacle"}


def figure_scaling(scaling: Mapping[str, Any]) -> Figure:
    """Time against steps, obstacles and vertices, on logarithmic scales.

    Args:
        scaling: The benchmark's ``scaling``.
    """
    with style.drawing():
        figure = style.new_figure(11.0, 3.8)
        for axes, (what, label) in zip(figure.subplots(1, 3), LABELS.items(), strict=True):
            rows = scaling[what]["rows"]
            _curve(axes, rows, what, "seconds", "stagewise solve", OURS, "o")
            _curve(axes, rows, what, "ipopt_seconds", "IPOPT (17)", THEIRS, "s")
            _curve(axes, rows, what, "plan_seconds", "whole plan", PLAN, "^")
            axes.set_xscale("log")
            axes.set_yscale("log")
            axes.set_xlabel(label)
            style.quiet_axes(axes)
            axes.set_xticks([row[what] for row in rows], [str(row[what]) for row in rows])
            axes.minorticks_off()
            axes.yaxis.set_major_formatter(_plain)
            axes.legend(fontsize=8)
        figure.axes[0].set_ylabel("ms")
        figure.tight_layout()
    return figure


def figure_distribution(panels: Mapping[str, Mapping[str, Sequence[float]]]) -> Figure:
    """Each start's ratio of times, by scene, as a cumulative share.

    Args:
        panels: Title to scene to ratios.
    """
    with style.drawing():
        figure = style.new_figure(8.4, 3.4 * -(-len(panels) // 2))
        grid = figure.subplots(-(-len(panels) // 2), 2, sharex=True, sharey=True, squeeze=False)
        for axes, (title, scenes) in zip(grid.flat, panels.items(), strict=False):
            for index, (scene, ratios) in enumerate(scenes.items()):
                values = np.sort(np.asarray(ratios, float))
                share = np.arange(values.size + 1) / max(values.size, 1)
                colour, line = SCENE_COLOURS[index % 4], SCENE_LINES[index % 4]
                axes.step(
                    [*values[:1], *values], share[: values.size + 1], where="post", c=colour, ls=line, label=scene
                )
            axes.set_xscale("log")
            axes.xaxis.set_major_locator(LogLocator(10.0, (1.0, 2.0, 5.0)))
            axes.xaxis.set_major_formatter(_plain)
            axes.xaxis.set_minor_locator(NullLocator())
            axes.tick_params(axis="x", labelbottom=True)
            axes.set_title(title, fontsize=10)
            style.quiet_axes(axes)
            axes.grid(axis="x", color=style.FAINT, linewidth=0.6)
            axes.legend(fontsize=8)
        for axes in grid.flat[len(panels) :]:
            axes.remove()
        for axes in grid[-1]:
            axes.set_xlabel("times as fast")
        for axes in grid[:, 0]:
            axes.set_ylabel("share of starts")
        figure.tight_layout()
    return figure


def figure_plan_times(plans: Mapping[str, Any]) -> Figure:
    """Where a plan's time goes, by scene: median milliseconds of search, set-up, solve, judge and the rest.

    Args:
        plans: The benchmark's ``plans``.
    """
    with style.drawing():
        figure = style.new_figure(6.4, 3.2)
        axes = figure.subplots()
        scenes = [scene for scene, figures in plans.items() if "parts_milliseconds" in figures]
        left = np.zeros(len(scenes))
        for part, (colour, hatch) in PARTS.items():
            width = np.array([plans[scene]["parts_milliseconds"][part] for scene in scenes])
            label = part.replace("_", "-")
            axes.barh(scenes, width, left=left, color=colour, hatch=hatch, edgecolor="white", label=label)
            left += width
        axes.invert_yaxis()
        axes.set_xlabel("ms, median")
        style.quiet_axes(axes)
        axes.grid(visible=False, axis="y")
        figure.legend(loc="upper center", ncols=len(PARTS), fontsize=8)
        figure.tight_layout(rect=(0, 0, 1, 0.93))
    return figure


def _plain(value: float, position: int | None) -> str:
    """Tick labels without powers of ten."""
    return f"{value:g}"


def _curve(
    axes: Axes, rows: Sequence[Mapping[str, Any]], what: str, name: str, label: str, colour: str, marker: str
) -> None:
    points = [(row[what], 1e3 * row[name]) for row in rows if name in row]
    if points:
        axes.plot(*zip(*points, strict=True), color=colour, marker=marker, markersize=4, linewidth=1.4, label=label)
