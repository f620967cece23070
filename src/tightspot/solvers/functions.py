"""Functions of a program that backends share."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from tightspot.solvers.built import built
from tightspot.solvers.nlp import Nlp

Array = NDArray[np.float64]

LOOSEST = 1e-6
"""Largest violation of what is called solved, unless looser tolerances are asked for."""


def text_of(*symbols: Any) -> str:
    """A program's symbols (x, p, f, g) written down: the same text for the same computation."""
    x, p, f, g = symbols
    return str(ca.Function("nlp", [x, p], [f, g]).serialize())


def values(nlp: Nlp, x: Array) -> tuple[float, Array]:
    """Objective and rows at x."""
    with built(nlp, "values", lambda: ca.Function("values", [nlp.x, nlp.p], [nlp.f, nlp.g])) as function:
        f, g = function(x, nlp.p0)
    return float(f), np.array(g, float).ravel()


def lagrangian_gradient(nlp: Nlp, x: Array, lam_g: Array) -> Array:
    """``grad f + J^T lam_g`` at x, (n,); without the bounds' multipliers."""

    def build() -> Any:
        multipliers = ca.SX.sym("lam", nlp.n_rows)
        lagrangian = nlp.f + (ca.dot(multipliers, nlp.g) if nlp.n_rows else 0)
        return ca.Function("gradient", [nlp.x, nlp.p, multipliers], [ca.gradient(lagrangian, nlp.x)])

    with built(nlp, "gradient", build) as function:
        return np.array(function(x, nlp.p0, lam_g), float).ravel()


def relative_stationarity(gradient: Array, lam_x: Array, lam_g: Array) -> float:
    """Largest entry of ``grad f + J^T lam_g + lam_x`` relative to ``max(1, max |lam_g|)``; may be NaN."""
    with np.errstate(invalid="ignore", over="ignore"):
        return float(np.abs(gradient + lam_x).max(initial=0.0) / max(1.0, np.abs(lam_g).max(initial=0.0)))


def upheld(facts: Array, tolerance: float) -> bool:
    """Whether a back end's word that it has solved a program may stand.

    Args:
        facts: J, the entries of x, and last the largest violation at x, all computed outside the back end.
        tolerance: What the back end was told to reach, by its own scaling of the rows.
    """
    return bool(np.isfinite(facts).all() and facts[-1] <= max(LOOSEST, 10 * tolerance))


def complementarity(nlp: Nlp, x: Array, g: Array, lam_x: Array, lam_g: Array) -> float:
    """Largest product of a multiplier and the distance to the bound that it belongs to, at x.

    A positive multiplier belongs to the upper bound, a negative one to the lower; without that bound the multiplier
    itself counts, which should be 0.
    """
    largest = 0.0
    for value, lower, upper, lam in ((x, nlp.lbx, nlp.ubx, lam_x), (g, nlp.lbg, nlp.ubg, lam_g)):
        distance = np.where(lam > 0, upper - value, value - lower)
        free = lower < upper
        products = np.abs(lam * np.where(np.isinf(distance), 1.0, distance))[free]
        largest = max(largest, float(products.max(initial=0.0)))
    return largest
