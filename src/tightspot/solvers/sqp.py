"""Sequential quadratic programming: Uno's filter method with the active-set solver BQPD, from CasADi's wheel."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem
from tightspot.solvers.base import Array, IterationCallback, Solver, SolveReport, SolveStatus, WarmStart
from tightspot.solvers.functions import lagrangian_gradient
from tightspot.solvers.interrupts import Interrupts
from tightspot.solvers.nlp import Nlp
from tightspot.solvers.watcher import Watcher

_STATUS = {
    "Converged with feasible KKT point": SolveStatus.SOLVED,
    "Converged with feasible FJ point": SolveStatus.ACCEPTABLE,
    "Converged with infeasible stationary point": SolveStatus.INFEASIBLE,
    "Terminated with infeasible small step": SolveStatus.INFEASIBLE,
    "Terminated with feasible small step": SolveStatus.NUMERICAL,
    "Terminated with unbounded problem": SolveStatus.DIVERGED,
}
_NUMERICAL = ("SOLVER_RET_NAN", "SOLVER_RET_EXCEPTION")


@dataclass(frozen=True)
class Sqp(Solver):
    """Trust-region filter SQP with exact Hessians: few iterations, each with a quadratic program.

    The best SQP method of CasADi's wheel on these programs, see ``benchmarks/results/sqp_solvers.md``. Variables whose
    bounds are equal (start and goal) are given to it as parameters. A time limit is looked at between iterations, so
    that a solve ends one quadratic program late.

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

    def with_time_limit(self, seconds: float) -> Sqp:
        return replace(self, time_limit=min(self.time_limit, max(seconds, 0.1)))

    def solve(
        self, nlp: Nlp, *, warm: WarmStart | None = None, callback: IterationCallback | None = None
    ) -> SolveReport:
        started = time.perf_counter()
        interrupts = Interrupts()
        free = np.flatnonzero(nlp.lbx != nlp.ubx)
        watcher = Watcher(nlp, free.size)
        watcher.begin(nlp, callback, interrupts)
        function = self._function(nlp, free, watcher)
        built = time.perf_counter()
        arguments = _arguments(nlp, free, warm)
        result, complaint = None, ""
        with interrupts:
            try:
                result = function(**arguments)
            except RuntimeError as error:  # Uno gives up on some iterates by an exception
                complaint = str(error).strip().splitlines()[-1]
        interrupts.deliver()
        if watcher.raised is not None:
            raise watcher.raised
        timings = {"build": built - started, "solve": time.perf_counter() - built}
        if result is None:
            return _broken(nlp, nlp.x0 if warm is None else warm.x, timings, complaint)
        return self._report(nlp, free, function, result, timings, stopped=watcher.stopped)

    def _function(self, nlp: Nlp, free: NDArray[np.intp], watcher: Watcher) -> Any:
        fixed = np.setdiff1d(np.arange(nlp.n_variables), free)
        variables = ca.vertcat(*(nlp.x[int(index)] for index in free))
        given = ca.vertcat(nlp.p, *(nlp.x[int(index)] for index in fixed))
        options: dict[str, Any] = {
            "uno": {
                "preset": self.preset,
                "logger": "SILENT",
                "primal_tolerance": self.tolerance,
                "dual_tolerance": self.tolerance,
                "max_iterations": self.max_iterations,
                "time_limit": self.time_limit,
            }
            | dict(self.options),
            "iteration_callback": watcher,
            "print_time": False,
            "error_on_fail": False,
            "show_eval_warnings": False,
        }
        try:
            return ca.nlpsol("nlp", "uno", {"x": variables, "p": given, "f": nlp.f, "g": nlp.g}, options)
        except RuntimeError as error:
            reason = str(error).strip().splitlines()[-1].split(": ", 1)[-1]
            raise InputError(Problem("solver.options", f"Uno refuses the options: {reason}")) from None

    def _report(
        self,
        nlp: Nlp,
        free: NDArray[np.intp],
        function: Any,
        result: Mapping[str, Any],
        timings: dict[str, float],
        *,
        stopped: bool,
    ) -> SolveReport:
        stats = function.stats()
        x = nlp.lbx.copy()
        x[free] = np.array(result["x"]).ravel()
        g, lam_g = (np.array(result[key], float).ravel() for key in ("g", "lam_g"))
        lam_x = np.zeros(x.size)
        lam_x[free] = np.array(result["lam_x"]).ravel()
        gradient = lagrangian_gradient(nlp, x, lam_g)
        fixed = nlp.lbx == nlp.ubx
        lam_x[fixed] = -gradient[fixed]
        timings["functions"] = float(sum(value for key, value in stats.items() if key.startswith("t_wall_")))
        worst, violation = nlp.worst(x, g)
        return SolveReport(
            status=self._status(stats, timings["solve"], stopped=stopped),
            solver=self.name,
            x=x,
            objective=float(result["f"]),
            g=g,
            lam_x=lam_x,
            lam_g=lam_g,
            iterations=int(stats["iter_count"]),
            violation=violation,
            stationarity=float(np.abs(gradient + lam_x).max() / max(1.0, np.abs(lam_g).max(initial=0.0))),
            worst=worst,
            timings=timings,
            backend_status=str(stats["return_status"]),
        )

    def _status(self, stats: Mapping[str, Any], seconds: float, *, stopped: bool) -> SolveStatus:
        """Uno's word, and for "not optimal" the limit that ended it."""
        word = str(stats["return_status"])
        if word in _STATUS:
            return _STATUS[word]
        if stopped:
            return SolveStatus.STOPPED
        if stats["unified_return_status"] in _NUMERICAL:
            return SolveStatus.NUMERICAL
        if stats["iter_count"] >= dict(self.options).get("max_iterations", self.max_iterations):
            return SolveStatus.ITERATION_LIMIT
        if seconds >= dict(self.options).get("time_limit", self.time_limit):
            return SolveStatus.TIME_LIMIT
        return SolveStatus.FAILED


def _broken(nlp: Nlp, x: Array, timings: dict[str, float], complaint: str) -> SolveReport:
    """The report of a solve that Uno broke off without a last iterate: it stands at its starting point."""
    f, g = ca.Function("start", [nlp.x, nlp.p], [nlp.f, nlp.g])(x, nlp.p0)
    rows = np.array(g, float).ravel()
    worst, violation = nlp.worst(x, rows)
    return SolveReport(
        status=SolveStatus.NUMERICAL,
        solver=Sqp.name,
        x=x,
        objective=float(f),
        g=rows,
        lam_x=np.zeros(x.size),
        lam_g=np.zeros(rows.size),
        iterations=0,
        violation=violation,
        stationarity=np.inf,
        worst=worst,
        timings=timings,
        backend_status=complaint,
    )


def _arguments(nlp: Nlp, free: NDArray[np.intp], warm: WarmStart | None) -> dict[str, Any]:
    """The call's arguments, with the variables that cannot move among the parameters."""
    fixed = np.setdiff1d(np.arange(nlp.n_variables), free)
    arguments: dict[str, Any] = {
        "x0": (nlp.x0 if warm is None else warm.x)[free],
        "p": np.concatenate([nlp.p0, nlp.lbx[fixed]]),
        "lbx": nlp.lbx[free],
        "ubx": nlp.ubx[free],
        "lbg": nlp.lbg,
        "ubg": nlp.ubg,
    }
    if warm is not None and warm.lam_x is not None and warm.lam_g is not None:
        arguments |= {"lam_x0": warm.lam_x[free], "lam_g0": warm.lam_g}
    return arguments
