"""Checks of numbers that a user may set: all that are wrong at once, each with what it must be."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from tightspot.errors import InputError, Problem

Ranges = Mapping[str, tuple[Callable[[Any], bool], str]]
"""Whether a field's value is right, and what it must be, for people."""

MOST_EXPANSIONS = 10_000_000
"""About 5 GB."""


def check(given: Any, ranges: Ranges) -> None:
    """Raises :class:`InputError` naming every field of ``given`` that is out of its range."""
    problems = [
        Problem(field, f"{getattr(given, field)} must be {meaning}")
        for field, (is_right, meaning) in ranges.items()
        if not is_right(getattr(given, field))
    ]
    if problems:
        raise InputError(problems)


def at_least(low: float) -> Callable[[Any], bool]:
    """A finite number, ``low`` or more."""
    return lambda value: bool(np.isfinite(value) and value >= low)


def above_0(value: Any) -> bool:
    """A finite, positive number."""
    return bool(np.isfinite(value) and value > 0)


def count_from(low: int, high: int) -> Callable[[Any], bool]:
    """A whole number between the two."""
    return lambda value: low <= value <= high and value == int(value)
