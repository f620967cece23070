"""Numbers beyond all measure anywhere in a file of any format: read or refused, without overflow on the way."""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable

import pytest

from tightspot.errors import SceneError
from tightspot.scenarios import builtin, load, save

HUGE = ("9e307", "-1.7e308", "1e200", "1e12", "1e-320")
NUMBER = re.compile(r"(?<![\w.])-?\d+(\.\d+)?(e-?\d+)?(?![\w.])")
PLACES = 25
TPCAP = "0,0,0,9,1,0,2,4,3,4,4,6,4,6,6,4,6,-4,4,-6,4,-6,6\n"
MAP = """image: cells.pgm
resolution: 0.5
origin: [0.0, 0.0, 0.0]
occupied_thresh: 0.65
free_thresh: 0.196
tightspot:
  start: {x: 1.0, y: 1.0, theta: 0.0, v: 0.0, delta: 0.0}
  goal: {x: 3.0, y: 1.0, theta: 0.0}
  margin: 0.05
  tolerance: {position: 0.1, heading: 0.1}
  simplify: 0.5
  workspace: {x: [0.0, 4.0], y: [0.0, 3.0]}
"""


@pytest.fixture(params=["tpcap.csv", "map.yaml", "yaml", "json", "geojson", "wkt", "xml"])
def content(request, tmp_path) -> tuple[str, str]:
    """A file's name and a good content."""
    name = request.param
    if name == "tpcap.csv":
        return name, TPCAP
    if name == "map.yaml":
        (tmp_path / "cells.pgm").write_bytes(b"P5\n8 6\n255\n" + bytes(47) + b"\xfe")
        return name, MAP
    save(builtin("vertical"), tmp_path / f"good.{name}")
    return f"scene.{name}", (tmp_path / f"good.{name}").read_text()


@pytest.fixture
def read(tmp_path, content) -> Callable[[str], None]:
    """Reads a file of that content: a scene or a refusal; warnings are errors."""

    def read(text: str) -> None:
        path = tmp_path / content[0]
        path.write_text(text)
        problems = []
        try:
            load(path)
        except SceneError as error:
            problems = error.problems
        assert all(0 < len(str(problem)) < 700 for problem in problems)

    return read


def test_one_huge_number(content, read):
    text = content[1]
    places = list(NUMBER.finditer(text))
    for place in places[:: -(-len(places) // PLACES)]:
        for number in HUGE:
            read(text[: place.start()] + number + text[place.end() :])


def test_nothing_but_huge_numbers(content, read):
    for numbers in itertools.product(HUGE, repeat=2):
        turns = itertools.cycle(numbers)
        read(NUMBER.sub(lambda _, turns=turns: next(turns), content[1]))
