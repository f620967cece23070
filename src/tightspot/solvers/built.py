"""Built solvers, kept for the next problem of the same structure.

Deriving and sorting the functions of a program takes longer than solving it. A program whose numbers have changed but
whose symbols are the same objects (see :func:`tightspot.transcription.transcribe`) is solved by the solver that was
built for it before.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

from tightspot.solvers.nlp import Nlp

T = TypeVar("T")

KEPT = 12
"""How many built solvers are kept: the least recently used one is dropped."""

_kept: OrderedDict[Hashable, tuple[Any, tuple[Any, ...]]] = OrderedDict()
_lock = threading.Lock()


@contextmanager
def built(nlp: Nlp, key: Hashable, build: Callable[[], T]) -> Iterator[T]:
    """What ``build`` makes of the program's symbols, made now or kept from before.

    While it is in use nobody else gets it: another thread that asks for the same builds its own.

    Args:
        nlp: The program; its symbols must be all of it that ``build`` depends on, beyond the key.
        key: What else it depends on: backend and options.
        build: Makes it.
    """
    symbols = (nlp.x, nlp.p, nlp.f, nlp.g)
    full = (key, *map(id, symbols))
    with _lock:
        found = _kept.pop(full, None)
    value = build() if found is None else found[0]
    yield value
    with _lock:
        _kept[full] = value, symbols
        while len(_kept) > KEPT:
            _kept.popitem(last=False)


def forget() -> None:
    """Drop everything that is kept."""
    with _lock:
        _kept.clear()
