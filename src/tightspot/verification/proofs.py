"""The parts of a certificate that grow with the scene: kept in arrays, made into objects where somebody looks."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from functools import cached_property
from typing import TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from tightspot.scenarios import Scenario
from tightspot.verification.barriers import Pairs
from tightspot.verification.certificate import ObstaclePart, PairProof, WorkspaceProof
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


class _Proofs(_Listed[T]):
    """Of those pairs that hold.

    Args:
        motion: Of the body.
        pairs: Body parts with what they must stay clear of.
        cover: What was proved of them.
    """

    def __init__(self, motion: Motion, pairs: Pairs, cover: Cover) -> None:
        self._parts, self._pad = motion.names, motion.pad
        self._part, self._barrier = pairs.part, pairs.barrier
        self._cover = cover
        self._pairs = np.flatnonzero(cover.holds)

    def __len__(self) -> int:
        return self._pairs.size

    def _found(self, index: int) -> tuple[str, int, Array, slice]:
        """Name of the body part, index of the barrier, cuts of the horizon, and rows of the cover."""
        pair, first = int(self._pairs[index]), self._cover.first
        rows = slice(int(first[pair]), int(first[pair + 1]))
        cuts = self._cover.cuts[rows.start + pair : rows.stop + pair + 1]
        return self._parts[self._part[pair]], int(self._barrier[pair]), cuts, rows


class PairProofs(_Proofs[PairProof]):
    """The proofs that the body stays clear of obstacles. The line lies midway between what is proved of both sides.

    Args:
        motion: Of the body.
        pairs: Body parts with obstacle parts.
        clear: What was proved of them.
        names: Of the obstacle parts.
    """

    def __init__(self, motion: Motion, pairs: Pairs, clear: Cover, names: Sequence[str]) -> None:
        super().__init__(motion, pairs, clear)
        self._names = names

    @cached_property
    def _lines(self) -> tuple[Array, Array, Array]:
        """x and y of the normals and offsets, of all rows of the cover."""
        clear = self._cover
        nx, ny = np.ascontiguousarray(clear.normal.T)
        return nx, ny, clear.support + 0.5 * (clear.proved + self._pad[self._part[clear.pair]])

    def _item(self, index: int) -> PairProof:
        part, obstacle, cuts, rows = self._found(index)
        nx, ny, c = self._lines
        return PairProof(part, self._names[obstacle], cuts, nx[rows], ny[rows], c[rows], self._cover.proved[rows])


class WorkspaceProofs(_Proofs[WorkspaceProof]):
    """The proofs that the body stays in the workspace, edge by edge."""

    def _item(self, index: int) -> WorkspaceProof:
        part, edge, cuts, rows = self._found(index)
        return WorkspaceProof(part, edge, cuts, self._cover.proved[rows])
