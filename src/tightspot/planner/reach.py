"""How far a search came that found no path."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot.guesses.base import known
from tightspot.scenarios import Scenario
from tightspot.scenarios.clearances import clearance, workspace_excess
from tightspot.search import Direction, HybridAStarOptions, SearchResult, SearchStatus, search
from tightspot.vehicles import SingleTrack

Array = NDArray[np.float64]

SECONDS = 1.5
"""For each of the two searches that show what can be reached."""

_ENCLOSED = 0.1


@dataclass(frozen=True, eq=False)
class Reach:
    """What hybrid A* came to. Poses are (x m, y m, theta rad) in the scenario's coordinates.

    Attributes:
        margin: Smallest clearance that was tried, m.
        resolution: The finest resolution at which everything within reach was looked at; ``None``: at none.
        expansions: Poses from which arcs were tried, in all attempts.
        seconds: Wall time of all attempts.
        limit: What stopped the attempts that did not end by themselves, for people; empty if all did.
        from_start: Poses reached from the start, (n, 3).
        from_goal: Poses from which the goal is reached, (m, 3).
        closest: The pose reached from the start that is closest to the goal by how far body points may lie, (3,).
        distance: Distance of its position from the goal's, m.
        heading_gap: Difference of its heading from the goal's, rad.
        enclosed: ``start`` or ``goal`` if hardly anything can be reached from there, else empty.
        is_proof: Whether no path keeps the smallest margin at whatever resolution.
        refused: The end that the search took to be blocked, with what is nearest there, for people; else empty.
    """

    margin: float
    resolution: str | None
    expansions: int
    seconds: float
    limit: str
    from_start: Array
    from_goal: Array
    closest: Array
    distance: float
    heading_gap: float
    enclosed: str
    is_proof: bool
    refused: str = ""

    @property
    def is_exhaustive(self) -> bool:
        """Whether there is no path at :attr:`resolution`, rather than none found."""
        return self.resolution is not None

    def describe(self, offset: Array) -> str:
        """How far it came, with coordinates of the file."""
        x, y = self.closest[:2] + offset
        came = f"the nearest pose to the goal that it reached is ({x:.2f}, {y:.2f}), {self.distance:.2f} m away"
        if self.heading_gap > np.radians(5):
            came += f" and {np.degrees(self.heading_gap):.0f} deg off in heading"
        walled = f"; the {self.enclosed} is walled in" if self.enclosed else ""
        return f"{came}{walled}"

    def to_dict(self, offset: Array) -> dict[str, Any]:
        """Plain data in the file's coordinates, without the lists of poses."""
        return {
            "margin": self.margin,
            "exhaustive_at_resolution": self.resolution,
            "is_proof": self.is_proof,
            "expansions": self.expansions,
            "seconds": self.seconds,
            "stopped_by": self.limit or None,
            "closest_pose": [*(self.closest[:2] + offset).tolist(), float(self.closest[2])],
            "distance_to_goal": self.distance,
            "heading_to_goal": self.heading_gap,
            "enclosed": self.enclosed or None,
            "poses_from_start": len(self.from_start),
            "poses_to_goal": len(self.from_goal),
        }


def reach_of(
    scenario: Scenario,
    car: SingleTrack,
    result: SearchResult,
    options: HybridAStarOptions | None,
    seconds: float = SECONDS,
) -> Reach:
    """From the attempts that failed, and two short searches that keep what they reach.

    Args:
        scenario: Where it was searched.
        car: With what.
        result: Without a path.
        options: Of that search; its default if ``None``.
        seconds: For each of the two searches.
    """
    margin = min(attempt.margin for attempt in result.attempts)
    ended = [
        attempt.resolution.name
        for attempt in result.attempts
        if attempt.margin == margin and (attempt.outcome is SearchStatus.EXHAUSTED or attempt.is_final)
    ]
    limits = {attempt.outcome for attempt in result.attempts} & {SearchStatus.LIMIT_REACHED, SearchStatus.TIME_LIMIT}
    options = options or HybridAStarOptions()
    goal = known(scenario.goal)[:3]
    from_start = _reached(scenario, car, margin, options, Direction.FORWARD, seconds)
    from_goal = _reached(scenario, car, margin, options, Direction.BACKWARD, seconds)
    away = np.hypot(*(from_start[:, :2] - goal[:2]).T)
    turned = np.abs((from_start[:, 2] - goal[2] + np.pi) % (2 * np.pi) - np.pi)
    body = max(part.polygon.radius for part in car.parts)
    closest = int(np.argmin(away + body * turned))
    refused = _refused(scenario, car, result)
    sizes = {"start": len(from_start), "goal": len(from_goal)}
    smaller = min(sizes, key=lambda end: sizes[end])
    return Reach(
        margin=margin,
        resolution=ended[-1] if ended else None,
        expansions=result.expansions,
        seconds=result.seconds,
        limit=" and ".join(sorted(_LIMITS[limit] for limit in limits)),
        from_start=from_start,
        from_goal=from_goal,
        closest=from_start[closest],
        distance=float(away[closest]),
        heading_gap=float(turned[closest]),
        enclosed=smaller if sizes[smaller] < _ENCLOSED * max(sizes.values()) else "",
        is_proof=result.is_proof and not refused,
        refused=refused,
    )


def _refused(scenario: Scenario, car: SingleTrack, result: SearchResult) -> str:
    """The end that is free by rounding only, which is not free enough for a search: it keeps a hair of room."""
    ends = {SearchStatus.START_BLOCKED: "start", SearchStatus.GOAL_BLOCKED: "goal"}
    end = ends.get(result.status)
    if end is None:
        return ""
    state = getattr(scenario, end)
    nearest, (excess, _) = clearance(scenario, car, state), workspace_excess(scenario, car, state)
    what = f"obstacle {nearest.obstacle!r}" if nearest.value < -excess else "the workspace's border"
    return f"the {end}, where the body is {max(min(nearest.value, -excess), 0.0):.3f} m from {what}"


_LIMITS = {SearchStatus.LIMIT_REACHED: "the limit on expansions", SearchStatus.TIME_LIMIT: "the time limit"}


def _reached(
    scenario: Scenario,
    car: SingleTrack,
    margin: float,
    options: HybridAStarOptions,
    direction: Direction,
    seconds: float,
) -> Array:
    """Poses expanded by one search from one end at a moderate resolution, that end among them."""
    resolution = options.resolutions[min(1, len(options.resolutions) - 1)]
    options = replace(
        options,
        resolutions=(resolution,),
        margins=(margin,),
        directions=(direction,),
        time_limit=seconds,
        keep_closed=True,
    )
    start, goal = known(scenario.start)[:3], known(scenario.goal)[:3]
    obstacles = scenario.obstacle_polygons
    result = search(scenario.workspace, obstacles, car, start, goal, options)
    root = start if direction is Direction.FORWARD else goal
    return np.vstack([root, result.closed_poses])
