"""Ctrl-C during a search."""

from __future__ import annotations

import signal
import subprocess
import sys
import time

LONG_SEARCH = """
from tightspot.geometry import ConvexPolygon
from tightspot.search import FINEST, HybridAStarOptions, search
from tightspot.vehicles import vehicle

hall = ConvexPolygon.rectangle(-50, 50, -50, 50)
walls = [ConvexPolygon.rectangle(8, 9, -50, -1), ConvexPolygon.rectangle(8, 9, 1, 50)]
options = HybridAStarOptions(resolutions=(FINEST,), margins=(0.0,), time_limit=60.0)
print("searching", flush=True)
search(hall, walls, vehicle("paper"), (0, 0, 0), (20, 0, 0), options)
print("came to an end", flush=True)
"""


def test_ctrl_c_ends_a_search_at_once():
    with subprocess.Popen(
        [sys.executable, "-c", LONG_SEARCH], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "searching\n"
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        sent = time.monotonic()
        out, err = process.communicate(timeout=30)
    assert time.monotonic() - sent < 2.0
    assert "KeyboardInterrupt" in err
    assert "came to an end" not in out
    assert process.returncode != 0
