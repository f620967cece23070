"""The command ``tightspot``: one file a command, one place where failures become sentences."""

from tightspot.cli.app import main

__all__ = ["main"]
