"""Curves over time: states and inputs between their limits, clearance above what is demanded and proved."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike, NDArray

from tightspot.plotting import style
from tightspot.plotting.captions import floor_mm
from tightspot.plotting.motion import Leg

Array = NDArray[np.float64]

LIMIT_GID = "limit"
MARGIN_GID = "margin"
CERTIFIED_GID = "certified"

_ROOM = 0.12
"""Free space beyond the limits, relative to their distance."""


def draw_profile(
    axes: Axes,
    times: ArrayLike,
    values: ArrayLike,
    limits: tuple[float, float],
    *,
    label: str,
    legs: Sequence[Leg] | None = None,
) -> None:
    """One state or input over time between its limits.

    Args:
        axes: Where to draw.
        times: s, shape (M,).
        values: Shape (M,) for a state; shape (M-1,) for an input, which is constant between the times.
        limits: Lower and upper bound in the unit of the values; infinite ones are not drawn.
        label: Of the vertical axis, with unit.
        legs: If given, the area between the curve and zero has the colour of each leg's gear.
    """
    times, values = np.asarray(times, dtype=float), np.asarray(values, dtype=float)
    if values.size == times.size:
        axes.plot(times, values, color=style.INK, linewidth=1.4, zorder=4)
    else:
        axes.stairs(values, times, baseline=None, color=style.INK, linewidth=1.4, zorder=4)
    for leg in legs or ():
        part = slice(leg.first, leg.last + 1)
        axes.fill_between(times[part], values[part], color=style.GEAR[leg.gear], alpha=0.3, linewidth=0, zorder=3)
    for limit in limits:
        if np.isfinite(limit):
            line = axes.axhline(limit, color=style.LIMIT, linestyle=(0, (4, 2)), linewidth=1.1, zorder=2)
            line.set_gid(LIMIT_GID)
    shown = np.concatenate([values, [limit for limit in limits if np.isfinite(limit)]])
    low, high = float(shown.min()), float(shown.max())
    room = _ROOM * ((high - low) or 1.0)
    axes.set_ylim(low - room, high + room)
    axes.set_ylabel(label)
    _time_axis(axes, times)


def draw_clearance(
    axes: Axes,
    times: ArrayLike,
    clearance: ArrayLike,
    *,
    margin: float | None,
    certified: float | None = None,
    proved: tuple[Array, Array] | None = None,
) -> None:
    """The clearance over time with the demanded margin and the bound that is certified for all times.

    Large clearances, which nobody asks about, leave the picture at its top.

    Args:
        axes: Where to draw.
        times: s, shape (M,).
        clearance: Signed distance to the nearest obstacle at those times, m, shape (M,).
        margin: What was demanded, m; ``None`` draws no line.
        certified: Proved lower bound over all times, m; ``None`` if there is none.
        proved: Cuts of the horizon (K+1,), s, and the proved lower bound between them (K,), m.
    """
    times, clearance = np.asarray(times, dtype=float), np.asarray(clearance, dtype=float)
    lowest = min(float(clearance.min(initial=0.0)), 0.0)
    bound = certified if certified is not None and np.isfinite(certified) else 0.0
    reference = max(margin or 0.0, bound, -lowest)
    finite = clearance[np.isfinite(clearance)]
    shown = max(1.0, 5 * reference, 1.5 * float(finite.min()) if finite.size else 0.0)
    highest = min(1.06 * float(finite.max(initial=0.2)), shown)
    if proved is not None:
        cuts, bounds = proved
        bounds = np.clip(bounds, lowest, 2 * highest)
        axes.stairs(bounds, cuts, fill=True, color=style.GOOD, alpha=0.15, linewidth=0, zorder=2, label="proved")
    axes.plot(times, clearance, color=style.INK, linewidth=1.6, zorder=4)
    if lowest < 0:
        axes.fill_between(times, np.minimum(clearance, 0), color=style.BAD, alpha=0.3, linewidth=0, zorder=3)
        axes.axhline(0.0, color=style.BAD, linewidth=1.0, zorder=3)
    if margin is not None:
        line = axes.axhline(margin, color=style.SOFT_INK, linestyle=(0, (4, 2)), linewidth=1.2, zorder=5)
        line.set(gid=MARGIN_GID, label=f"demanded {margin:.3f} m")
    if certified is not None and np.isfinite(certified):
        label = f"certified {floor_mm(certified)} m"
        axes.axhline(certified, gid=CERTIFIED_GID, color=style.GOOD, linewidth=1.6, zorder=5, label=label)
    axes.set_ylim(lowest - (0.06 * (highest - lowest) if lowest < 0 else 0.0), highest)
    if not finite.size:
        look: dict[str, Any] = {"ha": "center", "va": "center", "color": style.SOFT_INK}
        axes.text(0.5, 0.6, "no obstacles", transform=axes.transAxes, **look)
    axes.set_ylabel("clearance (m)")
    if axes.get_legend_handles_labels()[0]:
        axes.legend(
            loc="lower left",
            bbox_to_anchor=(0.0, 1.0),
            ncols=3,
            fontsize=8.5,
            borderpad=0,
            borderaxespad=0.3,
            columnspacing=1.1,
            handlelength=1.2,
            handletextpad=0.5,
        )
    _time_axis(axes, times)


def mark_gear_changes(axes: Axes, times: ArrayLike, legs: Sequence[Leg], *, numbers: bool = False) -> None:
    """Thin vertical lines at the gear changes, with their numbers above the axes if wanted."""
    times = np.asarray(times, dtype=float)
    for number, leg in enumerate(legs[1:], start=1):
        axes.axvline(times[leg.first], color=style.LIMIT, linewidth=0.8, linestyle=":", zorder=1)
        if numbers:
            axes.annotate(
                str(number),
                (times[leg.first], 1.0),
                xycoords=axes.get_xaxis_transform(),
                xytext=(0, 8),
                textcoords="offset points",
                ha="center",
                va="center_baseline",
                fontsize=8,
                fontweight="bold",
                bbox={
                    "boxstyle": "circle,pad=0.25",
                    "facecolor": "white",
                    "edgecolor": style.INK,
                    "linewidth": 1.1,
                },
            )


def _time_axis(axes: Axes, times: Array) -> None:
    axes.set_xlim(float(times[0]), float(times[-1]))
    axes.xaxis.set_major_locator(MaxNLocator(nbins=8, steps=[1, 2, 5, 10]))
    axes.yaxis.set_major_locator(MaxNLocator(nbins=4, steps=[1, 2, 5, 10], min_n_ticks=3))
    style.quiet_axes(axes)
