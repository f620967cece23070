"""What a search found, or why it found nothing."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from tightspot.search.options import Direction
from tightspot.search.path import Array, Path
from tightspot.search.resolution import Resolution


class SearchStatus(Enum):
    """How a search ended; the value is the sentence that says so."""

    FOUND = "A path was found."
    EXHAUSTED = (
        "There is no path within the search's resolution: at the finest that was searched to its end, "
        "all that can be reached was looked at."
    )
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
        is_final: No resolution can find a path with this margin: start or goal is blocked, or not even the
            largest disc in the body about the rear-axle midpoint can get from one to the other.
        expansions: Poses from which arcs were tried.
        nodes: Poses reached.
        pose_checks: Collision checks of the body at a pose.
        pair_tests: Tests of the body against one obstacle that the broad phase let through.
        seconds: Wall time.
        cost: Of the path found, else ``None``.
        blocking: If start or goal was blocked: index of the obstacle, or -1 for the workspace.
        clearance: If start or goal was blocked: signed distance to that, m (negative: overlap).
    """

    resolution: Resolution
    margin: float
    direction: Direction
    outcome: SearchStatus
    is_final: bool
    expansions: int
    nodes: int
    pose_checks: int
    pair_tests: int
    seconds: float
    cost: float | None = None
    blocking: int | None = None
    clearance: float | None = None

    def describe(self) -> str:
        """What was tried and how it ended, in a line."""
        tried = f"margin {self.margin:g} m"
        if self.blocking is not None:
            what = "the workspace's border" if self.blocking < 0 else f"obstacle {self.blocking}"
            end = "start" if self.outcome is SearchStatus.START_BLOCKED else "goal"
            return f"{tried}: {end} blocked by {what} (clearance {self.clearance:.3f} m)"
        if self.is_final:
            return f"{tried}: proven, not even a disc in the body gets from one end to the other"
        how = f"{self.outcome.name.lower().replace('_', ' ')} after {self.expansions} expansions"
        return f"{tried}, {self.resolution.name}, {self.direction.value}: {how}"


@dataclass(frozen=True, eq=False)
class SearchResult:
    """A path, or the attempts that found none.

    Attributes:
        status: How the search ended.
        path: ``None`` unless the status is ``FOUND``.
        attempts: What was tried, in order, but the one that found the path last.
        closed_poses: With ``keep_closed``: the poses expanded, shape (n, 3); otherwise (0, 3).
    """

    status: SearchStatus
    path: Path | None
    attempts: tuple[Attempt, ...]
    closed_poses: Array

    @property
    def is_proof(self) -> bool:
        """Whether it is certain that no path keeps any of the margins, at whatever resolution."""
        return all(attempt.is_final for attempt in self.attempts)

    @property
    def expansions(self) -> int:
        """Of all attempts."""
        return sum(attempt.expansions for attempt in self.attempts)

    @property
    def seconds(self) -> float:
        """Wall time of all attempts, s."""
        return sum(attempt.seconds for attempt in self.attempts)

    def explain(self) -> str:
        """The status in a sentence; with a path its figures, without one what was tried."""
        if self.path is not None:
            return (
                f"{self.status.sentence} It is {self.path.length:.1f} m long with "
                f"{self.path.gear_changes} gear changes and a margin of {self.attempts[-1].margin:g} m "
                f"({self.expansions} expansions, {self.seconds * 1e3:.0f} ms)."
            )
        if self.status in (SearchStatus.START_BLOCKED, SearchStatus.GOAL_BLOCKED):
            return f"{self.status.sentence} Smallest {self.attempts[-1].describe()}."
        tried = "; ".join(attempt.describe() for attempt in self.attempts)
        return f"{self.status.sentence} Tried: {tried}."
