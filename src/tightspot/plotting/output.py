"""Figures to files: format by the name's ending, the same bytes for the same picture, whole files or none."""

from __future__ import annotations

import io
import warnings
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from tightspot.errors import InputError, Problem
from tightspot.files import atomic_write
from tightspot.plotting import style
from tightspot.plotting.animation import save_animation
from tightspot.plotting.plan_figure import figure_plan
from tightspot.verification import Plan

_METADATA: dict[str, dict[str, Any]] = {
    ".png": {"Software": "tightspot"},
    ".svg": {"Date": None, "Creator": "tightspot"},
    ".pdf": {"CreationDate": None, "ModDate": None, "Creator": "tightspot", "Producer": "tightspot"},
}
FIGURE_FORMATS = tuple(_METADATA)
ANIMATION_FORMATS = (".gif", ".mp4")
PLAN_FORMATS = (*FIGURE_FORMATS, *ANIMATION_FORMATS)


def save(figure: Figure, path: str | Path, *, dpi: float | None = None) -> None:
    """Write a figure as PNG, SVG or PDF, by the ending of the name.

    The same figure gives the same bytes: no dates, no random identifiers.

    Args:
        figure: What to write.
        path: Where to.
        dpi: Pixels an inch, by default the figure's own.

    Raises:
        InputError: For any other ending.
        OSError: The file cannot be written; an old file of that name is then unchanged.
    """
    ending = checked_ending(path, FIGURE_FORMATS)
    buffer = io.BytesIO()
    with style.drawing(), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing from")  # names in scripts the font lacks: boxes
        figure.savefig(buffer, format=ending[1:], dpi=dpi or "figure", metadata=_METADATA[ending])
    atomic_write(path, buffer.getvalue())


def show_plan(plan: Plan, path: str | Path) -> None:
    """The plan's picture (PNG, SVG, PDF) or animation (GIF, MP4), by the ending of the name.

    Raises:
        InputError: For any other ending.
        TightspotError: An MP4 is asked for and there is no ffmpeg.
        OSError: The file cannot be written; an old file of that name is then unchanged.
    """
    if checked_ending(path, PLAN_FORMATS) in ANIMATION_FORMATS:
        save_animation(plan, path)
    else:
        save(figure_plan(plan), path)


def checked_ending(path: str | Path, allowed: tuple[str, ...]) -> str:
    """The name's ending in lower case; raises :class:`InputError` with the list if it is not one of them."""
    ending = Path(path).suffix.lower()
    if ending not in allowed:
        given = f"the ending {ending!r}" if ending else "no ending"
        raise InputError(Problem("", f"{path} has {given}; a picture's name must end in {', '.join(allowed)}"))
    return ending
