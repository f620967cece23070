"""Sequential quadratic programming: Uno's filter method with the active-set solver BQPD, from CasADi's wheel."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem
from tightspot.solvers.base import (
    Array,
    IterationCallback,
    Solver,
    SolveReport,
    SolveStatus,
    WarmStart,
    limit_problems,
)
from tightspot.solvers.built import built
from tightspot.solvers.functions import lagrangian_gradient, relative_stationarity, text_of, upheld, values
from tightspot.solvers.nlp import Nlp
from tightspot.solvers.remote import solve_elsewhere

_STATUS = {
    "Converged with feasible KKT point": SolveStatus.SOLVED,
    "Converged with feasible FJ point": SolveStatus.ACCEPTABLE,
    "Converged with infeasible stationary point": SolveStatus.INFEASIBLE,
    "Terminated with infeasible small step": SolveStatus.INFEASIBLE,
    "Terminated with feasible small step": SolveStatus.NUMERICAL,
    "Terminated with unbounded problem": SolveStatus.DIVERGED,
}
GRACE = 1.0
"""How long after its time limit Uno is stopped, s."""

_NUMERICAL = ("SOLVER_RET_NAN", "SOLVER_RET_EXCEPTION")


@dataclass(frozen=True)
class Sqp(Solver):
    """Trust-region filter SQP with exact Hessians: few iterations, each with a quadratic program.

    The best SQP method of CasADi's wheel on these programs, see ``benchmarks/results/sqp_solvers.md``. Variables whose
    bounds are equal (start and goal) are given to it as parameters. It runs in a process of its own, as it can hang and
    crash. It looks at the time limit between iterations; its process is stopped a second later.

    Attributes:
        tolerance: Of the constraints and of the Lagrangian's gradient.
        max_iterations: Limit.
        time_limit: Wall-clock limit of one solve, s.
        preset: Uno's: ``"filtersqp"``, ``"funnelsqp"``, ...
        options: Further Uno options, by Uno's names; they override ours. Uno ignores names that it does not know.

    References: C. Vanaret, S. Leyffer, Unifying nonlinearly constrained nonconvex optimization, arXiv 2406.13454;
    R. Fletcher, S. Leyffer, Nonlinear programming without a penalty function, Mathematical Programming 91 (2002).
    """

    name: ClassVar[str] = "sqp"
    tolerance: float = 1e-8
    max_iterations: int = 300
    time_limit: float = 60.0
    preset: str = "filtersqp"
    options: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if problems := limit_problems(self):
            raise InputError(problems)

    def with_time_limit(self, seconds: float) -> Sqp:
        return replace(self, time_limit=min(self.time_limit, max(seconds, 0.1)))

    def solve(
        self, nlp: Nlp, *, warm: WarmStart | None = None, callback: IterationCallback | None = None
    ) -> SolveReport:
        started = time.perf_counter()
        free = np.flatnonzero(nlp.lbx != nlp.ubx)
        start = (nlp.x0 if warm is None else warm.x).copy()
        start[nlp.lbx == nlp.ubx] = nlp.lbx[nlp.lbx == nlp.ubx]
        if not free.size:
            return _at(nlp, start, SolveStatus.FAILED, {"build": 0.0, "solve": 0.0}, "no variable is free to move")
        with built(nlp, (self.name, tuple(free)), lambda: _text(nlp, free)) as text:
            task = {
                "plugin": "uno",
                "key": f"uno {hashlib.sha256(text.encode()).hexdigest()} {self._options()}",
                "options": self._options(),
                "arguments": _arguments(nlp, free, start, warm),
            }
            ready = time.perf_counter()
            outcome = solve_elsewhere(task, text, None, callback, seconds=self.time_limit + GRACE)
        if outcome.status is SolveStatus.FAILED and outcome.refusal:
            raise InputError(
                Problem("solver.options", f"Uno refuses the options: {outcome.refusal.split(': ', 1)[-1]}")
            )
        timings = {"build": ready - started + outcome.build, "solve": outcome.solve, "functions": outcome.functions}
        if outcome.answer is None:
            status = outcome.status or SolveStatus.FAILED
            return _at(nlp, start, status, timings, outcome.word, iterations=outcome.iterations)
        return self._report(nlp, free, outcome.answer, timings)

    def _options(self) -> dict[str, Any]:
        """CasADi's and Uno's."""
        uno = {
            "preset": self.preset,
            "logger": "SILENT",
            "primal_tolerance": float(self.tolerance),  # Uno ignores numbers of another type
            "dual_tolerance": float(self.tolerance),
            "max_iterations": int(self.max_iterations),
            "time_limit": float(self.time_limit),
        }
        return {
            "uno": uno | dict(self.options),
            "print_time": False,
            "error_on_fail": False,
            "show_eval_warnings": False,
        }

    def _report(
        self, nlp: Nlp, free: NDArray[np.intp], answer: Mapping[str, Any], timings: dict[str, float]
    ) -> SolveReport:
        x, lam_x = nlp.lbx.copy(), np.zeros(nlp.n_variables)
        x[free], lam_x[free] = answer["x"], answer["lam_x"]
        lam_g = answer["lam_g"]
        objective, g = values(nlp, x)
        gradient = lagrangian_gradient(nlp, x, lam_g)
        fixed = nlp.lbx == nlp.ubx
        lam_x[fixed] = -gradient[fixed]
        worst, violation = nlp.worst(x, g)
        return SolveReport(
            status=self._status(answer, timings["solve"], np.array([objective, *x, violation])),
            solver=self.name,
            x=x,
            objective=objective,
            g=g,
            lam_x=lam_x,
            lam_g=lam_g,
            iterations=int(answer["iterations"]),
            violation=violation,
            stationarity=relative_stationarity(gradient, lam_x, lam_g),
            worst=worst,
            timings=timings,
            backend_status=answer["word"],
        )

    def _status(self, answer: Mapping[str, Any], seconds: float, facts: Array) -> SolveStatus:
        """Uno's word, and for "not optimal" the limit that ended it; no success where J, x or the violation says no."""
        status = _STATUS.get(answer["word"])
        if status is not None:
            return SolveStatus.NUMERICAL if status.success and not upheld(facts, self.tolerance) else status
        if answer["unified"] in _NUMERICAL:
            return SolveStatus.NUMERICAL
        if answer["iterations"] >= dict(self.options).get("max_iterations", self.max_iterations):
            return SolveStatus.ITERATION_LIMIT
        if seconds >= dict(self.options).get("time_limit", self.time_limit):
            return SolveStatus.TIME_LIMIT
        return SolveStatus.FAILED


