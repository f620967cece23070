"""Options at their borders, and what happens without the compiled core."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from tightspot.errors import BuildError, InputError
from tightspot.search import HybridAStarOptions, Path, shortest_path


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("margins", ()),
        ("margins", (0.1, -0.1)),
        ("margins", (np.nan,)),
        ("resolutions", ()),
        ("directions", ()),
        ("curvature_factor", 0.0),
        ("curvature_factor", 1.1),
        ("gear_change", -1.0),
        ("reverse", 0.5),
        ("steering_levels", 4),
        ("steering_levels", 3),
        ("heuristic_weight", 0.9),
        ("max_expansions", 0),
        ("time_limit", 0.0),
        ("time_limit", np.nan),
        ("spacing", 0.0),
    ],
)
def test_values_out_of_range_are_named(field, value):
    with pytest.raises(InputError) as caught:
        HybridAStarOptions(**{field: value})
    assert [problem.path for problem in caught.value.problems] == [field]


def test_all_problems_are_reported_at_once():
    with pytest.raises(InputError) as caught:
        HybridAStarOptions(spacing=-1.0, reverse=0.0, margins=())
    assert {problem.path for problem in caught.value.problems} == {"spacing", "reverse", "margins"}


@pytest.mark.parametrize("spacing", [0.0, -1.0, np.nan, np.inf])
def test_a_path_needs_a_positive_spacing(spacing):
    with pytest.raises(InputError, match="spacing"):
        Path.from_arcs((0, 0, 0), [(1.0, 0.0)], spacing)


def test_a_missing_core_is_explained_with_its_remedy(monkeypatch):
    monkeypatch.setitem(sys.modules, "tightspot._core", None)
    monkeypatch.delattr("tightspot._core", raising=False)
    with pytest.raises(BuildError, match="apt install g\\+\\+"):
        shortest_path((0, 0, 0), (1, 0, 0), 1.0)
