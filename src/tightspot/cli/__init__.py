"""The command ``tightspot``: one file a command, one place where failures become sentences."""

from __future__ import annotations

import sys
from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Args:
        arguments: Without the program's name; default: the process's.

    Returns:
        The exit code, see ``tightspot --help``.
    """
    try:
        from tightspot.cli.app import run  # here, so that an interrupt while it loads shows no traceback

        return run(sys.argv[1:] if arguments is None else list(arguments))
    except KeyboardInterrupt:
        sys.stderr.write("interrupted: nothing was written\n")
        return 130


__all__ = ["main"]
