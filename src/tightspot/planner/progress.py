"""What the planner tells while it works."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from tightspot.solvers.base import Iteration, IterationCallback

Phase = Literal["guess", "solve", "verify", "refine", "explain"]


@dataclass(frozen=True)
class Progress:
    """One piece of news.

    Attributes:
        phase: What is going on.
        message: One sentence.
        round: Refinement round, from 0.
        iteration: The solver's iteration, in phase ``solve`` only.
    """

    phase: Phase
    message: str
    round: int = 0
    iteration: Iteration | None = None


ProgressCallback = Callable[[Progress], None]


def unheard(news: Progress) -> None:
    """For those who do not want to be told anything."""


def iterations_told(tell: ProgressCallback, number: int) -> IterationCallback | None:
    """Tells of a solver's iterations in a round; ``None`` if nobody listens."""
    if tell is unheard:
        return None

    def watch(iteration: Iteration) -> None:
        tell(Progress("solve", f"iteration {iteration.number}", number, iteration))

    return watch
