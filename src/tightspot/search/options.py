"""How hybrid A* searches."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from tightspot.search.ranges import MOST_EXPANSIONS, Ranges, above_0, at_least, check, count_from
from tightspot.search.resolution import COARSE, FINE, MEDIUM, NARROW, NARROWER, NARROWEST, SMALL_TURNS, Resolution


class Direction(Enum):
    """At which end a search begins; the value says so."""

    BACKWARD = "from the goal outwards"
    FORWARD = "from the start onwards"
    TIGHT_END = "from the end with less room"
    WIDE_END = "from the end with more room"


@dataclass(frozen=True)
class EndGears:
    """Gears in which a path must set out and arrive: +1 (forwards), -1 (in reverse), or 0 for either.

    Raises:
        InputError: A gear is something else.
    """

    first: int = 0
    last: int = 0

    def __post_init__(self) -> None:
        is_gear = (lambda given: given in (-1, 0, 1), "+1, -1 or 0")
        check(self, {"first": is_gear, "last": is_gear})


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
        steering_levels: Curvatures tried at each pose from full left to full right; odd, at least 5. Resolutions for
            narrow places have their own.
        heuristic_weight: 1 for the best path the resolution allows, more for an earlier one.
        max_words: Reeds-Shepp curves tried from a pose, cheapest first.
        tolerance: A path is good enough if no other can be cheaper by more than this part, as far as the heuristic
            knows.
        extra_expansions: After the first path, look for a better one for so many expansions, or half of
            those the first took if these are more.
        shortcuts: Replace stretches of the path by cheaper Reeds-Shepp curves afterwards.
        max_expansions: Upper limit for every attempt.
        time_limit: For all attempts together, s.
        spacing: Largest distance of the path's poses, m.
        gears: Demanded at the path's ends.
        keep_closed: Also return the poses expanded, to show how far the search came.

    Raises:
        InputError: A number is outside its range; all such are named.
    """

    resolutions: tuple[Resolution, ...] = (COARSE, MEDIUM, NARROW, FINE, NARROWER, NARROWEST, SMALL_TURNS)
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
    tolerance: float = 0.02
    extra_expansions: int = 300
    shortcuts: bool = True
    max_expansions: int = 300_000
    time_limit: float = 10.0
    spacing: float = 0.1
    gears: EndGears = EndGears()
    keep_closed: bool = False

    def __post_init__(self) -> None:
        check(self, _RANGES)


_RANGES: Ranges = {
    "resolutions": (lambda given: len(given) > 0, "at least one Resolution"),
    "margins": (
        lambda given: len(given) > 0 and all(map(at_least(0), given)),
        "distances of 0 m or more",
    ),
    "directions": (lambda given: len(given) > 0, "at least one Direction"),
    "curvature_factor": (lambda given: 0 < given <= 1, "above 0 and at most 1"),
    "gear_change": (at_least(0), "a cost of 0 or more"),
    "reverse": (at_least(1), "a factor of 1 or more"),
    "steering": (at_least(0), "a cost of 0 or more"),
    "steering_change": (at_least(0), "a cost of 0 or more"),
    "steering_levels": (lambda given: given >= 5 and given % 2 == 1, "an odd number, 5 or more"),
    "heuristic_weight": (at_least(1), "1 or more"),
    "max_words": (at_least(1), "1 or more"),
    "tolerance": (at_least(0), "0 or more"),
    "extra_expansions": (at_least(0), "0 or more"),
    "max_expansions": (count_from(1, MOST_EXPANSIONS), f"between 1 and {MOST_EXPANSIONS}"),
    "time_limit": (lambda given: given > 0, "a positive number of seconds"),
    "spacing": (above_0, "a positive distance in m"),
}
