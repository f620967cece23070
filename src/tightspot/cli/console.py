"""Where text goes: answers to standard output, everything else to standard error."""

from __future__ import annotations

import json
import sys
from typing import Any, TextIO

from rich.console import Console

_PIPE_WIDTH = 160


def answers() -> Console:
    """For what was asked for."""
    return _console(sys.stdout)


def notes() -> Console:
    """For progress, warnings and errors."""
    return _console(sys.stderr)


def print_json(data: Any) -> None:
    """One JSON value on standard output; what is not finite would be no JSON and raises ``ValueError``."""
    sys.stdout.write(json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False) + "\n")
    sys.stdout.flush()


def print_line(console: Console, text: str, style: str = "") -> None:
    """``text`` as one line: taken literally, never wrapped, control characters made visible."""
    line = "".join(character if character.isprintable() else "?" for character in " ".join(text.splitlines()))
    console.print(line, style=style or None, markup=False, highlight=False, soft_wrap=True, emoji=False)


def _console(stream: TextIO) -> Console:
    # A table must not be folded to 80 columns because nobody watches.
    return Console(file=stream, width=None if stream.isatty() else _PIPE_WIDTH)
