"""What is said of many polygons at once is what is said of each."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tightspot.geometry import ConvexPolygon, PolygonStack

NUMBER = st.floats(-50, 50)
SIZE = st.floats(0.1, 20)


@st.composite
def polygons(draw: st.DrawFn) -> ConvexPolygon:
    x, y, radius, turn = draw(NUMBER), draw(NUMBER), draw(SIZE), draw(st.floats(0, 7))
    angles = turn + 2 * np.pi * np.arange(draw(st.integers(3, 9))) / 9
    return ConvexPolygon.from_vertices(np.c_[x + radius * np.cos(angles), y + 0.7 * radius * np.sin(angles)])


@given(st.lists(polygons(), max_size=8), st.lists(st.tuples(NUMBER, NUMBER), max_size=6))
def test_boxes_and_their_distances_are_those_of_each_polygon(members, points):
    stack = PolygonStack(members)
    assert tuple(stack) == tuple(members)
    assert PolygonStack.of(stack) is stack
    distances = stack.box_distances(np.array(points).reshape(-1, 2))
    for i, polygon in enumerate(members):
        assert np.array_equal(stack.vertices[stack.first[i] : stack.first[i + 1]], polygon.vertices)
        low, high = polygon.vertices.min(axis=0), polygon.vertices.max(axis=0)
        assert np.array_equal(stack.low[i], low)
        assert np.array_equal(stack.high[i], high)
        if not points:
            assert distances[i] == np.inf
            continue
        (left, bottom), (right, top) = np.min(points, axis=0), np.max(points, axis=0)
        across = max(low[0] - right, left - high[0], 0.0)
        along = max(low[1] - top, bottom - high[1], 0.0)
        assert distances[i] == pytest.approx(np.hypot(across, along))


@given(st.lists(polygons(), min_size=1, max_size=8), st.data())
def test_chosen_ones_are_a_stack_of_their_own(members, data):
    indices = np.array(data.draw(st.lists(st.integers(0, len(members) - 1), max_size=5)), dtype=np.intp)
    chosen = PolygonStack(members).chosen(indices)
    assert list(chosen) == [members[i] for i in indices]
    assert chosen.first[-1] == len(chosen.vertices)


def test_a_stack_cannot_be_changed():
    stack = PolygonStack([ConvexPolygon.rectangle(0, 1, 0, 1)])
    with pytest.raises(ValueError, match="read-only"):
        stack.vertices[0] = 1.0
    assert stack[-1] == stack[0]
    assert stack[:1] == (stack[0],)
