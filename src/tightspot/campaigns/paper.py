"""The campaign that solves the paper's Table II again."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path
from typing import Any

from tightspot.campaigns.claims import Claim, claims
from tightspot.campaigns.methods import METHODS
from tightspot.campaigns.rows import Row, RowFile
from tightspot.campaigns.settings import GUESS_NAMES, SCENES, PaperSettings, paper_settings
from tightspot.campaigns.solve import Bench, Case
from tightspot.campaigns.starts import METHOD, random_start
from tightspot.errors import InputError, Problem

ROWS, TABLE, REPORT = "rows.jsonl", "rows.csv", "report.md"
START_BASES = ("hybrid-astar", "simplified")


@dataclass(frozen=True)
class News:
    """Progress: before a case and after it.

    Attributes:
        done: Cases with a row.
        total: Cases of the campaign.
        seconds_left: Estimate from the cases solved in this run; ``None`` before the first.
        case: The case that begins.
        row: Its row, when it is done.
    """

    done: int
    total: int
    seconds_left: float | None
    case: Case
    row: Row | None = None


@dataclass(frozen=True)
class Plan:
    """What a campaign solves.

    Attributes:
        settings: ``recovered`` or ``printed``.
        scenes: Of the paper's three.
        methods: Keys of :data:`tightspot.campaigns.methods.METHODS`.
        guesses: Of the paper's three.
        runs: Solves of each solved program.
        time_limit: For one solve, s.
        starts: Random starts a scene, beside the guesses.

    Raises:
        InputError: A name is not known, or a number makes no sense.
    """

    settings: str = "recovered"
    scenes: Sequence[str] = SCENES
    methods: Sequence[str] = tuple(METHODS)
    guesses: Sequence[str] = GUESS_NAMES
    runs: int = 5
    time_limit: float = 60.0
    starts: int = 0

    def __post_init__(self) -> None:
        problems = []
        for name, known in (("scenes", SCENES), ("methods", tuple(METHODS)), ("guesses", GUESS_NAMES)):
            unknown = [value for value in getattr(self, name) if value not in known]
            problems += [Problem(name, f"{value!r} is not known; choose from {', '.join(known)}") for value in unknown]
        for name, least in (("runs", 1), ("starts", 0), ("time_limit", 0.1)):
            if not getattr(self, name) >= least:
                problems.append(Problem(name, f"{getattr(self, name)} is too small; give at least {least}"))
        if problems:
            raise InputError(problems)

    def cases(self) -> list[Case]:
        """The table's cases, then the random starts."""
        table = [Case(*names) for names in product(self.scenes, self.methods, self.guesses)]
        random = [Case(scene, METHOD, f"start {number}") for number in range(self.starts) for scene in self.scenes]
        return table + random

    def fixed(self) -> dict[str, Any]:
        """What must not change when a campaign is resumed."""
        meant = paper_settings(self.settings)
        values = {"vehicle": meant.vehicle, "objective": str(meant.objective), "guess_weights": meant.guess_weights}
        return {"settings": self.settings, "runs": self.runs, "time_limit": self.time_limit, **values}


@dataclass(frozen=True)
class Outcome:
    """A finished campaign.

    Attributes:
        plan: What was to be solved.
        settings: With which settings.
        rows: One a case, in the plan's order.
        seconds: Of this run.
    """

    plan: Plan
    settings: PaperSettings
    rows: list[Row]
    seconds: float
    claims: list[Claim] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "claims", claims(self.rows))


def run(plan: Plan, directory: Path, *, progress: Callable[[News], None] | None = None) -> Outcome:
    """Solve what has no row in the directory yet.

    Every row is on the disk before the next case begins, so that a run that was interrupted goes on where it was.

    Args:
        plan: What to solve.
        directory: Created if need be; holds ``rows.jsonl`` and ``rows.csv``.
        progress: Called before and after every case.

    Raises:
        InputError: The directory holds rows made with other settings.
        KeyboardInterrupt: If the user interrupts; finished rows are kept.
    """
    started = time.perf_counter()
    directory.mkdir(parents=True, exist_ok=True)
    settings = paper_settings(plan.settings)
    store = RowFile(directory / ROWS, plan.fixed())
    bench = Bench(settings, runs=plan.runs, time_limit=plan.time_limit)
    cases = plan.cases()
    todo = [case for case in cases if case.key not in store.rows]
    tell = progress or (lambda news: None)
    for index, case in enumerate(todo):
        done = len(cases) - len(todo) + index
        tell(News(done, len(cases), _seconds_left(started, index, len(todo)), case))
        row = solve_case(bench, case)
        store.append(row)
        store.write_csv(directory / TABLE)
        tell(News(done + 1, len(cases), _seconds_left(started, index + 1, len(todo)), case, row))
    store.write_csv(directory / TABLE)
    rows = [store.rows[case.key] for case in cases]
    return Outcome(plan, settings, rows, time.perf_counter() - started)


def _seconds_left(started: float, done: int, total: int) -> float | None:
    return (time.perf_counter() - started) / done * (total - done) if done else None


def solve_case(bench: Bench, case: Case) -> Row:
    """A case from one of the paper's guesses, or from the random start of that number, which is solved once."""
    if not case.guess.startswith("start "):
        return bench.row(case)
    number = int(case.guess.removeprefix("start "))
    base = bench.guess(case.scene, START_BASES[number % len(START_BASES)])
    if base.trajectory is None:
        return Row(case.key, case.scene, case.method, case.guess, "NO_GUESS", verdict=base.reason)
    once = Bench(bench.settings, runs=1, time_limit=bench.time_limit)
    return once.solve(case, random_start(base.trajectory, bench.settings.steps, number))
