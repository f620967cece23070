"""An :class:`Nlp` rewritten so that only dynamics connect its stages: what optimal-control solvers ask for.

The stages of an :class:`Nlp` share t_f, and rows of formulations that hold on an interval touch both of its ends. Here

- every stage gets a copy s_k of the shared variables, with ``s_{k+1} = s_k`` as one more dynamics row;
- rows that touch the stage before are moved to it, with ``xi_{k+1}`` replaced by ``F(xi_k, u_k)``, and so are the
  auxiliary variables that they need;
- the objective is taken apart into one term a stage.

Order of the variables: stage after stage (xi_k, s_k), (u_k, auxiliary variables). Order of the rows: stage after stage
the dynamics ``(xi_{k+1}, s_{k+1}) - (F, s_k)``, then the stage's other rows.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem
from tightspot.solvers.nlp import Nlp, Stage
from tightspot.solvers.separable import terms_of

Array = NDArray[np.float64]
Index = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class StageForm:
    """Symbols and dimensions of the rewritten program, and where its entries are in the original one.

    Attributes:
        x: Variables, SX, (n,).
        f: Objective.
        g: Rows, SX, (m,).
        nx: States of each stage, N + 1 numbers.
        nu: Controls and auxiliary variables of each stage.
        ng: Rows of each stage that are not dynamics.
        variables: The original's index of each variable, (n,); copies of shared variables have the same one.
        bounded: True where the original's bounds apply; false for all but the first copy of a shared variable, (n,).
        rows: The original's index of each row, (m,); -1 for ``s_{k+1} = s_k``.
        signs: -1 for dynamics, which have the opposite sign in the original, (m,).
        moved: Function of (x, p, lam_g), all the original's, giving what the multipliers of the original's dynamics
            rows have beyond those of the rewritten ones, (m_original,), because rows were moved; ``None`` if none was.
    """

    x: Any
    f: Any
    g: Any
    nx: tuple[int, ...]
    nu: tuple[int, ...]
    ng: tuple[int, ...]
    variables: Index
    bounded: NDArray[np.bool_]
    rows: Index
    signs: Array
    moved: Any | None

    def bounds(self, nlp: Nlp) -> dict[str, Array]:
        """``lbx``, ``ubx``, ``lbg``, ``ubg`` of the rewritten program."""
        own, flipped = self.rows >= 0, self.signs < 0
        lower, upper = (np.where(own, bound[self.rows], 0.0) for bound in (nlp.lbg, nlp.ubg))
        return {
            "lbx": np.where(self.bounded, nlp.lbx[self.variables], -np.inf),
            "ubx": np.where(self.bounded, nlp.ubx[self.variables], np.inf),
            "lbg": np.where(flipped, -upper, lower),
            "ubg": np.where(flipped, -lower, upper),
        }

    def solution(self, nlp: Nlp, x: Array, lam_x: Array, lam_g: Array) -> tuple[Array, Array, Array]:
        """The original's x, lam_x and lam_g of a point of the rewritten program."""
        original, bounds = nlp.x0.copy(), np.zeros(nlp.n_variables)
        original[self.variables[self.bounded]] = x[self.bounded]
        bounds[self.variables[self.bounded]] = lam_x[self.bounded]
        own = self.rows >= 0
        multipliers = np.zeros(nlp.n_rows)
        multipliers[self.rows[own]] = (self.signs * lam_g)[own]
        if self.moved is not None:
            multipliers = multipliers + np.array(self.moved(original, nlp.p0, multipliers), float).ravel()
        return original, bounds, multipliers


def stage_form(nlp: Nlp) -> StageForm:
    """Rewrite a program; one without stages becomes a single stage.

    Raises:
        InputError: Rows or terms of the objective touch stages that are not neighbours.
    """
    if not nlp.stages:
        n, m = nlp.n_variables, nlp.n_rows
        return StageForm(
            nlp.x, nlp.f, nlp.g, (0,), (n,), (m,), np.arange(n), np.ones(n, bool), np.arange(m), np.ones(m), None
        )  # fmt: skip
    return _Rewriter(nlp).form()


