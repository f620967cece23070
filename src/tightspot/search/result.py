"""What a search found, or why it found nothing."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from tightspot.search.options import Direction, Resolution
from tightspot.search.path import Path

Array = NDArray[np.float64]


class SearchStatus(Enum):
    """How a search ended; the value is the sentence that says so."""

    FOUND = "A path was found."
    EXHAUSTED = "There is no path within the search's resolution: everything that can be reached was looked at."
    LIMIT_REACHED = "No path was found before the limit on expansions was reached; there may be one."
    TIME_LIMIT = "No path was found before the time limit; there may be one."
    START_BLOCKED = "The start pose does not keep the margin, so no path can begin there."
    GOAL_BLOCKED = "The goal pose does not keep the margin, so no path can end there."

    @property
    def sentence(self) -> str:
        """The value, for people."""
        return self.value


@dataclass(frozen=True)
class Attempt:
    """One search with one resolution, margin and direction.

    Attributes:
        resolution: How finely poses were told apart.
        margin: Demanded clearance to obstacles, m.
        direction: The end it began at.
        outcome: How it ended.
        expansions: Poses from which arcs were tried.
        nodes: Poses reached.
        pose_checks: Collision checks of a body at a pose.
        pair_tests: Tests of a body against one obstacle, after the broad phase.
        seconds: Wall time.
        cost: Of the path found, before shortcuts are taken out of it no cheaper than after; ``None`` without path.
        blocking: If start or goal was blocked: index of the obstacle, or -1 for the workspace.
        clearance: If start or goal was blocked: signed distance to that, m (negative: overlap).
    """

    resolution: Resolution
    margin: float
    direction: Direction
    outcome: SearchStatus
    expansions: int
    nodes: int
    pose_checks: int
    pair_tests: int
    seconds: float
    cost: float | None = None
    blocking: int | None = None
    clearance: float | None = None

    def describe(self) -> str:
        """One line: what was tried and how it ended."""
        tried = f"{self.resolution.name}, margin {self.margin:g} m, {self.direction.value}"
        if self.blocking is not None:
            what = "the workspace's border" if self.blocking < 0 else f"obstacle {self.blocking}"
            return f"{tried}: {self.outcome.name.lower()} by {what} (clearance {self.clearance:.3f} m)"
        return f"{tried}: {self.outcome.name.lower()} after {self.expansions} expansions, {self.seconds:.2f} s"


@dataclass(frozen=True, eq=False)
class SearchResult:
    """A path, or the attempts that found none.

    Attributes:
        status: How the search ended.
        path: ``None`` unless the status is ``FOUND``.
        attempts: What was tried, in order.
        closed_poses: With ``keep_closed``: the poses expanded, shape (n, 3); otherwise (0, 3).
    """

    status: SearchStatus
    path: Path | None
    attempts: tuple[Attempt, ...]
    closed_poses: Array

    @property
    def expansions(self) -> int:
        """Of all attempts."""
        return sum(attempt.expansions for attempt in self.attempts)

    @property
    def seconds(self) -> float:
        """Wall time of all attempts, s."""
        return sum(attempt.seconds for attempt in self.attempts)

    def explain(self) -> str:
        """The status in a sentence and, without a path, what was tried."""
        if self.path is not None:
            return (
                f"{self.status.sentence} {self.path.length:.1f} m with {self.path.gear_changes} gear changes, "
                f"margin {self.attempts[-1].margin:g} m, {self.expansions} expansions in {self.seconds * 1e3:.0f} ms."
            )
        tried = "; ".join(attempt.describe() for attempt in self.attempts)
        return f"{self.status.sentence} Tried: {tried}."
