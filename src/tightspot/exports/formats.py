"""Every file that a plan can become, by name and by the ending of the file's name."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tightspot.errors import InputError, Problem
from tightspot.exports.commonroad_solution import write_commonroad_solution
from tightspot.exports.ros import write_ros_path, write_ros_trajectory
from tightspot.problems import near
from tightspot.verification import Plan, save_plan, write_trajectory_csv


@dataclass(frozen=True)
class Format:
    """A kind of file.

    Attributes:
        name: For ``format=`` and the command line.
        ending: Of file names; a name that ends so means this format unless another is asked for.
        summary: What it is, for people.
        write: ``write(plan, path, **options)``, complete or not at all; may return sentences for people.
    """

    name: str
    ending: str
    summary: str
    write: Callable[..., list[str] | None]

    @property
    def options(self) -> tuple[str, ...]:
        """Names of the options that :func:`export_plan` passes on."""
        parameters = inspect.signature(self.write).parameters.values()
        return tuple(p.name for p in parameters if p.name not in ("plan", "path"))


def _picture(plan: Plan, path: str | Path) -> None:
    from tightspot import plotting  # only here, so that no other format loads matplotlib

    plotting.show_plan(plan, path)


def _animation(plan: Plan, path: str | Path, *, fps: float = 20.0, speedup: float | None = None) -> None:
    from tightspot import plotting

    plotting.save_animation(plan, path, fps=fps, speedup=speedup)


FORMATS: dict[str, Format] = {
    entry.name: entry
    for entry in (
        Format("csv", ".csv", "states and inputs over time", write_trajectory_csv),
        Format("ros-path", ".path.json", "nav_msgs/msg/Path", write_ros_path),
        Format("ros-trajectory", ".trajectory.json", "autoware_planning_msgs/msg/Trajectory", write_ros_trajectory),
        Format("plan", ".json", "the plan file itself", save_plan),
        Format("commonroad-solution", ".xml", "CommonRoad solution (KS)", write_commonroad_solution),
        Format("svg", ".svg", "picture", _picture),
        Format("png", ".png", "picture", _picture),
        Format("pdf", ".pdf", "picture", _picture),
        Format("gif", ".gif", "animation", _animation),
        Format("mp4", ".mp4", "animation (needs ffmpeg)", _animation),
    )
}
"""In the order in which endings are tried: ``.path.json`` before ``.json``."""


def format_of(path: str | Path, name: str | None = None) -> Format:
    """The format of that name, or the one that the file's name ends with.

    Raises:
        InputError: There is none such; the message lists those there are.
    """
    if name is not None:
        if name in FORMATS:
            return FORMATS[name]
        guesses = near(name, FORMATS)
        advice = f"did you mean {guesses[0]!r}?" if guesses else f"there are {', '.join(FORMATS)}"
        raise InputError(Problem("format", f"{name!r} is not known; {advice}"))
    lowered = Path(path).name.lower()
    for entry in FORMATS.values():
        if lowered.endswith(entry.ending):
            return entry
    endings = ", ".join(f"{entry.ending}" for entry in FORMATS.values())
    raise InputError(Problem("", f"{path} has no ending that tells the format; endings are {endings}"))


def export_plan(plan: Plan, path: str | Path, format: str | None = None, **options: Any) -> list[str]:  # noqa: A002
    """Write a plan in any format that others read.

    Args:
        plan: The plan. Whether it is certified is not asked here.
        path: Where to; written completely or not at all.
        format: Name of one of :data:`FORMATS`; default: by the ending of ``path``.
        options: Of the format's ``write``; one that is ``None`` counts as not given.

    Returns:
        Sentences for people about what was written; usually none.

    Raises:
        InputError: No such format, or an option that it has not.
        OSError: The file cannot be written; an old one is then unchanged.
        TightspotError: Something that the format needs is not installed.
    """
    chosen = format_of(path, format)
    given = {key: value for key, value in options.items() if value is not None}
    strange = [key for key in given if key not in chosen.options]
    if strange:
        known = ", ".join(chosen.options) or "none"
        raise InputError(
            [Problem(key, f"is no option of the format {chosen.name!r}; it has {known}") for key in strange]
        )
    return chosen.write(plan, path, **given) or []
