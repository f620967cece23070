"""Run the command line as a user does, and measure its time and memory."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
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


LAUNCHER = """
import json, os, sys, time
started = time.perf_counter()
child = os.posix_spawn(sys.executable, [sys.executable, *sys.argv[2:]], os.environ)
_, status, usage = os.wait4(child, 0)
measured = {"code": os.waitstatus_to_exitcode(status), "memory": usage.ru_maxrss}
with open(sys.argv[1], "w") as file:
    json.dump({**measured, "seconds": time.perf_counter() - started}, file)
"""
"""A process starts with the largest memory of the one that made it, which is therefore a small one."""


def run_tightspot(arguments: Sequence[str]) -> Run:
    """Run ``tightspot ARGUMENTS --json`` in a process of its own."""
    command = ["-m", "tightspot", *arguments, "--json"]
    with tempfile.TemporaryDirectory() as directory:
        told = Path(directory, "measured.json")
        launcher = [sys.executable, "-S", "-c", LAUNCHER, str(told), *command]
        done = subprocess.run(launcher, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=True)
        measured = json.loads(told.read_text())
    unit = 1 if sys.platform == "darwin" else 1024
    answer = json.loads(done.stdout) if done.stdout else None
    return Run(measured["code"], answer, done.stderr, measured["seconds"], measured["memory"] * unit / 1e6)
