"""Other prices, other courses: options of hybrid A* drawn at random."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from tightspot.errors import InputError, Problem
from tightspot.search import Direction, EndGears, HybridAStarOptions


def generator(seed: int, field: str = "guess.seed") -> np.random.Generator:
    """Random numbers, the same for the same seed; ``field`` is its name in messages.

    Raises:
        InputError: If the seed is not a whole number, 0 or more.
    """
    try:
        return np.random.default_rng(int(seed) if seed == int(seed) and not isinstance(seed, bool | np.bool_) else -1)
    except (TypeError, ValueError, OverflowError):
        raise InputError(Problem(field, f"{seed!r} must be a whole number, 0 or more")) from None


def perturbed(options: HybridAStarOptions, seed: int) -> HybridAStarOptions:
    """The options with what a path costs, how sharply it may turn and where the search begins drawn at random."""
    return replace(options, **drawn(generator(seed)))


def drawn(rng: np.random.Generator) -> dict[str, Any]:
    """Random values of the options that decide on a path's course."""
    ends = (Direction.TIGHT_END, Direction.WIDE_END)
    return {
        "directions": ends if rng.random() < 0.7 else ends[::-1],
        "curvature_factor": float(rng.uniform(0.7, 1.0)),
        "gear_change": _log_uniform(rng, 0.3, 10.0),
        "reverse": float(rng.choice((1.0, 1.0, 1.5, 3.0))),
        "steering": float(rng.uniform(0.0, 0.5)),
        "steering_change": _log_uniform(rng, 0.1, 2.0),
        "gears": EndGears(int(rng.choice((0, 0, 1, -1))), int(rng.choice((0, 0, 1, -1)))),
    }


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))
