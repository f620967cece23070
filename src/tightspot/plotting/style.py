"""Colours, sizes and the drawing context every figure is made in.

The two gear colours are from the palette of Okabe and Ito (2008), which people with any common colour vision
deficiency tell apart; every colour's meaning is also carried by a shape, a line style or a word.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

FORWARD = "#0072B2"
REVERSE = "#D55E00"
GEAR = {1: FORWARD, -1: REVERSE}
GEAR_NAME = {1: "forward", -1: "reverse"}

INK = "#1f2933"
SOFT_INK = "#5f6b7a"
FAINT = "#d9dde2"
GROUND = "#fbfaf7"
OUTSIDE = "#e7e8e6"
OBSTACLE = "#8d98a5"
OBSTACLE_EDGE = "#4d5866"
SWEEP = "#56B4E9"
BODY = "#ffffff"
GOOD = "#007a59"
BAD = "#c1121f"
REACHED = "#8e5ea2"
LIMIT = "#8a94a0"

DPI = 100

_CONTEXT: Any = {
    "font.family": ["DejaVu Sans"],
    "font.size": 10.0,
    "axes.edgecolor": "#9aa3ad",
    "axes.labelcolor": SOFT_INK,
    "axes.linewidth": 0.8,
    "text.color": INK,
    "xtick.color": SOFT_INK,
    "ytick.color": SOFT_INK,
    "xtick.labelsize": 9.0,
    "ytick.labelsize": 9.0,
    "legend.frameon": False,
    "hatch.linewidth": 0.6,
    "svg.hashsalt": "tightspot",
    "svg.fonttype": "path",
}


@contextmanager
def drawing() -> Iterator[None]:
    """matplotlib's defaults and our style, whatever the user's configuration, restored afterwards."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_CONTEXT)
        yield


def new_figure(width: float, height: float) -> Figure:
    """An empty figure of that many inches with its own Agg canvas, unknown to pyplot; whole pixels."""
    size = (round(width * DPI) / DPI, round(height * DPI) / DPI)
    figure = Figure(figsize=size, dpi=DPI, facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def quiet_axes(axes: Axes) -> None:
    """Axes of a curve: no top and right frame, a faint horizontal grid behind the data."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", color=FAINT, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.tick_params(length=3, width=0.8)
