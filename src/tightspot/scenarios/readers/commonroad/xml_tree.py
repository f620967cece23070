"""XML from strangers: no document type, no entity, bounded in size and count; every value with its place in the file.

defusedxml refuses what the standard library's parser would expand or fetch. What is left is slow rather than dangerous
(a file of 10 MB may hold a million elements or attributes) and is counted before it is parsed.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

from tightspot.errors import Problem, SceneError, TightspotError
from tightspot.problems import shown
from tightspot.scenarios.readers.files import read_text, refuse

MAX_TAGS = 800_000
"""Opening and closing ones; 50,000 vertices need 300,000."""
MAX_ATTRIBUTES = 200_000

_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d{1,4})?", re.ASCII)
_INTEGER = re.compile(r"[-+]?\d{1,18}", re.ASCII)
_MOST_TURNS = 2


@dataclass(frozen=True)
class Node:
    """An element and its place in the file, for messages: ``planningProblem[5].goalState.velocity``."""

    element: ElementTree.Element
    path: str

    def find(self, name: str) -> Node | None:
        """The first child of that name."""
        found = self.element.find(name)
        return None if found is None else self._child(found)

    def child(self, name: str) -> Node:
        """The first child of that name; raises :class:`SceneError` if there is none."""
        found = self.find(name)
        if found is None:
            raise self.refuse(f"has no {name}; add it")
        return found

    def children(self, *names: str) -> Iterator[Node]:
        """All children, or those of the given names, in the file's order."""
        for child in self.element:
            if isinstance(child.tag, str) and (not names or child.tag in names):
                yield self._child(child)

    @property
    def tag(self) -> str:
        return str(self.element.tag)

    @property
    def text(self) -> str:
        return (self.element.text or "").strip()

    def attribute(self, name: str) -> str:
        """An attribute's text, stripped; empty if it is not there."""
        return self.element.get(name, "").strip()

    def number(self) -> float:
        """The text as a finite number; raises :class:`SceneError`."""
        value = float(self.text) if len(self.text) <= 400 and _NUMBER.fullmatch(self.text) else math.nan
        if not math.isfinite(value):
            raise self.refuse(f"{_given(self.text)} is not a finite number")
        return value

    def positive(self) -> float:
        """The text as a number above 0; raises :class:`SceneError`."""
        value = self.number()
        if not value > 0:
            raise self.refuse(f"{value:g} must be more than 0")
        return value

    def angle(self) -> float:
        """The text as an angle, rad; raises :class:`SceneError` beyond two turns, which looks like degrees."""
        value = self.number()
        if abs(value) > _MOST_TURNS * 2 * math.pi:
            advice = f": {value:g} deg = {math.radians(value):.6g} rad" if abs(value) < 1000 else ""
            raise self.refuse(f"{value:g} rad is more than two turns; angles are in radians{advice}")
        return value

    def integer(self) -> int:
        """The text as a whole number; raises :class:`SceneError`."""
        if not _INTEGER.fullmatch(self.text):
            raise self.refuse(f"{_given(self.text)} is not a whole number")
        return int(self.text)

    def comments(self) -> list[str]:
        """The comments directly inside this element."""
        return [child.text or "" for child in self.element if not isinstance(child.tag, str)]

    def refuse(self, sentence: str) -> SceneError:
        """The exception that says what is wrong with this element."""
        return SceneError(Problem(self.path, sentence))

    def _child(self, element: ElementTree.Element) -> Node:
        tag, number = str(element.tag), element.get("id", "")
        name = f"{tag}[{number}]" if re.fullmatch(r"\d{1,18}", number) else tag
        return Node(element, f"{self.path}.{name}" if self.path else name)


def parse(path: Path) -> Node:
    """The root element of an XML file.

    Raises:
        SceneError: The file cannot be read, is over 10 MB, is no XML, has a document type or entities, or holds more
            tags or attributes than a scene does.
        TightspotError: defusedxml is not installed.
    """
    try:
        from defusedxml.common import DefusedXmlException
        from defusedxml.ElementTree import DefusedXMLParser
    except ModuleNotFoundError:
        advice = 'install it with: pip install "tightspot[readers]"'
        raise TightspotError(f"CommonRoad files need defusedxml, which is not installed; {advice}") from None
    text = read_text(path)
    for sign, most, what in (("<", MAX_TAGS, "tags"), ("=", MAX_ATTRIBUTES, "attributes")):
        if text.count(sign) > most:
            raise refuse(path, f"holds more than {most} {what}, which no scene does")
    parser = DefusedXMLParser(target=ElementTree.TreeBuilder(insert_comments=True), forbid_dtd=True)
    try:
        parser.feed(text)
        return Node(parser.close(), "")
    except DefusedXmlException:
        raise refuse(path, "has a document type or entities, which are not read; remove the <!DOCTYPE …>") from None
    except ElementTree.ParseError as error:
        raise refuse(path, f"is not readable as XML: {error}") from None


def _given(text: str) -> str:
    return shown(text) if text else "nothing"
