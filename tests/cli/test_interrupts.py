"""Ctrl-C at any moment: one line, exit code 130, no file."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time

import pytest

from tightspot.cli.interrupts import InterruptWatch


def press_ctrl_c():
    os.kill(os.getpid(), signal.SIGINT)


def swallow_an_interrupt(watch: InterruptWatch) -> None:
    """As a compiled library does in a call-back."""
    with watch:
        with contextlib.suppress(KeyboardInterrupt):
            press_ctrl_c()
        assert watch.seen
        with pytest.raises(KeyboardInterrupt):
            watch.check()


def test_an_interrupt_that_was_swallowed_is_raised_again():
    with pytest.raises(KeyboardInterrupt):
        swallow_an_interrupt(InterruptWatch())
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_without_an_interrupt_nothing_happens():
    with InterruptWatch() as watch:
        watch.check()
    assert not watch.seen


@pytest.mark.parametrize("phase", ["guess", "solve", "verify"])
def test_ctrl_c_leaves_nothing(phase, tmp_path):
    command = [sys.executable, "-m", "tightspot", "plan", "vertical", "-o", str(tmp_path / "a" / "out")]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path)
    assert process.stderr is not None
    told = []
    for line in process.stderr:
        told.append(line)
        if f"] {phase}: " in line:
            time.sleep(0.02)
            process.send_signal(signal.SIGINT)
            break
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130, (told, err)
    assert out == ""
    assert err.splitlines()[-1] == "interrupted: nothing was written"
    assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []
