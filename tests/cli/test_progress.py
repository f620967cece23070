"""Progress: plain lines in a pipe, a live line on a terminal, nothing if quiet."""

from __future__ import annotations

import io

from rich.console import Console

from tightspot.cli.progress import ProgressView
from tightspot.planner import Progress
from tightspot.solvers import Iteration

NEWS = [
    Progress("guess", "initial guess by hybrid-astar"),
    Progress("guess", "initial guess by hybrid-astar"),
    Progress("solve", "30 intervals [bold]", 0),
    Progress("solve", "iteration 0", 0, Iteration(0, 12.5, 3e-2)),
    Progress("solve", "iteration 1", 0, Iteration(1, 11.25, 1e-7)),
    Progress("verify", "covering all times", 0),
]


def tell(*, terminal: bool, quiet: bool = False) -> str:
    stream = io.StringIO()
    console = Console(file=stream, force_terminal=terminal, width=120, color_system=None)
    with ProgressView(console, quiet=quiet) as view:
        for news in NEWS:
            view(news)
    return stream.getvalue()


def test_in_a_pipe_one_line_a_phase_however_often_it_is_told():
    lines = tell(terminal=False).splitlines()
    assert [line.split("] ", 1)[1] for line in lines] == [
        "guess: initial guess by hybrid-astar",
        "solve: 30 intervals [bold]",
        "verify: covering all times",
    ]


def test_on_a_terminal_phases_end_with_iterations_and_time():
    text = tell(terminal=True)
    assert "solve: 30 intervals [bold], iteration 1 (0.0 s)" in text
    assert "verify: covering all times (0.0 s)" in text


def test_quiet():
    assert tell(terminal=False, quiet=True) == tell(terminal=True, quiet=True) == ""
