"""A file to be read: its bytes, text and data, each read once however many formats look at it."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import Any

from tightspot.safe_yaml import UnreadableError, load_json, load_yaml
from tightspot.scenarios.readers.files import read_text, refuse


class Source:
    """The file at ``path``; whatever is asked of it raises :class:`tightspot.errors.SceneError` if it is unreadable."""

    def __init__(self, path: Path) -> None:
        self.path = path

    @property
    def name(self) -> str:
        """What a scene is called that has no name of its own."""
        return self.path.stem[:200]

    @cached_property
    def text(self) -> str:
        """The content as text."""
        return read_text(self.path)

    @cached_property
    def yaml(self) -> Any:
        """The content as plain data from YAML."""
        return self._parsed(load_yaml)

    @cached_property
    def json(self) -> Any:
        """The content as plain data from JSON."""
        return self._parsed(load_json)

    def _parsed(self, parse: Callable[[str], Any]) -> Any:
        try:
            return parse(self.text)
        except UnreadableError as error:
            raise refuse(self.path, str(error)) from None
