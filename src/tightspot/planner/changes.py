"""How far start, goal and obstacles moved from one request to the next."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tightspot.planner.request import Request
from tightspot.scenarios import Scenario

Array = NDArray[np.float64]

FAR = 1.0
TURNED = np.radians(20.0)
"""What moved or turned farther (m, rad) is planned for anew."""


@dataclass(frozen=True)
class Changes:
    """What moved, m and rad.

    Attributes:
        start: Distance of the start's position.
        start_heading: Angle between its headings.
        goal: The same of the goal.
        goal_heading: See ``start_heading``.
        obstacles: Largest distance that an obstacle's corner moved.
    """

    start: float
    start_heading: float
    goal: float
    goal_heading: float
    obstacles: float

    def to_dict(self) -> dict[str, float]:
        """Plain data for the report."""
        return dict(vars(self))


def changes_between(old: Request, new: Request) -> Changes | str:
    """How far things moved; or in one clause why the old solution is no start for the new problem.

    Both requests differ in the scene's start, goal and obstacles only.
    """
    before, after = old.scenario, new.scenario
    for end in ("start", "goal"):
        if not np.array_equal(np.isnan(getattr(before, end)), np.isnan(getattr(after, end))):
            return f"other entries of the {end} are free"
    shift = _largest_shift(before, after)
    if shift is None:
        return "obstacles came, went or changed their shape"
    (start, start_heading), (goal, goal_heading) = (
        _moved(getattr(before, end), getattr(after, end)) for end in ("start", "goal")
    )
    changes = Changes(start, start_heading, goal, goal_heading, shift)
    for name, value in changes.to_dict().items():
        turned = name.endswith("heading")
        if value > (TURNED if turned else FAR):
            amount = f"turned by {np.degrees(value):.0f} deg" if turned else f"moved by {value:.2f} m"
            return f"{name.removesuffix('_heading')} {amount}"
    return changes


def _moved(before: Array, after: Array) -> tuple[float, float]:
    """Distance of the positions and angle between the headings, whole turns aside."""
    turn = (after[2] - before[2] + np.pi) % (2 * np.pi) - np.pi
    return float(np.hypot(*(after - before)[:2])), float(abs(turn))


def _largest_shift(before: Scenario, after: Scenario) -> float | None:
    """Largest distance that a corner of the obstacles' convex parts moved, m; ``None`` if they do not correspond."""
    if after.obstacles is before.obstacles:
        return 0.0
    old, new = before.obstacle_polygons, after.obstacle_polygons
    if not np.array_equal(old.first, new.first):
        return None
    return float(np.hypot(*(new.vertices - old.vertices).T).max(initial=0.0))
