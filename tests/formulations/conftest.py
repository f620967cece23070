"""A formulation's rows as numbers, for any member and any pair of polygons."""

from functools import cache

import casadi as ca
import numpy as np
import pytest

from tightspot.formulations import (
    Pair,
    Pose,
    SeparatingGap,
    SeparatingLine,
    SharedVertexExclusion,
    SweptLine,
    SweptUnitNormalLine,
    UnitNormalLine,
)
from tightspot.formulations.duals import support_multipliers
from tightspot.geometry import rotation, transform


class Evaluator:
    """Rows of one member for a body polygon, with obstacle, poses, margins and auxiliary variables as symbols."""

    def __init__(self, member, body, n_obstacle, n_poses):
        self.member, self.body, self.n_poses = member, body, n_poses
        self.lower, self.upper = member.auxiliary_bounds(len(body.b), n_obstacle)
        obstacle = [ca.SX.sym(name, n_obstacle, columns) for name, columns in (("O", 2), ("A", 2), ("b", 1))]
        poses, margins = ca.SX.sym("poses", n_poses, 3), ca.SX.sym("margins", n_poses)
        self.auxiliary = ca.SX.sym("aux", self.lower.size)
        pair = Pair(
            tuple(Pose(*ca.horzsplit(poses[p, :])) for p in range(n_poses)),
            body.vertices,
            body.A,
            body.b,
            *obstacle,
            tuple(margins[p] for p in range(n_poses)),
        )
        self.rows = list(member.rows(self.auxiliary, pair))
        self.expression = ca.vertcat(*(row.expression for row in self.rows))
        self.lbg, self.ubg = (np.concatenate([getattr(row, end) for row in self.rows]) for end in ("lower", "upper"))
        self.parameters = [*obstacle, poses, margins]
        self.function = ca.Function("rows", [self.auxiliary, *self.parameters], [self.expression])

    @staticmethod
    def arguments(obstacle, poses, margins):
        return [obstacle.vertices, obstacle.A, obstacle.b, poses, margins]

    def values(self, aux, obstacle, poses, margins):
        return np.array(self.function(aux, *self.arguments(obstacle, poses, margins))).ravel()

    def violation(self, aux, obstacle, poses, margins):
        """Largest violation of a row or of an auxiliary variable's bound."""
        values = self.values(aux, obstacle, poses, margins)
        outside = np.r_[self.lbg - values, values - self.ubg, self.lower - aux, aux - self.upper]
        return float(outside.max(initial=0.0))

    def start(self, obstacle, poses):
        return self.member.start(poses[None], self.body, obstacle)[0]


@pytest.fixture(scope="session")
def evaluator():
    """``evaluator(member, body, n_obstacle, n_poses)``, built once."""
    return cache(Evaluator)


@pytest.fixture(scope="session")
def line_auxiliary():
    """``line_auxiliary(member, body, obstacle, pose, direction, length)``: see the function."""
    return _line_auxiliary


def _line_auxiliary(member, body, obstacle, pose, direction, length=1.0):
    """The auxiliary variables that serve an exact member's rows best among normals of one direction and length."""
    n = np.array([np.cos(direction), np.sin(direction)])
    nearest = (transform(body.vertices, pose) @ n).min()
    farthest = (obstacle.vertices @ n).max()
    if isinstance(member, SeparatingLine | SweptLine):
        return length * np.array([*n, (nearest + farthest) / 2])
    if isinstance(member, SeparatingGap):
        return length * np.array([*n, nearest, farthest])
    if isinstance(member, UnitNormalLine):  # in the body's frame
        return np.array([direction - pose[2], (nearest + farthest) / 2 - n @ pose[:2]])
    if isinstance(member, SweptUnitNormalLine):
        return np.array([direction, (nearest + farthest) / 2])
    if member.name == "min-edge-distance":
        return np.zeros(0)
    lam = support_multipliers(obstacle, n[None])[0]
    mu = support_multipliers(body, -n[None] @ rotation(pose[2]))[0]
    if isinstance(member, SharedVertexExclusion):
        return length * np.r_[mu, lam]
    return length * np.tile(np.r_[lam, mu], member.copies)
