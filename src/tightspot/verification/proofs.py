"""The parts of a certificate that grow with the scene: kept in arrays, made into objects where somebody looks."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from tightspot.scenarios import Scenario
from tightspot.verification.barriers import Pairs
from tightspot.verification.certificate import ObstaclePart, PairProof
from tightspot.verification.cover import Cover
from tightspot.verification.motion import Motion

Array = NDArray[np.float64]
T = TypeVar("T")


class _Listed(Sequence[T]):
    """Equal to nothing but itself, as the records in it."""

    @abstractmethod
    def _item(self, index: int) -> T: ...

    @overload
    def __getitem__(self, index: int) -> T: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[T, ...]: ...
    def __getitem__(self, index: int | slice) -> T | tuple[T, ...]:
        chosen = range(len(self))[index]
        return self._item(chosen) if isinstance(chosen, int) else tuple(map(self._item, chosen))


class ObstacleParts(_Listed[ObstaclePart]):
    """All convex parts of a scenario's obstacles."""

    def __init__(self, scenario: Scenario) -> None:
        self._names, self._polygons = scenario.part_names, scenario.obstacle_polygons

    def __len__(self) -> int:
        return len(self._names)

    def _item(self, index: int) -> ObstaclePart:
        return ObstaclePart(self._names[index], self._polygons[index].vertices)


class PairProofs(_Listed[PairProof]):
    """The proofs of those pairs that hold. The line lies midway between what is proved of both sides.

    Args:
        motion: Of the body.
        pairs: Body parts with obstacle parts.
        clear: What was proved of them.
        names: Of the obstacle parts.
    """

    def __init__(self, motion: Motion, pairs: Pairs, clear: Cover, names: Sequence[str]) -> None:
        self._parts, self._obstacles = motion.names, names
        self._pairs = np.flatnonzero(clear.holds)
        self._part, self._obstacle = pairs.part[self._pairs], pairs.barrier[self._pairs]
        self._first = clear.first
        self._cuts = clear.cuts
        self._nx, self._ny = np.ascontiguousarray(clear.normal.T)
        self._c = clear.support + 0.5 * (clear.proved + motion.pad[pairs.part[clear.pair]])
        self._clearance = clear.proved

    def __len__(self) -> int:
        return self._pairs.size

    def _item(self, index: int) -> PairProof:
        pair = int(self._pairs[index])
        first, last = int(self._first[pair]), int(self._first[pair + 1])
        rows = slice(first, last)
        return PairProof(
            self._parts[self._part[index]],
            self._obstacles[self._obstacle[index]],
            self._cuts[first + pair : last + pair + 1],
            self._nx[rows],
            self._ny[rows],
            self._c[rows],
            self._clearance[rows],
        )
