"""Results in order, however many threads, and an end that comes at once."""

from __future__ import annotations

import threading
from contextlib import closing

import pytest

from tightspot.guesses.ahead import in_order


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_results_are_those_of_the_items_in_order(threads):
    assert list(in_order(lambda item: item * item, range(20), threads)) == [item * item for item in range(20)]


def test_no_more_items_are_taken_than_a_few_ahead():
    taken = []

    def items():
        for item in range(100):
            taken.append(item)
            yield item

    with closing(in_order(abs, items(), 3)) as results:
        assert [next(results) for _ in range(5)] == [0, 1, 2, 3, 4]
    assert len(taken) <= 5 + 3 + 1


def test_at_the_end_what_still_runs_is_told():
    ended = threading.Event()

    def wait_for_the_end(item: int) -> int:
        if item:
            assert ended.wait(30), "the end was not told"
        return item

    with closing(in_order(wait_for_the_end, range(10), 2, ended.set)) as results:
        assert next(results) == 0
    assert ended.is_set()


def test_an_exception_reaches_the_reader():
    def fail(item: int) -> int:
        if item == 3:
            raise ValueError("three")
        return item

    results = in_order(fail, range(10), 2)
    assert [next(results) for _ in range(3)] == [0, 1, 2]
    with pytest.raises(ValueError, match="three"):
        next(results)
