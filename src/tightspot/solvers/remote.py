"""Solvers of CasADi's that may hang or crash, each solve in a process that can be stopped whatever it is doing."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from tightspot.solvers.base import Iteration, IterationCallback, SolveStatus, asks_to_stop
from tightspot.solvers.interrupts import Interrupts
from tightspot.solvers.processes import ENDED, Worker, worker

SCRIPT = Path(__file__).with_name("nlpsol_worker.py")
POLL_SECONDS = 0.05


class Outcome(NamedTuple):
    """How a solve ended: a status, or an answer that is still to be looked at.

    Attributes:
        status: ``None`` if there is an answer.
        answer: Of :mod:`tightspot.solvers.nlpsol_worker`: vectors, iterations, the solver's words.
        word: What the solver said, or what became of its process.
        iterations: How many were told.
        build: Seconds until the solver was ready.
        solve: Seconds of the solve.
        refusal: What the solver complained of when it was made or called; "" if it did not.
    """

    status: SolveStatus | None
    answer: dict[str, Any] | None = None
    word: str = ""
    iterations: int = 0
    build: float = 0.0
    solve: float = 0.0
    refusal: str = ""

    @property
    def functions(self) -> float:
        """Seconds spent in the program's functions."""
        return float(self.answer["functions"]) if self.answer else 0.0


def solve_elsewhere(
    task: Mapping[str, Any],
    text: str,
    library: str | None,
    callback: IterationCallback | None,
    *,
    deadline: float = float("inf"),
    seconds: float = float("inf"),
) -> Outcome:
    """Put the task to a process and listen until it is done, late, broken or stopped.

    Args:
        task: ``plugin``, ``key`` (equal for equal programs and options), ``options`` and ``arguments`` of
            ``casadi.nlpsol``.
        text: The program, serialised.
        library: The program, compiled; ``None``: there is the text only.
        callback: Called with each iteration; returns ``False`` to stop.
        deadline: By ``time.perf_counter()``; the process is stopped then.
        seconds: It is also stopped so long after the solver is ready.

    Raises:
        KeyboardInterrupt: If the user interrupts.
    """
    interrupts = Interrupts()
    try:
        with interrupts, worker(SCRIPT) as process:
            process.send("solve", task)
            program = {"text": text, "library": library}
            outcome = _listen(process, program, callback, interrupts, deadline, seconds)
    except OSError as error:
        return Outcome(SolveStatus.FAILED, word=f"its process cannot be started ({error.strerror or error})")
    interrupts.deliver()
    return outcome


def _listen(
    process: Worker,
    program: Mapping[str, Any],
    callback: IterationCallback | None,
    interrupts: Interrupts,
    deadline: float,
    seconds: float,
) -> Outcome:
    """What comes of the task; the process is killed unless it has answered."""
    started = time.perf_counter()
    build, iterations = None, 0

    def ended(
        status: SolveStatus | None, word: str, answer: dict[str, Any] | None = None, *, refusal: str = ""
    ) -> Outcome:
        if answer is None and not refusal:
            process.kill()
        passed = time.perf_counter() - started
        solve = answer["seconds"] if answer else passed - (build or passed)
        return Outcome(status, answer, word, iterations, max(0.0, passed - solve), solve, refusal)

    while True:
        message = process.receive(POLL_SECONDS)
        if interrupts.pending:
            return ended(SolveStatus.STOPPED, "interrupted")
        word: str
        content: Any
        word, content = message or ("", None)
        if word == "program?":
            process.send("program", program)
        elif word == "built":
            build = time.perf_counter() - started
            deadline = min(deadline, started + build + seconds)
        elif word == "iteration":
            iterations = content[0]
            if callback is not None and asks_to_stop(callback(Iteration(*content))):
                return ended(SolveStatus.STOPPED, "stopped by the callback")
        elif word == "done":
            return ended(None, content["word"], content)
        elif word in ("refused", "broken"):
            status = SolveStatus.FAILED if word == "refused" else SolveStatus.NUMERICAL
            return ended(status, content, refusal=content)
        elif word == ENDED:
            return ended(SolveStatus.NUMERICAL, f"its process was {content}")
        if time.perf_counter() > deadline:
            return ended(SolveStatus.TIME_LIMIT, "its process was stopped when the time was up")