def _text(nlp: Nlp, free: NDArray[np.intp]) -> str:
    """The program of the free variables; the others are the last parameters."""
    fixed = np.setdiff1d(np.arange(nlp.n_variables), free)
    variables = ca.vertcat(*(nlp.x[int(index)] for index in free))
    given = ca.vertcat(nlp.p, *(nlp.x[int(index)] for index in fixed))
    return text_of(variables, given, nlp.f, nlp.g)


def _at(
    nlp: Nlp, x: Array, status: SolveStatus, timings: dict[str, float], word: str, *, iterations: int = 0
) -> SolveReport:
    """The report of a solve without a last iterate: it stands at its starting point."""
    objective, rows = values(nlp, x)
    worst, violation = nlp.worst(x, rows)
    return SolveReport(
        status=status,
        solver=Sqp.name,
        x=x,
        objective=objective,
        g=rows,
        lam_x=np.zeros(x.size),
        lam_g=np.zeros(rows.size),
        iterations=iterations,
        violation=violation,
        stationarity=np.inf,
        worst=worst,
        timings=timings,
        backend_status=word,
    )


def _arguments(nlp: Nlp, free: NDArray[np.intp], start: Array, warm: WarmStart | None) -> dict[str, Any]:
    """The call's arguments, with the variables that cannot move among the parameters."""
    fixed = np.setdiff1d(np.arange(nlp.n_variables), free)
    arguments: dict[str, Any] = {
        "x0": start[free],
        "p": np.concatenate([nlp.p0, nlp.lbx[fixed]]),
        "lbx": nlp.lbx[free],
        "ubx": nlp.ubx[free],
        "lbg": nlp.lbg,
        "ubg": nlp.ubg,
    }
    if warm is not None and warm.lam_x is not None and warm.lam_g is not None:
        arguments |= {"lam_x0": warm.lam_x[free], "lam_g0": warm.lam_g}
    return arguments
