"""Titles, captions and legends: what a picture says in words."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from decimal import ROUND_FLOOR, Decimal
from typing import Any

from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.offsetbox import AnchoredOffsetbox, HPacker, TextArea
from matplotlib.patches import Patch

from tightspot.plotting import style
from tightspot.verification import Certificate

_TITLE_LETTER = 0.178  # inches, of the title's font on average
_LEGEND = {True: 7.3, False: 3.6}  # inches, of the legend with and without a path


def shortened(text: str, length: int) -> str:
    """One line of at most ``length`` characters."""
    line = " ".join(text.split())
    return line if len(line) <= length else line[: length - 1] + "…"


def put_title(
    figure: Figure,
    left: float,
    title: str,
    words: Iterable[tuple[str, str, bool]],
    *,
    path: bool = True,
    more: float = 0.0,
) -> None:
    """The title and below it one line of coloured words.

    Args:
        figure: Where to write.
        left: Of both lines, inches.
        title: Taken literally, shortened to the room that the legend leaves.
        words: (text, colour, bold) one after the other.
        path: Whether the legend explains a path and so is a long one.
        more: Width of what else is in the legend, inches.
    """
    width, height = figure.get_size_inches()
    x, y = left / width, 1 - 0.16 / height
    title = shortened(title, max(8, int((width - left - _LEGEND[path] - more) / _TITLE_LETTER)))
    figure.text(x, y, title, fontsize=17, fontweight="bold", va="top", parse_math=False)
    boxes: list[Artist] = [
        TextArea(
            text,
            textprops={
                "color": color,
                "fontsize": 11,
                "fontweight": "bold" if bold else "normal",
                "parse_math": False,
            },
        )
        for text, color, bold in words
    ]
    line = AnchoredOffsetbox(
        "upper left",
        child=HPacker(children=boxes, align="baseline", pad=0, sep=7),
        frameon=False,
        pad=0,
        borderpad=0,
        bbox_to_anchor=(x, y - 0.38 / height),
        bbox_transform=figure.transFigure,
    )
    figure.add_artist(line)


def verdict(certificate: Certificate | None) -> tuple[str, str, bool]:
    """What the judge said, as one coloured word for :func:`put_title`; the clearance is rounded down."""
    if certificate is None:
        return "not judged", style.SOFT_INK, True
    if not certificate.certified:
        reasons = [*map(str, certificate.witnesses), *(check.sentence for check in certificate.failed)]
        return shortened(": ".join(["✗ not certified", *reasons[:1]]), 80), style.BAD, True
    if math.isinf(certificate.clearance):
        return "✓ certified for all times: nothing to touch", style.GOOD, True
    return f"✓ certified for all times: clearance ≥ {floor_mm(certificate.clearance)} m", style.GOOD, True


def floor_mm(length: float) -> str:
    """A length in m with three decimals, rounded down: a bound must not be promised larger than it is."""
    return str(Decimal(repr(float(length))).quantize(Decimal("0.001"), ROUND_FLOOR))


def gear_changes(count: int) -> str:
    """The number of gear changes in words."""
    return {0: "no gear change", 1: "1 gear change"}.get(count, f"{count} gear changes")


def put_legend(figure: Figure, *, sweep: bool = True, path: bool = True, more: Sequence[Line2D | Patch] = ()) -> None:
    """The meaning of the plan view's colours and line styles, in one row at the upper right."""
    width, height = figure.get_size_inches()
    handles: list[Line2D | Patch] = []
    if path:
        dot: dict[str, Any] = {
            "markerfacecolor": "white",
            "markeredgecolor": style.INK,
            "markeredgewidth": 1.3,
        }
        handles += [
            Line2D([], [], color=style.FORWARD, linewidth=2.6, label="forward"),
            Line2D([], [], color=style.REVERSE, linewidth=2.6, label="reverse"),
            Line2D([], [], linestyle="", marker="o", markersize=9, label="gear change", **dot),
        ]
    handles += [
        Patch(facecolor="white", edgecolor=style.INK, linewidth=1.4, linestyle=(0, (3, 1.6)), label="start"),
        Patch(facecolor="white", edgecolor=style.INK, linewidth=1.8, label="goal"),
    ]
    if sweep:
        handles.append(Patch(facecolor=style.SWEEP, alpha=0.35, linewidth=0, label="swept area"))
    handles.append(Patch(facecolor=style.OBSTACLE, edgecolor=style.OBSTACLE_EDGE, label="obstacle"))
    handles += more
    figure.legend(
        handles=handles,
        loc="upper right",
        bbox_to_anchor=(1 - 0.35 / width, 1 - 0.14 / height),
        ncols=len(handles),
        borderpad=0,
        borderaxespad=0,
        columnspacing=1.5,
        handletextpad=0.5,
        handlelength=1.6,
        fontsize=9.5,
    )
