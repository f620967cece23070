"""What the scenario tests share: a small good scene, the competition's files, and a way to read problems."""

from __future__ import annotations

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tightspot.errors import SceneError

TPCAP = Path(__file__).parents[3] / "shared" / "data" / "tpcap"

SCENE: dict[str, Any] = {
    "name": "test",
    "workspace": {"x": [-10, 20], "y": [-10, 10]},
    "obstacles": [
        {"name": "block", "vertices": [[4, 4], [6, 4], [6, 6], [4, 6]]},
        {"name": "L", "vertices": [[10, 5], [14, 5], [14, 6], [11, 6], [11, 9], [10, 9]]},
    ],
    "start": {"x": 0, "y": 0, "theta": 0},
    "goal": {"x": 8, "y": -3, "theta": 0.5},
}


@pytest.fixture
def scene() -> dict[str, Any]:
    """A scene that is fine; each test gets its own copy."""
    return copy.deepcopy(SCENE)


@pytest.fixture(scope="session")
def tpcap() -> Path:
    """The folder of the competition's scenes, which the repository does not carry."""
    if not TPCAP.is_dir():
        pytest.skip(f"needs the TPCAP scenes in {TPCAP}, which are not part of the repository")
    return TPCAP


@pytest.fixture
def problems() -> Callable[[Callable[[], Any]], dict[str, str]]:
    """``problems(call)``: the problems of the SceneError that the call must raise, message by path."""

    def caught(call: Callable[[], Any]) -> dict[str, str]:
        with pytest.raises(SceneError) as caught:
            call()
        assert caught.value.problems
        return {problem.path: problem.message for problem in caught.value.problems}

    return caught
