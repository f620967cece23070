"""Ctrl-C that cannot get lost."""

from __future__ import annotations

import signal
import threading
from contextlib import AbstractContextManager
from types import FrameType, TracebackType


class InterruptWatch(AbstractContextManager["InterruptWatch"]):
    """Remembers that Ctrl-C was pressed while the context is open.

    Python raises ``KeyboardInterrupt`` wherever it happens to be, and inside a compiled library's call-back
    that exception can be swallowed. :meth:`check` raises it again, and so does the end of the context.
    """

    def __init__(self) -> None:
        self.seen = False
        self._before: signal._HANDLER = None

    def __enter__(self) -> InterruptWatch:
        if threading.current_thread() is threading.main_thread():  # no other thread may handle signals
            self._before = signal.signal(signal.SIGINT, self._handle)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._before is not None:
            signal.signal(signal.SIGINT, self._before)
        self.check()

    def check(self) -> None:
        """Raise ``KeyboardInterrupt`` if Ctrl-C was pressed."""
        if self.seen:
            raise KeyboardInterrupt

    def _handle(self, number: int, frame: FrameType | None) -> None:
        self.seen = True
        raise KeyboardInterrupt
