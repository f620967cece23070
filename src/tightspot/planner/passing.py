"""How much less would pass: the largest margin and the largest body width, by bisection over plan attempts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from tightspot.guesses import GUESSES
from tightspot.trajectory import Trajectory

Verdict = Literal["passes", "fails", "impossible", "no time"]
"""Of one attempt: a certified plan was found; none was found; none can exist; it was not tried to the end."""

ROUNDING = 1e-6
"""Of lengths in millimetres."""


@dataclass(frozen=True)
class Passing:
    """The largest value with which a certified plan was found, and the smallest with which none was. Lengths in m.

    Attributes:
        quantity: ``margin`` or ``width``.
        now: As demanded: it does not pass.
        passes: ``None`` if none passed.
        fails: The smallest value that was tried in vain and is larger than ``passes``.
        is_proof: Whether no plan can exist with ``fails``, rather than none was found.
        least: The smallest value that was or would have been tried.
        attempts: Number of plans tried.
        in_time: Whether the bisection reached its accuracy before time ran out.
    """

    quantity: Literal["margin", "width"]
    now: float
    passes: float | None
    fails: float
    is_proof: bool
    least: float
    attempts: int
    in_time: bool

    @property
    def accuracy(self) -> float | None:
        """Between the two, m; ``None`` if none passed."""
        return None if self.passes is None else self.fails - self.passes

    def __str__(self) -> str:
        what, now = ("a body {:.3f} m wide", "now") if self.quantity == "width" else ("a margin of {:g} m", "demanded")
        brackets = f"({self.now:.3f} m {now})" if self.quantity == "width" else f"({self.now:g} m {now})"
        if self.passes is not None:
            how = "no plan can exist" if self.is_proof else "no plan was found"
            late = "" if self.in_time else "; time ran out before this was closer"
            than = what.format(self.fails)
            return f"It passes with {what.format(self.passes)} {brackets}; with {than} {how}{late}."
        if not self.in_time:
            return f"Time ran out before anything less than {what.format(self.fails)} was found to pass {brackets}."
        how = "No plan can exist" if self.is_proof else "No plan was found"
        return f"{how} even with {what.format(self.least)} {brackets}."


@dataclass(frozen=True)
class Deeper:
    """What plan attempts found that differ from what was asked for; each that passed is certified by the judge.

    Attributes:
        other_start: Name of a guess, or of another start, from which the scene as it stands was planned, if any.
        changes: What else was changed to find it, in words.
        trajectory: That plan's, certified with the demanded margin, or ``None``.
        cured: For a blocked start or goal: whether a plan exists once it is moved as advised; else ``None``.
        margin: The largest margin that passes; ``None`` if that was not looked for.
        width: The largest width of the body that passes; ``None`` if that was not looked for.
        seconds: Spent.
    """

    other_start: str | None = None
    changes: tuple[str, ...] = ()
    trajectory: Trajectory | None = None
    cured: bool | None = None
    margin: Passing | None = None
    width: Passing | None = None
    seconds: float = 0.0

    @property
    def sentences(self) -> list[str]:
        """One for each finding."""
        found = []
        if self.other_start is not None:
            start = f"from the guess {self.other_start}" if self.other_start in GUESSES else f"from {self.other_start}"
            found.append(f"A certified plan of this very scene was found {', with '.join([start, *self.changes])}.")
        if self.cured is not None:
            found.append(
                "Moved so, a certified plan was found."
                if self.cured
                else "Moved so, no plan was found either: something else is in the way, too."
            )
        return [*found, *(str(passing) for passing in (self.margin, self.width) if passing is not None)]

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "other_start": self.other_start,
            "changes": list(self.changes),
            "cured": self.cured,
            "largest_margin": None if self.margin is None else vars(self.margin) | {"sentence": str(self.margin)},
            "largest_width": None if self.width is None else vars(self.width) | {"sentence": str(self.width)},
            "seconds": self.seconds,
        }


def largest(
    quantity: Literal["margin", "width"],
    now: float,
    least: float,
    accuracy: float,
    attempt: Callable[[float], Verdict],
    impossible: float | None = None,
) -> Passing:
    """Bisection in whole millimetres between ``least`` and ``now``, of which ``now`` is known to fail.

    Args:
        quantity: What is varied.
        now: As demanded, m.
        least: The smallest that is worth trying, m.
        accuracy: At which to stop, m.
        attempt: Tries one value.
        impossible: A smaller value than ``now`` with which no plan can exist, if one is known, m. Just below it is
            tried first, since passages are often as narrow as they look.
    """
    low, high, step = round(1000 * least), 1000 * now, round(1000 * accuracy)
    is_proof = impossible is not None and impossible < now
    if impossible is not None and is_proof:
        high = 1000 * impossible
    passing: int | None = None
    tries = 0
    in_time, beside_bound = True, is_proof
    while in_time and (high > low if passing is None else high - passing > step):
        if passing is not None:
            value = int(passing + high + ROUNDING) // 2
        else:
            value = max(low, int(high + ROUNDING) - step) if beside_bound else low
            beside_bound = False
        verdict = attempt(value / 1000)
        tries += verdict in ("passes", "fails")
        if verdict == "passes":
            passing = value
        elif verdict == "no time":
            in_time = False
        else:
            high, is_proof = value, verdict == "impossible"
    passes = None if passing is None else passing / 1000
    return Passing(quantity, now, passes, high / 1000, is_proof, least, tries, in_time)
