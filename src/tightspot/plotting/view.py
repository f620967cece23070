"""Which part of the plane a picture shows, and axes in metres with ticks at round original coordinates."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, MaxNLocator
from numpy.typing import ArrayLike

from tightspot.plotting import style
from tightspot.scenarios import Scenario

_CROWDED = 2.2
"""A workspace this many times larger than the motion's own box is not shown whole."""

_LARGEST_TICK_OFFSET = 1e4
"""From this coordinate on, m, tick labels count from a round number that the axis label states."""


class Box(NamedTuple):
    """An axis-parallel rectangle, m."""

    x_min: float
    x_max: float
    y_min: float
    y_max: float

    @property
    def width(self) -> float:
        """Extent in x, m."""
        return self.x_max - self.x_min

    @property
    def height(self) -> float:
        """Extent in y, m."""
        return self.y_max - self.y_min

    @property
    def aspect(self) -> float:
        """Width over height."""
        return self.width / self.height

    def grown(self, by: float) -> Box:
        """The rectangle with ``by`` metres more on every side."""
        return Box(self.x_min - by, self.x_max + by, self.y_min - by, self.y_max + by)

    @classmethod
    def around(cls, points: ArrayLike) -> Box:
        """The smallest rectangle with these points, shape (n, 2)."""
        points = np.asarray(points, dtype=float)
        (x_min, y_min), (x_max, y_max) = points.min(axis=0), points.max(axis=0)
        return cls(float(x_min), float(x_max), float(y_min), float(y_max))


def view_box(scenario: Scenario, points: ArrayLike | None = None) -> Box:
    """What to show: the workspace and the motion, whatever obstacles lie far away.

    If the workspace is more than 2.2 times as large as the motion's own box, only the motion's surroundings
    are shown, within the workspace.

    Args:
        scenario: Its workspace counts.
        points: Points of the motion, shape (n, 2), for example the swept area's corners.
    """
    workspace = Box.around(scenario.workspace.vertices)
    if points is None or not len(np.asarray(points)):
        return workspace.grown(0.02 * max(workspace.width, workspace.height))
    motion = Box.around(points)
    size = max(motion.width, motion.height)
    if max(workspace.width, workspace.height) > _CROWDED * size:
        near = motion.grown(0.35 * size)
        shown = Box(
            max(near.x_min, workspace.x_min),
            min(near.x_max, workspace.x_max),
            max(near.y_min, workspace.y_min),
            min(near.y_max, workspace.y_max),
        )
    else:
        shown = workspace
    both = Box.around([(shown.x_min, shown.y_min), (shown.x_max, shown.y_max), *np.asarray(points, dtype=float)])
    return both.grown(0.02 * max(both.width, both.height))


def frame_axes(axes: Axes, box: Box, offset: ArrayLike = (0.0, 0.0)) -> None:
    """Show exactly the box, at equal scales, with ticks at round coordinates of the user's own file.

    Args:
        axes: Drawn in recentred coordinates.
        box: The view, recentred, m.
        offset: What was subtracted on load, m; far away from 0 a round part of it moves to the axis labels.
    """
    axes.set_xlim(box.x_min, box.x_max)
    axes.set_ylim(box.y_min, box.y_max)
    axes.set_aspect("equal", adjustable="box")
    axes.set_facecolor(style.OUTSIDE)
    axes.tick_params(length=3, width=0.8)
    for axis, name, shift in zip((axes.xaxis, axes.yaxis), "xy", np.asarray(offset, dtype=float).tolist(), strict=True):
        base = round(shift, -1) if abs(shift) >= _LARGEST_TICK_OFFSET else 0.0
        axis.set_major_locator(_ShiftedLocator(shift))
        axis.set_major_formatter(FuncFormatter(_tick_text(shift - base)))
        sign = "\N{MINUS SIGN}" if base > 0 else "+"
        axis.set_label_text(
            f"{name} {sign} {abs(base):,.0f} (m)".replace(",", "\N{THIN SPACE}") if base else f"{name} (m)"
        )


def _tick_text(shift: float) -> Callable[[float, int | None], str]:
    return lambda value, _: f"{round(value + shift, 6) + 0.0:.10g}".replace("-", "\N{MINUS SIGN}")


class _ShiftedLocator(MaxNLocator):
    """Ticks that are round numbers once ``shift`` is added to them."""

    def __init__(self, shift: float) -> None:
        super().__init__(nbins=8, steps=[1, 2, 5, 10], min_n_ticks=3)
        self._shift = shift

    def tick_values(self, vmin: float, vmax: float) -> list[float]:
        ticks = super().tick_values(vmin + self._shift, vmax + self._shift)
        return [float(tick) - self._shift for tick in ticks]
