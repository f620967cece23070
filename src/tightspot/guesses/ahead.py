"""Results in the order of what they are made from, while later ones are made ahead on other threads."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


def in_order(
    make: Callable[[Item], Result],
    items: Iterable[Item],
    threads: int,
    at_end: Callable[[], object] = lambda: None,
) -> Generator[Result, None, None]:
    """``make`` of every item, in order, however many threads: who stops early sees no difference but in time.

    Args:
        make: Called on another thread if there is more than one.
        items: Taken one by one, up to ``threads`` ahead of what is yielded.
        threads: 1 or more.
        at_end: Called when nothing more is wanted, also after an exception, before what still runs is waited for.
    """
    if threads == 1:
        yield from map(make, items)
        return
    ahead: deque[Future[Result]] = deque()
    with ThreadPoolExecutor(threads) as pool:
        try:
            for item in items:
                ahead.append(pool.submit(make, item))
                if len(ahead) > threads:
                    yield ahead.popleft().result()
            while ahead:
                yield ahead.popleft().result()
        finally:
            at_end()
            for future in ahead:
                future.cancel()
