"""One cell of the table: a program built, solved several times and judged."""

from __future__ import annotations

import statistics
from dataclasses import dataclass
from functools import cache

from tightspot.campaigns.methods import METHODS
from tightspot.campaigns.rows import Row
from tightspot.campaigns.settings import PaperSettings
from tightspot.campaigns.table import TABLE_II
from tightspot.guesses import GuessResult
from tightspot.scenarios import Scenario
from tightspot.trajectory import Trajectory
from tightspot.transcription import TimeGrid, counts, transcribe
from tightspot.verification import verify
from tightspot.verification.certificate import WORKSPACE


@dataclass(frozen=True)
class Case:
    """What is solved: a scene, a method and a guess by name."""

    scene: str
    method: str
    guess: str

    @property
    def key(self) -> str:
        """Unique name."""
        return f"{self.scene} / {self.method} / {self.guess}"


class Bench:
    """Solves cases with the paper's settings; guesses are made once.

    Args:
        settings: The paper's.
        runs: How often a solved program is solved again for the median of its times.
        time_limit: For one solve, s.
    """

    def __init__(self, settings: PaperSettings, *, runs: int, time_limit: float) -> None:
        self.settings, self.runs, self.time_limit = settings, runs, time_limit
        self.car = settings.car()
        self.scenario = cache(settings.scenario)
        self.guess = cache(self._guess)

    def _guess(self, scene: str, name: str) -> GuessResult:
        return self.settings.guess(name).make(self.scenario(scene), self.car, margin=self.settings.gap)

    def row(self, case: Case) -> Row:
        """Guess, solve and judge."""
        guess = self.guess(case.scene, case.guess)
        if guess.trajectory is None:
            return Row(case.key, case.scene, case.method, case.guess, "NO_GUESS", verdict=guess.reason)
        return self.solve(case, guess.trajectory)

    def solve(self, case: Case, guess: Trajectory) -> Row:
        """Solve from a guess, again for the median, and judge."""
        method, scenario, settings = METHODS[case.method], self.scenario(case.scene), self.settings
        wanted = settings.transcription(method.formulation)
        problem = transcribe(scenario, self.car, guess, wanted, grid=TimeGrid.uniform(settings.steps))
        solver = settings.solver(self.time_limit)
        reports = [solver.solve(problem.nlp)]
        if reports[0].status.success:
            reports += [solver.solve(problem.nlp) for _ in range(self.runs - 1)]
        report, size = reports[0], counts(problem.nlp)
        seconds = statistics.median(report.timings["solve"] for report in reports)
        paper = TABLE_II.get((case.scene, method.equation, case.guess))
        row = Row(
            case.key, case.scene, case.method, case.guess, report.status.name, size.VN, size.CN,
            iterations=report.iterations, seconds=seconds, runs=len(reports), verdict=report.status.sentence,
        )  # fmt: skip
        known = paper._asdict() if paper else {}
        fields = row.__dict__ | {f"paper_{name}": value for name, value in known.items()}
        if report.status.success:
            motion = problem.trajectory(report.x)
            fields |= {
                "objective": report.objective,
                "final_time": motion.duration,
                "effort": float((motion.inputs**2).sum()),
                "trajectory": motion.to_dict(),
                **judged(scenario, self, motion),
            }
        return Row(**fields)


def judged(scenario: Scenario, bench: Bench, motion: Trajectory) -> dict[str, object]:
    """The judge's word at margin 0: how deep the body overlaps an obstacle at any time, and the sentence."""
    certificate = verify(scenario, bench.car, motion, margin=0.0)
    overlaps = [witness for witness in certificate.witnesses if witness.obstacle != WORKSPACE]
    deepest = max(overlaps, key=lambda witness: witness.penetration, default=None)
    if certificate.certified:
        verdict = f"certified for all times, clearance {certificate.clearance:.4f} m"
    elif deepest is not None and deepest.penetration > 0:
        verdict = str(deepest)
    else:
        verdict = " ".join(check.sentence for check in certificate.failed)
    penetration = deepest.penetration if deepest is not None else 0.0
    return {"certified": certificate.certified, "penetration": penetration, "verdict": verdict}
