"""A stagewise solve begun anew: other ways to start, each with a soft phase, and where it fails if none leads anywhere.

A way (see :mod:`tightspot.solvers.rough_starts`) gives a drive without obstacles. The whole problem is solved from
there; if that comes to nothing, the problem with soft obstacles, which nearly always has a solution: it is the
restoration phase of this method, and the whole problem is solved once more from its solution. A soft solution that
still penetrates is a local minimum of penetration: after :data:`ENOUGH` of them, no further way is tried.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from tightspot.solvers.base import SolveStatus
from tightspot.solvers.rough_starts import Way, can_start_again, effort, ways
from tightspot.solvers.stage_lines import with_states
from tightspot.solvers.stage_problem import StageProblem
from tightspot.solvers.stage_report import Attempt, StageReport

MOST_ITERATIONS = 150
"""Of each solve from another start than the given one."""
ENOUGH = 2
PENETRATES = 1e-3
"""A soft solution's largest penetration above which it counts as one, m."""
HOPELESS = 0.1
"""A soft solution's largest penetration above which nothing is tried from there, m."""
PENALTY = 3.0
"""What a metre of penetration on one interval costs, times the largest possible objective at the start's final time."""

Once = Callable[[StageProblem, StageProblem | None, int, float], StageReport]
"""One solve of a problem, reported in the order of another one, within iterations and seconds."""


def from_other_starts(
    problem: StageProblem, failed: StageReport, once: Once, max_iterations: int, time_limit: float
) -> StageReport:
    """The first success from the ways to begin, or the failed report, with what was tried."""
    tries = _Tries(problem, once, max_iterations, time_limit, failed)
    for way in ways(problem) if can_start_again(problem) else ():
        found = tries.by(way)
        if found is None:
            break
        if found.status is SolveStatus.STOPPED:
            return tries.told(failed, status=SolveStatus.STOPPED)
        if found.status.success:
            return tries.told(found, note=f"Not solved from the given start, but from another one: {tries.last}.")
        if tries.penetrating >= ENOUGH:
            return tries.told(failed, status=SolveStatus.INFEASIBLE, note=tries.least_words)
    return tries.told(failed, note=tries.least_words)


@dataclass
class _Tries:
    problem: StageProblem
    once: Once
    max_iterations: int
    time_limit: float
    failed: StageReport
    attempts: list[Attempt] = field(default_factory=list)
    least: StageReport | None = None
    penetrating: int = 0

    def __post_init__(self) -> None:
        self.began = time.perf_counter()
        self.iterations = self.failed.iterations

    @property
    def last(self) -> str:
        return self.attempts[-1].start

    def by(self, way: Way) -> StageReport | None:
        """The outcome of one way; ``None`` when the limits are reached."""
        begun = self.iterations
        drive = self._solve(way.problem)
        if drive is None or not drive.status.success:
            return self._noted(way.name, drive, begun)
        found = self._noted(way.name, self._from(drive), begun)
        if found is None or found.status.success or found.status is SolveStatus.STOPPED or self.problem.soft.any():
            return found
        begun = self.iterations
        soft = self._solve(_softened(self._with_states(drive)))
        if soft is not None and soft.status.success:
            self._keep(soft)
        if soft is not None and soft.status is not SolveStatus.STOPPED and not _is_hopeless(soft):
            soft = self._from(soft)
        elif soft is not None and soft.status.success:
            soft = replace(soft, status=SolveStatus.INFEASIBLE)
        return self._noted(f"{way.name}, soft obstacles", soft, begun)

    def _solve(self, start: StageProblem, original: StageProblem | None = None) -> StageReport | None:
        left = self.max_iterations - self.iterations
        seconds = self.time_limit - self.failed.timings["solve"] - (time.perf_counter() - self.began)
        if left <= 0 or seconds <= 0:
            return None
        report = self.once(start, original, min(left, MOST_ITERATIONS), seconds)
        self.iterations += report.iterations
        return report

    def _with_states(self, report: StageReport) -> StageProblem:
        assert report.states is not None
        assert report.inputs is not None
        return with_states(self.problem, report.states, report.inputs, report.final_time)

    def _from(self, report: StageReport) -> StageReport | None:
        return self._solve(self._with_states(report), self.problem)

    def _noted(self, name: str, report: StageReport | None, begun: int) -> StageReport | None:
        if report is not None:
            self.attempts.append(Attempt(name, report.status, self.iterations - begun))
        return report

    def _keep(self, soft: StageReport) -> None:
        depth = _deepest(soft)
        self.penetrating += depth > PENETRATES
        if self.least is None or depth < _deepest(self.least):
            self.least = soft

    @property
    def least_words(self) -> str:
        """Where the soft solution that penetrates least does so; empty without one that does."""
        least = self.least
        if least is None or least.penetrations is None or not _deepest(least) > PENETRATES:
            return ""
        interval, part, obstacle = self.problem.pairs[int(least.penetrations.argmax())]
        where = f"of part {part} against obstacle part {obstacle} at knot {interval + 1}"
        return f"Locally infeasible: the shallowest way found still lacks {_deepest(least):.3g} m of clearance {where}."

    def told(self, report: StageReport, **changes: object) -> StageReport:
        timings = {"build": self.failed.timings["build"], "solve": self.failed.timings["solve"]}
        timings["solve"] += time.perf_counter() - self.began
        attempts = (*self.failed.attempts, *self.attempts)
        told = replace(report, iterations=self.iterations, attempts=attempts, timings=timings, **changes)  # type: ignore[arg-type]
        return told if told.status.success else replace(told, least=self.least)


def _is_hopeless(soft: StageReport) -> bool:
    """A soft solve that did not converge may have come far enough all the same."""
    return not np.isfinite(soft.objective) or (soft.status.success and _deepest(soft) > HOPELESS)


def _deepest(report: StageReport) -> float:
    assert report.penetrations is not None
    return float(report.penetrations.max(initial=0.0))


def _softened(problem: StageProblem) -> StageProblem:
    """Every pair may penetrate, at a price beyond what any objective could gain by it."""
    duration = problem.final_time if problem.time_scaled else 1.0
    price = PENALTY * (problem.time_weight * problem.final_time + duration * effort(problem))
    penalties = np.tile([max(price, 1e-3), 0.0], (len(problem.pairs), 1))
    soft = problem.softened(penalties)
    return with_states(soft, problem.states, problem.inputs, problem.final_time)
