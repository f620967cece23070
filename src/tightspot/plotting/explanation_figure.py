"""One picture for each kind of failure."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from tightspot.plotting.blocked_figure import figure_blocked
from tightspot.plotting.failure_figure import figure_failure
from tightspot.plotting.reach_figure import figure_reach

if TYPE_CHECKING:
    from tightspot.planner import Explanation


def figure_explanation(explanation: Explanation) -> Figure:
    """Why there is no plan, as a picture.

    A blocked start or goal with the nearest free place; the region that the search reached with the closest pose and
    the place that is too narrow; the solver's last iterate with its worst moment; the trajectory that penetrates least
    with its contacts; the trajectory that was not certified with the judge's witness.

    Args:
        explanation: Of :class:`tightspot.errors.PlanningError` or :class:`tightspot.errors.BlockedError`.
    """
    caption = f"✗ {caption_of(explanation)}"
    if explanation.blocked:
        return figure_blocked(explanation, caption)
    if explanation.trajectory is None:
        return figure_reach(explanation, caption)
    contacts = explanation.penetration.contacts if explanation.penetration is not None else ()
    stopped = explanation.solver if explanation.kind.word == "solver-stopped" else None
    return figure_failure(
        explanation.scenario,
        explanation.vehicle,
        explanation.trajectory,
        explanation.witness,
        reason=caption,
        contacts=contacts if explanation.kind.word == "only-penetrating" else (),
        replayed=stopped is None,
        marked=None if stopped is None else stopped.pose,
    )


def caption_of(explanation: Explanation) -> str:
    """What the picture shows, in a line."""
    kind = explanation.kind.word
    if explanation.blocked:
        end = explanation.blocked[0]
        return f"{end.end} blocked: {end.faults[0]}; {end.remedy}"
    if kind == "no-path":
        return _no_path(explanation)
    if kind == "solver-stopped":
        return _solver_stopped(explanation)
    if kind == "only-penetrating":
        return f"only trajectories that come too near: {explanation.witness}"
    return f"not certified: {explanation.witness}" if explanation.witness else "not certified"


def _solver_stopped(explanation: Explanation) -> str:
    stop = explanation.solver
    if stop is None:
        return "there is no guess to begin with"
    status = stop.status.sentence.rstrip(".")
    return f"the solver stopped: {status[0].lower()}{status[1:]}" + (f"; {stop.worst}" if stop.worst else "")


def _no_path(explanation: Explanation) -> str:
    narrow, reach = explanation.bottleneck, explanation.reach
    if narrow is not None and narrow.room:
        return f"no path: room for {narrow.room:.3f} m, the body needs {narrow.needed:.3f} m"
    if narrow is not None:
        return f"no path: {narrow.describe(explanation.scenario.offset)}"
    if reach is not None:
        what = "no path" if reach.is_exhaustive else "no path found"
        return f"{what} with a margin of {reach.margin:g} m: the nearest pose is {reach.distance:.2f} m from the goal"
    return "no path"
