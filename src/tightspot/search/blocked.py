"""How much of a path the body cannot drive."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tightspot.geometry.polygon import ConvexPolygon
from tightspot.geometry.stack import PolygonStack
from tightspot.search.core import compiled_core
from tightspot.search.hybrid_astar import Car
from tightspot.search.path import Path


def blocked_shares(
    workspace: ConvexPolygon,
    obstacles: Sequence[ConvexPolygon],
    vehicle: Car,
    paths: Sequence[Path],
    margin: float,
) -> list[float]:
    """Of each path the share of its poses at which the body is nearer than ``margin`` (m) to an obstacle or outside W.

    0 if all its poses are free, between 0 and 1 otherwise; the motion between the poses is not looked at.

    Raises:
        BuildError: The compiled core is missing.
    """
    parts = [np.ascontiguousarray(part.polygon.vertices) for part in vehicle.parts]
    solids, border = PolygonStack.of(obstacles), np.ascontiguousarray(workspace.vertices)
    checker = compiled_core().CollisionChecker(parts, border, solids.vertices, solids.first, margin)
    return [float(np.mean(checker.slack(np.ascontiguousarray(path.poses)) <= 0)) for path in paths]
