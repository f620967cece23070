"""Symbols of the last few structures: two programs that differ in numbers only share theirs."""

from __future__ import annotations

import hashlib
import pickle
import threading
from collections import OrderedDict
from collections.abc import Hashable
from typing import TYPE_CHECKING, Any

from tightspot.transcription.builder import Builder, Shape, Symbols
from tightspot.transcription.grid import TimeGrid
from tightspot.vehicles.base import VehicleModel

if TYPE_CHECKING:
    from tightspot.transcription.transcribe import Settings

KEPT = 12
"""How many structures are kept: the least recently used one is dropped."""

_kept: OrderedDict[Hashable, Symbols] = OrderedDict()
_lock = threading.Lock()


def symbols_for(vehicle: VehicleModel, settings: Settings, grid: TimeGrid, shape: Shape) -> Symbols:
    """The program's symbols, built now or kept from a program of the same structure.

    What cannot be pickled, like a vehicle of a class defined inside a function, is built each time.
    """
    key = _key(vehicle, settings, grid, shape)
    with _lock:
        found = _kept.get(key) if key is not None else None
        if found is not None:
            _kept.move_to_end(key)
            return found
    symbols = Builder(vehicle, settings, grid, shape).build()
    if key is not None:
        with _lock:
            symbols = _kept.setdefault(key, symbols)
            while len(_kept) > KEPT:
                _kept.popitem(last=False)
    return symbols


def forget() -> None:
    """Drop everything that is kept."""
    with _lock:
        _kept.clear()


def _key(vehicle: VehicleModel, settings: Settings, grid: TimeGrid, shape: Shape) -> Hashable | None:
    """Equal for equal structures; the texts of vehicle and formulation count, not only their numbers."""
    numbers = (
        vehicle,
        settings.formulation,
        settings.objective.energy,
        settings.substeps,
        settings.pieces(grid.steps),
        settings.whole(grid.steps),
        grid.fractions.tobytes(),
        shape.obstacles,
        *((mask.shape, mask.tobytes()) for mask in (shape.walls_pattern, shape.active, shape.walls)),
        shape.fixed_poses,
        shape.moving,
    )
    try:
        digest = hashlib.sha256(pickle.dumps(numbers)).digest()
    except Exception:  # whatever the vehicle's own class raises
        return None
    return digest, _texts(type(vehicle)), _texts(type(settings.formulation))


def _texts(kind: type) -> tuple[Any, ...]:
    """A class and its methods, which a notebook may have redefined under the same name."""
    return kind, *(value for base in kind.__mro__ for value in vars(base).values() if callable(value))
