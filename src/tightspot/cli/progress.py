"""Telling what goes on: one live line on a terminal, one plain line a phase elsewhere."""

from __future__ import annotations

import time
from contextlib import AbstractContextManager
from types import TracebackType
from typing import TYPE_CHECKING

from rich.console import Console
from rich.markup import escape
from rich.status import Status

from tightspot.cli.console import print_line

if TYPE_CHECKING:
    from tightspot.planner import Progress


class ProgressView(AbstractContextManager["ProgressView"]):
    """A progress callback of :func:`tightspot.plan` that writes on a console while the context is open.

    On a terminal the running phase is a live line with the solver's iteration and becomes a plain line with
    its time when it ends; elsewhere each phase is one line when it begins.
    """

    def __init__(self, console: Console, *, quiet: bool = False) -> None:
        self._console = console
        self._quiet = quiet
        self._status = Status("", console=console) if console.is_terminal and not quiet else None
        self._started = self._phase_started = time.perf_counter()
        self._phase = ""
        self._news = ""

    def __enter__(self) -> ProgressView:
        if self._status:
            self._status.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._status:
            self._finish_phase()
            self._status.stop()

    def __call__(self, progress: Progress) -> None:
        """The callback."""
        if self._quiet:
            return
        if progress.iteration is None:
            self._begin_phase(f"{progress.phase}: {progress.message}")
        elif self._status:
            iteration = progress.iteration
            self._news = f"iteration {iteration.number}"
            values = f"J = {iteration.objective:.4g}, violation {iteration.violation:.1e}"
            self._status.update(f"{escape(self._phase)}: {self._news}, {values}")

    def _begin_phase(self, phase: str) -> None:
        if phase == self._phase and not self._news:
            return
        if self._status:
            self._finish_phase()
            self._status.update(escape(phase))
        else:
            print_line(self._console, f"[{time.perf_counter() - self._started:.1f} s] {phase}")
        self._phase, self._news, self._phase_started = phase, "", time.perf_counter()

    def _finish_phase(self) -> None:
        if self._phase:
            seconds = time.perf_counter() - self._phase_started
            news = f", {self._news}" if self._news else ""
            print_line(self._console, f"{self._phase}{news} ({seconds:.1f} s)", "dim")
        self._phase = ""
