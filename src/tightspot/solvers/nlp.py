"""A nonlinear program with the structure that its builder knew.

``minimise f(x, p) subject to lbx <= x <= ubx, lbg <= g(x, p) <= ubg``. Solvers know nothing of cars: they see
symbols, bounds, and which variables and rows belong to which stage of the horizon.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RowBlock:
    """Consecutive rows of g that mean one thing.

    Attributes:
        rows: Slice into g.
        kind: ``"dynamics"``, ``"workspace"``, ``"separation"``, ``"start"``, ``"goal"``, ...
        knot: The knot, or the interval's last knot, at which the rows hold.
        detail: What they are about, for people: "body / wall/0".
        key: What they are about, for programs: the same numbers mean the same rows at another knot.
    """

    rows: slice
    kind: str
    knot: int
    detail: str = ""
    key: tuple[int, ...] = ()

    def describe(self) -> str:
        """For example ``separation of body / wall/0 at knot 12``."""
        about = f" of {self.detail}" if self.detail else ""
        return f"{self.kind}{about} at knot {self.knot}"


@dataclass(frozen=True)
class Stage:
    """Where stage k's variables and rows are.

    Attributes:
        k: Knot number, 0 to N.
        state: Slice of the state xi_k in x.
        control: Slice of u_k in x; empty at the last knot.
        auxiliary: Slice of the stage's auxiliary variables in x, all pairs.
        dynamics: Slice of the rows ``F(xi_k, u_k) - xi_{k+1}`` in g; empty at the last knot.
        path: Slice of the stage's other rows in g.
    """

    k: int
    state: slice
    control: slice
    auxiliary: slice
    dynamics: slice
    path: slice


@dataclass(frozen=True, eq=False)
class Nlp:
    """Symbols, bounds, a starting point and stage structure.

    Attributes:
        x: Variables, CasADi SX, shape (n, 1), ordered stage after stage, global ones (t_f) last.
        p: Parameters, SX, shape (n_p, 1).
        f: Objective, SX scalar.
        g: Constraint rows, SX, shape (m, 1).
        lbx: Lower bounds of x, (n,).
        ubx: Upper bounds of x, (n,).
        lbg: Lower bounds of g, (m,); equal to ``ubg`` for equations.
        ubg: Upper bounds of g, (m,).
        x0: Starting point, (n,).
        p0: Parameter values, (n_p,).
        stages: One :class:`Stage` a knot.
        blocks: What each row means.
        shared: Slice of the variables that belong to no stage (t_f).

    Raises:
        InputError: If a bound or a value does not fit its symbols, or a lower bound exceeds its upper bound.
    """

    x: Any
    p: Any
    f: Any
    g: Any
    lbx: Array
    ubx: Array
    lbg: Array
    ubg: Array
    x0: Array
    p0: Array
    stages: tuple[Stage, ...]
    blocks: tuple[RowBlock, ...]
    shared: slice = field(default_factory=lambda: slice(0, 0))

    def __post_init__(self) -> None:
        problems = []
        for symbol, fields in (("x", ("lbx", "ubx", "x0")), ("g", ("lbg", "ubg")), ("p", ("p0",))):
            count = getattr(self, symbol).numel()
            for name in fields:
                if getattr(self, name).shape != (count,):
                    sentence = f"has shape {getattr(self, name).shape}, but {symbol} has {count} entries"
                    problems.append(Problem(f"nlp.{name}", sentence))
        if problems:
            raise InputError(problems)
        for lower, upper in (("lbx", "ubx"), ("lbg", "ubg")):
            low, high = getattr(self, lower), getattr(self, upper)
            for i in np.flatnonzero(~((low <= high) & (low < np.inf) & (high > -np.inf)))[:10]:
                sentence = f"{low[i]} must be at most {upper} = {high[i]} and leave room for a finite number"
                problems.append(Problem(f"nlp.{lower}[{i}]", sentence))
        if problems:
            raise InputError(problems)

    @property
    def n_variables(self) -> int:
        """Number of variables (the paper's VN)."""
        return self.lbx.size

    @property
    def n_rows(self) -> int:
        """Number of rows of g, bounds on variables not counted."""
        return self.lbg.size

    @property
    def equality(self) -> NDArray[np.bool_]:
        """True for the rows that are equations, (m,)."""
        return np.asarray(self.lbg == self.ubg)

    def violation(self, g: Array) -> Array:
        """How far each row is outside its bounds, (m,), 0 inside."""
        return _outside(g, self.lbg, self.ubg)

    def worst_row(self, g: Array) -> tuple[RowBlock | None, float]:
        """The block with the largest violation, and that violation."""
        if g.size == 0:
            return None, 0.0
        violation = np.nan_to_num(self.violation(g), nan=np.inf)
        row = int(np.argmax(violation))
        return self.block_of(row), float(violation[row])

    def worst(self, x: Array, g: Array) -> tuple[str, float]:
        """What the most violated row is about ("" without rows), and the largest violation of a row or bound."""
        block, violation = self.worst_row(g)
        outside = np.nan_to_num(_outside(x, self.lbx, self.ubx), nan=np.inf)
        return block.describe() if block else "", max(violation, float(outside.max(initial=0.0)))

    def block_of(self, row: int) -> RowBlock | None:
        """The block that holds a row of g."""
        return next((block for block in self.blocks if block.rows.start <= row < block.rows.stop), None)


def _outside(values: Array, low: Array, high: Array) -> Array:
    """How far each value is outside its bounds; infinite ones may give NaN."""
    with np.errstate(invalid="ignore", over="ignore"):
        return np.asarray(np.maximum(0.0, np.maximum(low - values, values - high)))


def concatenate(parts: Sequence[Array]) -> Array:
    """``np.concatenate`` that gives an empty float array for no parts."""
    return np.concatenate([np.zeros(0), *parts])
