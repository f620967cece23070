"""Processes that compute for this one, and that can be stopped whatever they are doing."""

from __future__ import annotations

import atexit
import os
import pickle
import queue
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

ENDED = "ended"
"""The last message of a process: its content says how it ended."""

IDLE = 2
"""How many idle processes of one script are kept."""


class Worker:
    """A Python script in a process of its own, which exchanges pickled ``(word, content)`` messages with this one.

    Raises:
        OSError: The process cannot be started.
    """

    def __init__(self, script: Path) -> None:
        path = os.pathsep.join(entry for entry in sys.path if entry)
        self.process = subprocess.Popen(
            [sys.executable, "-P", str(script)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=os.environ | {"PYTHONPATH": path},
        )
        self._messages: queue.Queue[tuple[str, Any]] = queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()

    def send(self, word: str, content: Any) -> None:
        """A message to the process; lost if the process has ended, which the next answer tells."""
        assert self.process.stdin is not None
        try:
            pickle.dump((word, content), self.process.stdin)
            self.process.stdin.flush()
        except OSError:
            return

    def receive(self, seconds: float) -> tuple[str, Any] | None:
        """The next message; ``None`` if there is none within ``seconds``."""
        try:
            return self._messages.get(timeout=seconds)
        except queue.Empty:
            return None

    @property
    def alive(self) -> bool:
        """Whether the process runs."""
        return self.process.poll() is None

    def kill(self) -> None:
        """End the process now, and wait for it."""
        self.process.kill()
        self._close()

    def dismiss(self) -> None:
        """Let the process end by itself: its questions are over."""
        self._close(patience=2.0)

    def _close(self, patience: float = 10.0) -> None:
        assert self.process.stdin is not None
        with suppress(OSError):
            self.process.stdin.close()
        try:
            self.process.wait(patience)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()

    def _read(self) -> None:
        assert self.process.stdout is not None
        with self.process.stdout as answers:
            while True:
                try:
                    self._messages.put(pickle.load(answers))
                except (EOFError, OSError, pickle.UnpicklingError):
                    break
        self._messages.put((ENDED, _how(self.process.wait())))


_idle: dict[tuple[int, Path], list[Worker]] = {}
_lock = threading.Lock()


@contextmanager
def worker(script: Path) -> Iterator[Worker]:
    """An idle process of the script, or a new one; kept afterwards unless something was raised or it has ended."""
    key = os.getpid(), script
    with _lock:
        waiting = _idle.setdefault(key, [])
        found = waiting.pop() if waiting else None
    if found is not None and not found.alive:
        found.kill()
        found = None
    chosen = Worker(script) if found is None else found
    try:
        yield chosen
    except BaseException:
        chosen.kill()
        raise
    with _lock:
        kept = chosen.alive and len(waiting) < IDLE
        if kept:
            waiting.append(chosen)
    if not kept:
        chosen.kill()


@atexit.register
def dismiss_all() -> None:
    """End all idle processes of this one."""
    with _lock:
        waiting = [found for key, some in _idle.items() if key[0] == os.getpid() for found in some]
        _idle.clear()
    for found in waiting:
        found.dismiss()


def _how(code: int) -> str:
    return f"killed by signal {-code}" if code < 0 else f"ended with exit code {code}"
