"""A separating line whose normal is a unit vector by construction, in the body part's frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np

from tightspot.formulations.base import Array, Formulation, Pair, Rows, at_least, at_most, free
from tightspot.formulations.lines import line_of_guess
from tightspot.geometry.polygon import ConvexPolygon


@dataclass(frozen=True)
class UnitNormalLine(Formulation):
    """Line with normal ``n = (cos phi, sin phi)`` and offset m in the body part's frame, at the knots.

    Maths, with R and T the part's rotation and translation and d the demanded clearance::

        n.V0_i >= m + d/2 for all i        n.(R^T (O_j - T)) <= m - d/2 for all j

    The normal has length 1, so the distance is at least d, also for d = 0, and there is no null direction. In the
    part's frame the body's side does not depend on the pose.

    Auxiliary variables: phi (rad), m (m). Rows: N_B + N_O. Holds at the knots only.

    Reference: the paper's (17) with lam = (cos phi, sin phi).
    """

    name: ClassVar[str] = "unit-normal-line"
    equation: ClassVar[str] = "(17) with a unit normal"
    holds: ClassVar[Literal["knots", "interval"]] = "knots"
    is_exact: ClassVar[bool] = True
    expresses_margin: ClassVar[bool] = True

    def auxiliary_bounds(self, n_body: int, n_obstacle: int) -> tuple[Array, Array]:
        return free(2)

    def rows(self, auxiliary: Any, pair: Pair) -> Sequence[Rows]:
        phi, offset = auxiliary[0], auxiliary[1]
        normal, half = ca.vertcat(ca.cos(phi), ca.sin(phi)), pair.margins[0] / 2
        body, obstacle = pair.V0 @ normal, pair.obstacle_in_body_frame(0) @ normal
        return [at_least(body - offset - half), at_most(obstacle - offset + half)]

    def start(self, poses: Array, body: ConvexPolygon, obstacle: ConvexPolygon) -> Array:
        normal, offset = line_of_guess(poses, body, obstacle)
        pose = poses[:, 0]
        phi = np.arctan2(normal[:, 1], normal[:, 0]) - pose[:, 2]
        return np.column_stack([phi, offset - np.einsum("mi,mi->m", normal, pose[:, :2])])
