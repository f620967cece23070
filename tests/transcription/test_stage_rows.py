"""What the core demands of which pairs and walls, against the same in NumPy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tightspot.solvers.stage_core import compiled


@given(st.integers(0, 2**32 - 1), st.integers(1, 6), st.tuples(st.booleans(), st.booleans()))
def test_rows_and_demands(seed, steps, given_ends):
    rng = np.random.default_rng(seed)
    poses = rng.integers(0, 4, steps)
    whole, pieces = poses > 0, np.maximum(poses, 1)
    active, near = rng.random((steps, 2, 3)) < 0.5, rng.random((steps, 2, 4)) < 0.5
    normals, offsets = rng.normal(size=(4, 2)), rng.normal(size=4)
    margin, end_margin, wall_margin = rng.uniform(0, 0.1, 3)
    wanted = compiled().Clearances(margin, end_margin, wall_margin, *given_ends)
    found = compiled().stagewise_rows(active, near, normals, offsets, poses, wanted)
    pairs, sides, wall_places, lines, pair, wall = found
    edges = np.argwhere(near)
    assert np.array_equal(pairs, np.argwhere(active))
    assert np.array_equal(wall_places, edges[:, :2])
    assert np.array_equal(lines, np.column_stack([normals, offsets])[edges[:, 2]])
    last = np.cumsum(pieces + 1) - 1
    first = last - pieces
    rows = np.ones(last[-1] + 1, bool)
    rows[first[~whole]] = False
    clearance, walls = (
        np.column_stack([np.full(rows.size, constant), np.repeat(whole, pieces + 1)])
        for constant in (margin, wall_margin)
    )
    if given_ends[0]:
        clearance[0], walls[0] = (end_margin, 0.0), np.nan
    if given_ends[1]:
        clearance[-1], walls[-1] = (end_margin, 0.0), 0.0
    walls[~rows] = np.nan
    obstacle_side = clearance[np.where(whole, first, last)] / 2
    assert sides == pytest.approx(obstacle_side[pairs[:, 0]])
    assert (np.isnan(pair[:, 0]) == ~rows).all()
    both = pair + np.repeat(obstacle_side, pieces + 1, axis=0)
    assert both[rows] == pytest.approx(clearance[rows], abs=1e-15)
    assert wall == pytest.approx(walls, nan_ok=True)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"active": np.zeros((3, 1, 1), bool)}, "active"),
        ({"walls": np.zeros((2, 1, 3), bool)}, "wall_lines"),
        ({"offsets": np.zeros(3)}, "wall_lines"),
        ({"poses": np.array([1, -1])}, "pieces"),
        ({"poses": np.array([1, 2000])}, "pieces"),
    ],
)
def test_what_does_not_fit_is_named(change, named):
    fits = {
        "active": np.zeros((2, 1, 1), bool), "walls": np.zeros((2, 1, 4), bool), "normals": np.zeros((4, 2)),
        "offsets": np.zeros(4), "poses": np.ones(2, np.int64), "clearances": compiled().Clearances(0, 0, 0, True, True),
    }  # fmt: skip
    with pytest.raises(ValueError, match=named):
        compiled().stagewise_rows(**(fits | change))
