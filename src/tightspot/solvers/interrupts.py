"""Ctrl-C while compiled code runs."""

from __future__ import annotations

import signal
import threading
from types import FrameType, TracebackType


class Interrupts:
    """Context in which SIGINT is noted, for compiled code that would swallow the exception it becomes.

    Whoever drives the compiled code asks ``pending`` and stops early; then :meth:`deliver`, after the
    context, hands the signal to the handler that was there before, which raises :class:`KeyboardInterrupt`
    unless someone changed it. Outside the main thread, where Python delivers no signals, it does nothing.

    Attributes:
        pending: True once SIGINT has come.
    """

    def __init__(self) -> None:
        self.pending = False
        self._frame: FrameType | None = None
        self._previous = signal.getsignal(signal.SIGINT)
        main = threading.current_thread() is threading.main_thread()
        self._active = main and callable(self._previous)

    def __enter__(self) -> Interrupts:
        if self._active:
            signal.signal(signal.SIGINT, self._note)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._active:
            signal.signal(signal.SIGINT, self._previous)

    def _note(self, number: int, frame: FrameType | None) -> None:
        self.pending, self._frame = True, frame

    def deliver(self) -> None:
        """Call the previous handler if SIGINT has come."""
        if self.pending and callable(self._previous):
            self._previous(signal.SIGINT, self._frame)
