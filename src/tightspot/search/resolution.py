"""How finely a search tells poses apart."""

from __future__ import annotations

from dataclasses import dataclass

from tightspot.search.ranges import MOST_EXPANSIONS, Ranges, above_0, check, count_from


@dataclass(frozen=True)
class Resolution:
    """How finely poses are told apart. Lengths are parts of the body's narrowest extent (a car's width).

    Attributes:
        name: For people.
        cell: Side of a position cell.
        heading_bins: Heading cells of a full turn.
        step: Length of an arc (twice that in the open).
        max_expansions: An attempt at this resolution gives up after this many.
        halvings: How often an arc that is blocked is tried again at half its length: in tight places, short moves
            are what remains.
        patience: Without a path after this many expansions the search becomes greedier: the estimate of the cost left
            counts half as much again, and again after twice and four times as many.
        steering_halvings: If not 0: the curvatures tried are none and the largest, halved up to so many times, to both
            sides, instead of evenly spaced ones. Beside a kerb only small steering angles are free.

    Raises:
        InputError: A number is outside its range; all such are named.
    """

    name: str
    cell: float
    heading_bins: int
    step: float
    max_expansions: int
    halvings: int = 3
    patience: int = 2000
    steering_halvings: int = 0

    def __post_init__(self) -> None:
        check(self, _RANGES)


MOST_HEADING_BINS = 8192
_RANGES: Ranges = {
    "cell": (above_0, "a positive part of the body's width"),
    "heading_bins": (count_from(8, MOST_HEADING_BINS), f"between 8 and {MOST_HEADING_BINS}"),
    "step": (above_0, "a positive part of the body's width"),
    "max_expansions": (count_from(1, MOST_EXPANSIONS), f"between 1 and {MOST_EXPANSIONS}"),
    "halvings": (count_from(0, 10), "between 0 and 10"),
    "steering_halvings": (count_from(0, 10), "between 0 and 10"),
    "patience": (count_from(1, MOST_EXPANSIONS), f"between 1 and {MOST_EXPANSIONS}"),
}

COARSE = Resolution("coarse", 0.2, 72, 0.3, max_expansions=30_000, halvings=0, patience=500)
MEDIUM = Resolution("medium", 0.1, 108, 0.18, max_expansions=100_000)
FINE = Resolution("fine", 0.05, 180, 0.1, max_expansions=100_000)
FINEST = Resolution("finest", 0.025, 360, 0.05, max_expansions=200_000)

# Between walls: small turns count, and a move goes as far as it can.
NARROW = Resolution("narrow", 0.1, 360, 0.3, max_expansions=60_000, halvings=4, steering_halvings=3)
NARROWER = Resolution("narrower", 0.05, 720, 0.3, max_expansions=100_000, halvings=4, steering_halvings=3)
NARROWEST = Resolution("narrowest", 0.05, 720, 0.2, max_expansions=100_000, halvings=4, steering_halvings=3)
SMALL_TURNS = Resolution("small turns", 0.05, 1440, 0.3, max_expansions=100_000, halvings=5, steering_halvings=3)