class _Rewriter:
    def __init__(self, nlp: Nlp) -> None:
        self.nlp = nlp
        self.shared = nlp.x[nlp.shared]
        self.copies = [ca.SX.sym(f"s{stage.k}", self.shared.numel()) for stage in nlp.stages]
        self.moves = _touches_the_stage_before(nlp)
        self.after = [nlp.x[after.state] + nlp.g[stage.dynamics] for stage, after in _neighbours(nlp)]

    def form(self) -> StageForm:
        nlp, last = self.nlp, len(self.nlp.stages) - 1
        x: list[Any] = []
        g: list[Any] = []
        nx, nu, ng = [], [], []
        variables: list[int] = []
        rows: list[int] = []
        for k, stage in enumerate(nlp.stages):
            hosted = self._hosted(k)
            auxiliary = hosted.auxiliary if hosted is not None else slice(0, 0)
            x += [nlp.x[stage.state], self.copies[k], nlp.x[stage.control], nlp.x[auxiliary]]
            variables += [*_range(stage.state), *_range(nlp.shared), *_range(stage.control), *_range(auxiliary)]
            nx.append(_size(stage.state) + _size(nlp.shared))
            nu.append(_size(stage.control) + _size(auxiliary))
            ng.append(_size(hosted.path) if hosted is not None else 0)
            if k < last:
                g += [nlp.x[nlp.stages[k + 1].state] - self._own(self.after[k], k), self.copies[k + 1] - self.copies[k]]
                rows += [*_range(stage.dynamics), *[-1] * _size(nlp.shared)]
            if hosted is not None:
                g.append(self._path(hosted, k))
                rows += _range(hosted.path)
        index = np.array(variables, dtype=np.intp)
        origin = np.array(rows, dtype=np.intp)
        dynamics = np.concatenate([np.zeros(0, int), *(_range(stage.dynamics) for stage in nlp.stages)])
        first = np.zeros(nlp.n_variables, np.intp)
        first[index[::-1]] = np.arange(index.size)[::-1]
        return StageForm(
            ca.vertcat(*x), self._objective(), ca.vertcat(*g), tuple(nx), tuple(nu), tuple(ng), index,
            first[index] == np.arange(index.size), origin, np.where(np.isin(origin, [*dynamics, -1]), -1.0, 1.0),
            self._moved() if self.moves else None,
        )  # fmt: skip

    def _hosted(self, k: int) -> Stage | None:
        """The stage whose path rows and auxiliary variables stand at stage k."""
        if not self.moves:
            return self.nlp.stages[k]
        return self.nlp.stages[k + 1] if k + 1 < len(self.nlp.stages) else None

    def _own(self, expression: Any, k: int) -> Any:
        """With the stage's own copy of the shared variables."""
        return ca.substitute(expression, self.shared, self.copies[k]) if _size(self.nlp.shared) else expression

    def _path(self, hosted: Stage, k: int) -> Any:
        rows = self.nlp.g[hosted.path]
        if self.moves:
            rows = ca.substitute(rows, self.nlp.x[hosted.state], self.after[k])
        return self._own(rows, k)

    def _objective(self) -> Any:
        """The objective with each term in its stage's copy of the shared variables."""
        owner: dict[int, int] = {}
        for k in range(len(self.nlp.stages)):
            hosted = self._hosted(k)
            places = [self.nlp.stages[k].state, self.nlp.stages[k].control]
            places += [] if hosted is None else [hosted.auxiliary]
            for place in places:
                owner |= {self.nlp.x[index].element_hash(): k for index in _range(place)}
        sums: dict[int, Any] = {}
        for term, stages in terms_of(self.nlp.f, owner):
            if len(stages) > 1:
                raise InputError(
                    Problem("nlp.f", f"a term of the objective couples stages {sorted(stages)}; use ipopt")
                )
            k = next(iter(stages), 0)
            sums[k] = sums.get(k, 0) + term
        return sum((self._own(total, k) for k, total in sums.items()), start=ca.SX(0))

    def _moved(self) -> Any:
        """``(d path_k / d xi_k)^T lam_path_k`` at the dynamics rows that lead to xi_k, see the class."""
        nlp = self.nlp
        lam = ca.SX.sym("lam", nlp.n_rows)
        total = ca.SX.zeros(nlp.n_rows)
        for stage, after in _neighbours(nlp):
            if _size(after.path):
                total[stage.dynamics] = ca.jtimes(nlp.g[after.path], nlp.x[after.state], lam[after.path], True)
        return ca.Function("moved", [nlp.x, nlp.p, lam], [total])


def _touches_the_stage_before(nlp: Nlp) -> bool:
    """Whether path rows touch the stage before.

    Raises:
        InputError: They touch another one.
    """
    pattern = ca.jacobian_sparsity(nlp.g, nlp.x)
    row, column = (np.array(values, dtype=np.intp) for values in pattern.get_triplet())
    row_stage, column_stage = np.full(nlp.n_rows, -1), np.full(nlp.n_variables, -1)
    for stage in nlp.stages:
        row_stage[stage.path] = stage.k
        for place in (stage.state, stage.control, stage.auxiliary):
            column_stage[place] = stage.k
    of_path = (row_stage[row] >= 0) & (column_stage[column] >= 0)
    back = (row_stage[row] - column_stage[column])[of_path]
    if not np.isin(back, (0, 1)).all():
        raise InputError(Problem("nlp.g", "rows couple stages that are not neighbours; use ipopt"))
    return bool((back == 1).any())


def _neighbours(nlp: Nlp) -> list[tuple[Stage, Stage]]:
    return list(zip(nlp.stages[:-1], nlp.stages[1:], strict=True))


def _range(place: slice) -> list[int]:
    return list(range(place.start, place.stop))


def _size(place: slice) -> int:
    return int(place.stop - place.start)
