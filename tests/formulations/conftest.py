"""A formulation's rows as numbers, for any member and any pair of polygons."""

from functools import cache

import casadi as ca
import numpy as np
import pytest

from tightspot.formulations import Pair, Pose


class Evaluator:
    """Rows of one member for body polygon, obstacle polygon, poses, margins and auxiliary variables."""

    def __init__(self, member, n_body, n_obstacle, n_poses):
        self.member, self.n_poses = member, n_poses
        self.lower, self.upper = member.auxiliary_bounds(n_body, n_obstacle)
        body = [ca.SX.sym(name, n_body, columns) for name, columns in (("V0", 2), ("C0", 2), ("d0", 1))]
        obstacle = [ca.SX.sym(name, n_obstacle, columns) for name, columns in (("O", 2), ("A", 2), ("b", 1))]
        poses, margins = ca.SX.sym("poses", n_poses, 3), ca.SX.sym("margins", n_poses)
        self.auxiliary = ca.SX.sym("aux", self.lower.size)
        pair = Pair(
            tuple(Pose(*ca.horzsplit(poses[p, :])) for p in range(n_poses)),
            *body,
            *obstacle,
            tuple(margins[p] for p in range(n_poses)),
        )
        self.rows = list(member.rows(self.auxiliary, pair))
        self.expression = ca.vertcat(*(row.expression for row in self.rows))
        self.lbg, self.ubg = (
            np.concatenate([getattr(row, end) for row in self.rows]) for end in ("lower", "upper")
        )
        self.parameters = [*body, *obstacle, poses, margins]
        self.function = ca.Function("rows", [self.auxiliary, *self.parameters], [self.expression])

    @staticmethod
    def arguments(body, obstacle, poses, margins):
        return [body.vertices, body.A, body.b, obstacle.vertices, obstacle.A, obstacle.b, poses, margins]

    def values(self, aux, body, obstacle, poses, margins):
        return np.array(self.function(aux, *self.arguments(body, obstacle, poses, margins))).ravel()

    def violation(self, aux, body, obstacle, poses, margins):
        """Largest violation of a row or of an auxiliary variable's bound."""
        values = self.values(aux, body, obstacle, poses, margins)
        outside = np.r_[self.lbg - values, values - self.ubg, self.lower - aux, aux - self.upper]
        return float(outside.max(initial=0.0))

    def start(self, body, obstacle, poses):
        return self.member.start(poses[None], body.vertices, obstacle.vertices)[0]


@pytest.fixture(scope="session")
def evaluator():
    """``evaluator(member, n_body, n_obstacle, n_poses)``, built once a shape."""
    return cache(Evaluator)
