"""Rows without solving."""

import pytest

from tightspot.campaigns import METHODS, Row


@pytest.fixture
def make_row():
    def make(scene="vertical", method="17", guess="hybrid-astar", **fields):
        key = f"{scene} / {method} / {guess}"
        known = {"status": "SOLVED", "objective": 1.0, "final_time": 80.0, "effort": 0.03, "seconds": 0.1, "runs": 1}
        known |= {"iterations": 20, "certified": True, "penetration": 0.0, "verdict": "certified", "VN": 1, "CN": 1}
        assert method in METHODS
        return Row(key=key, scene=scene, method=method, guess=guess, **(known | fields))

    return make
