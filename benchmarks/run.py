"""Run the command line as a user does, and measure its time and memory."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Run:
    """A finished run of ``tightspot``.

    Attributes:
        code: Exit code.
        answer: The JSON object on standard output, ``None`` if there is none.
        errors: Standard error.
        seconds: From start to end of the process.
        megabytes: Largest resident memory of the process, 10^6 bytes.
    """

    code: int
    answer: Any
    errors: str
    seconds: float
    megabytes: float


def run_tightspot(arguments: Sequence[str]) -> Run:
    """Run ``tightspot ARGUMENTS --json`` in a process of its own."""
    command = [sys.executable, "-m", "tightspot", *arguments, "--json"]
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        started = time.perf_counter()
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=err)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - started
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        err.seek(0)
        text, errors = out.read().decode(), err.read().decode()
    unit = 1 if sys.platform == "darwin" else 1024
    answer = json.loads(text) if text else None
    return Run(process.returncode, answer, errors, seconds, usage.ru_maxrss * unit / 1e6)
