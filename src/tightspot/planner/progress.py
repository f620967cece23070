"""What the planner tells while it works."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from tightspot.solvers.base import Iteration

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
