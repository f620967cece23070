"""Pictures of the speed benchmark: times against size, and their distribution over starts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tightspot.plotting import style

OURS, THEIRS, PLAN = style.FORWARD, style.REVERSE, style.GOOD
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


def figure_distribution(solves: Mapping[str, Mapping[str, Mapping[str, Sequence[float]]]]) -> Figure:
    """Each start's ratio of times, by scene, as a cumulative share.

    Args:
        solves: The benchmark's ``cases["solves"]``: by objective, then by scene.
    """
    with style.drawing():
        figure = style.new_figure(4.2 * len(solves), 3.8)
        panels = np.atleast_1d(figure.subplots(1, len(solves), sharey=True))
        colours = (style.FORWARD, style.REVERSE, style.REACHED, style.GOOD)
        lines = ("-", "--", ":", "-.")
        for axes, (name, scenes) in zip(panels, solves.items(), strict=True):
            for index, (scene, cases) in enumerate(scenes.items()):
                ratios = np.sort(np.array(cases["ipopt_seconds"]) / np.array(cases["seconds"]))
                share = np.arange(1, ratios.size + 1) / ratios.size
                look: Any = {"color": colours[index % 4], "linestyle": lines[index % 4], "label": scene}
                axes.step(ratios, share, where="post", **look)
            axes.set_xscale("log")
            axes.xaxis.set_major_formatter(_plain)
            axes.xaxis.set_minor_formatter(_plain)
            axes.tick_params(axis="x", which="both", labelsize=7)
            axes.set_xlabel("times as fast as IPOPT (17)")
            axes.set_title(name, fontsize=10)
            style.quiet_axes(axes)
            axes.legend(fontsize=8)
        panels[0].set_ylabel("share of starts")
        figure.tight_layout()
    return figure


def figure_plan_times(plans: Mapping[str, Any]) -> Figure:
    """Where a plan's time goes, by scene: median milliseconds of search, set-up, solve and judge.

    Args:
        plans: The benchmark's ``plans``.
    """
    with style.drawing():
        figure = style.new_figure(6.4, 3.2)
        axes = figure.subplots()
        scenes = [scene for scene, figures in plans.items() if "parts_milliseconds" in figures]
        left = np.zeros(len(scenes))
        hatches = {"search": "", "set_up": "//", "solve": "..", "judge": "xx"}
        colours = (style.FORWARD, style.SWEEP, style.REVERSE, style.FAINT)
        for colour, (part, hatch) in zip(colours, hatches.items(), strict=True):
            width = np.array([plans[scene]["parts_milliseconds"][part] for scene in scenes])
            label = part.replace("_", "-")
            axes.barh(scenes, width, left=left, color=colour, hatch=hatch, edgecolor="white", label=label)
            left += width
        axes.invert_yaxis()
        axes.set_xlabel("ms, median")
        style.quiet_axes(axes)
        axes.legend(fontsize=8)
        figure.tight_layout()
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
