"""How hybrid A* searches."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np

from tightspot.errors import InputError, Problem


class Direction(Enum):
    """At which end a search begins; the value says so."""

    BACKWARD = "from the goal outwards"
    FORWARD = "from the start onwards"
    TIGHT_END = "from the end with less room"
    WIDE_END = "from the end with more room"


@dataclass(frozen=True)
class Resolution:
    """How finely poses are told apart. Lengths are parts of the body's narrowest extent (a car's width).

    Attributes:
        name: For people.
        cell: Side of a position cell.
        heading_bins: Heading cells of a full turn.
        step: Length of an arc (twice that in the open).
        max_expansions: An attempt at this resolution gives up after this many.
    """

    name: str
    cell: float
    heading_bins: int
    step: float
    max_expansions: int


COARSE = Resolution("coarse", cell=0.2, heading_bins=72, step=0.3, max_expansions=30_000)
MEDIUM = Resolution("medium", cell=0.1, heading_bins=108, step=0.18, max_expansions=100_000)
FINE = Resolution("fine", cell=0.05, heading_bins=180, step=0.1, max_expansions=200_000)
FINEST = Resolution("finest", cell=0.025, heading_bins=360, step=0.05, max_expansions=200_000)


@dataclass(frozen=True)
class HybridAStarOptions:
    """What a path costs, how closely to look, and when to give up.

    Costs are in metres of straight driving forwards.

    Attributes:
        resolutions: Tried in this order, each with every margin.
        margins: Demanded clearance to obstacles, m, tried in this order. A path with a larger margin makes
            a better guess, so begin with the larger.
        directions: Ends to begin at, tried in this order until one attempt does not just run into its limit.
            From the end with less room, usually the goal, is several times faster.
        curvature_factor: Largest curvature used, relative to the vehicle's.
        gear_change: Cost of changing between forwards and reverse.
        reverse: Factor on the way driven in reverse.
        steering: Further cost of a metre at full steering, in proportion at less.
        steering_change: Cost of turning the wheels from straight to full.
        steering_levels: Curvatures tried at each pose from full left to full right; odd, at least 5.
        heuristic_weight: 1 for the best path the resolution allows, more for an earlier one.
        max_words: Reeds-Shepp curves tried from a pose, cheapest first.
        extra_expansions: After the first path, look for a better one for so many expansions, or half of
            those the first took if these are more.
        shortcuts: Replace stretches of the path by cheaper Reeds-Shepp curves afterwards.
        max_expansions: Upper limit for every attempt.
        time_limit: For all attempts together, s.
        spacing: Largest distance of the path's poses, m.
        keep_closed: Also return the poses expanded, to show how far the search came.

    Raises:
        InputError: A number is outside its range; all such are named.
    """

    resolutions: tuple[Resolution, ...] = (COARSE, MEDIUM, FINE, FINEST)
    margins: tuple[float, ...] = (0.1, 0.05, 0.02)
    directions: tuple[Direction, ...] = (Direction.TIGHT_END, Direction.WIDE_END)
    curvature_factor: float = 0.95
    gear_change: float = 2.0
    reverse: float = 1.0
    steering: float = 0.1
    steering_change: float = 0.5
    steering_levels: int = 5
    heuristic_weight: float = 1.0
    max_words: int = 10
    extra_expansions: int = 1000
    shortcuts: bool = True
    max_expansions: int = 300_000
    time_limit: float = 10.0
    spacing: float = 0.1
    keep_closed: bool = False

    def __post_init__(self) -> None:
        problems = [
            Problem(field, f"{getattr(self, field)} must be {meaning}")
            for field, (is_right, meaning) in _RANGES.items()
            if not is_right(getattr(self, field))
        ]
        if problems:
            raise InputError(problems)


def _is_at_least(low: float) -> Callable[[Any], bool]:
    return lambda value: bool(np.isfinite(value) and value >= low)


_RANGES: dict[str, tuple[Callable[[Any], bool], str]] = {
    "resolutions": (lambda given: len(given) > 0, "at least one Resolution"),
    "margins": (
        lambda given: len(given) > 0 and all(map(_is_at_least(0), given)),
        "distances of 0 m or more",
    ),
    "directions": (lambda given: len(given) > 0, "at least one Direction"),
    "curvature_factor": (lambda given: 0 < given <= 1, "above 0 and at most 1"),
    "gear_change": (_is_at_least(0), "a cost of 0 or more"),
    "reverse": (_is_at_least(1), "a factor of 1 or more"),
    "steering": (_is_at_least(0), "a cost of 0 or more"),
    "steering_change": (_is_at_least(0), "a cost of 0 or more"),
    "steering_levels": (lambda given: given >= 5 and given % 2 == 1, "an odd number, 5 or more"),
    "heuristic_weight": (_is_at_least(1), "1 or more"),
    "max_words": (_is_at_least(1), "1 or more"),
    "extra_expansions": (_is_at_least(0), "0 or more"),
    "max_expansions": (_is_at_least(1), "1 or more"),
    "time_limit": (lambda given: given > 0, "a positive number of seconds"),
    "spacing": (lambda given: bool(np.isfinite(given) and given > 0), "a positive distance in m"),
}
