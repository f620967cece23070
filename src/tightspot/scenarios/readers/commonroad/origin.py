"""From which CommonRoad file a scene comes: what a solution of it must name."""

from __future__ import annotations

import re
from dataclasses import dataclass

TIME_STEP = 0.1
"""Of the files that we write, s, if nobody says otherwise."""
PROBLEM = 2
"""Id of the planning problem in the files that we write."""

_SENTENCE = re.compile(
    r"CommonRoad (?P<benchmark>\S{1,200}), planning problem (?P<problem>\d+), time step (?P<dt>\S+) s"
)
_BENCHMARK = re.compile(r"(C-)?[A-Z]{3}_[a-zA-Z0-9]+-[1-9][0-9]*(_[1-9][0-9]*(_[STPI](-[1-9][0-9]*)+)?)?")


@dataclass(frozen=True)
class Origin:
    """A planning problem of a scenario.

    Attributes:
        benchmark: The scenario's benchmark id, for example ``DEU_Flensburg-1_1_T-1``.
        problem: The planning problem's id.
        dt: The scenario's time step, s.
    """

    benchmark: str
    problem: int = PROBLEM
    dt: float = TIME_STEP

    def __str__(self) -> str:
        """The sentence in a scene's ``source``; :meth:`of` reads it."""
        return f"CommonRoad {self.benchmark}, planning problem {self.problem}, time step {self.dt!r} s"

    @classmethod
    def of(cls, source: str, name: str) -> Origin:
        """Where a scene of that ``source`` comes from; if from elsewhere, what a file made of it is called."""
        found = _SENTENCE.fullmatch(source)
        try:
            dt = float(found["dt"]) if found else 0.0
        except ValueError:
            dt = 0.0
        return cls(found["benchmark"], int(found["problem"]), dt) if found and dt > 0 else cls(benchmark_id(name))


def benchmark_id(name: str) -> str:
    """The name as CommonRoad's benchmark ids are written: ``my garage`` becomes ``ZAM_MyGarage-1_1``.

    ZAM is CommonRoad's country of scenarios that are nowhere.
    """
    if _BENCHMARK.fullmatch(name):
        return name
    words = re.findall(r"[a-zA-Z0-9]+", name)
    return f"ZAM_{''.join(word[0].upper() + word[1:] for word in words)[:100] or 'Scene'}-1_1"
