"""What the body must stay clear of, as (body part, barrier) pairs that all offer a line."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from tightspot.geometry import ConvexPolygon, best_line
from tightspot.verification import compiled
from tightspot.verification.motion import lowest, stack_padded

if TYPE_CHECKING:
    from tightspot.verification.compiled import Barriers

Array = NDArray[np.float64]
Index = NDArray[np.intp]


class Pairs(Protocol):
    """(Body part, barrier) pairs.

    Attributes:
        part: Body part of each pair, shape (P,).
        barrier: Obstacle part or workspace edge of each pair, shape (P,).
    """

    part: Index
    barrier: Index

    @property
    def core(self) -> Barriers:
        """The barriers in the compiled core."""
        ...

    def lines(self, pair: Index, vertices: Array) -> tuple[Array, Array, Array]:
        """A good line for each pair with its body part at the vertices (B, n_V, 2).

        Returns:
            Unit normals towards the body (B, 2), the largest n.o over the barrier (B,) and the clearance
            (B,), m.
        """
        ...


class ObstaclePairs:
    """Every body part with every obstacle part; the line is the best separating one."""

    def __init__(self, parts: int, obstacles: Sequence[ConvexPolygon]) -> None:
        self.part, self.barrier = _product(parts, len(obstacles))
        self._obstacles = obstacles

    @cached_property
    def core(self) -> Barriers:
        return compiled.obstacles(self._obstacles)

    @cached_property
    def _O(self) -> Array:
        return stack_padded([polygon.vertices for polygon in self._obstacles])

    def lines(self, pair: Index, vertices: Array) -> tuple[Array, Array, Array]:
        O = self._O[self.barrier[pair]]
        normal, _, clearance = best_line(vertices, O)
        return normal, -lowest(-normal, O), clearance


class WorkspacePairs:
    """Every body part with every edge of the workspace: the barrier is what lies beyond the edge."""

    def __init__(self, parts: int, workspace: ConvexPolygon) -> None:
        self.part, self.barrier = _product(parts, workspace.b.size)
        self._workspace = workspace
        self._normal, self._support = -workspace.A, -workspace.b

    @cached_property
    def core(self) -> Barriers:
        return compiled.walls(self._workspace)

    def lines(self, pair: Index, vertices: Array) -> tuple[Array, Array, Array]:
        normal, support = self._normal[self.barrier[pair]], self._support[self.barrier[pair]]
        return normal, support, lowest(normal, vertices) - support


def _product(parts: int, barriers: int) -> tuple[Index, Index]:
    part, barrier = np.divmod(np.arange(parts * barriers), max(1, barriers))
    return part.astype(np.intp, copy=False), barrier.astype(np.intp, copy=False)
