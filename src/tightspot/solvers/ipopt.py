"""IPOPT with MUMPS, from CasADi's wheel: the reference backend, for any formulation and model."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import casadi as ca
import numpy as np

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
from tightspot.solvers.compiled import library, write_functions
from tightspot.solvers.functions import relative_stationarity, text_of, upheld
from tightspot.solvers.interrupts import Interrupts
from tightspot.solvers.nlp import Nlp
from tightspot.solvers.watcher import Watcher

_STATUS = {
    "Solve_Succeeded": SolveStatus.SOLVED,
    "Solved_To_Acceptable_Level": SolveStatus.ACCEPTABLE,
    "Infeasible_Problem_Detected": SolveStatus.INFEASIBLE,
    "Maximum_Iterations_Exceeded": SolveStatus.ITERATION_LIMIT,
    "Maximum_CpuTime_Exceeded": SolveStatus.TIME_LIMIT,
    "Maximum_WallTime_Exceeded": SolveStatus.TIME_LIMIT,
    "User_Requested_Stop": SolveStatus.STOPPED,
    "Diverging_Iterates": SolveStatus.DIVERGED,
    "Search_Direction_Becomes_Too_Small": SolveStatus.NUMERICAL,
    "Restoration_Failed": SolveStatus.INFEASIBLE,
    "Error_In_Step_Computation": SolveStatus.NUMERICAL,
    "Invalid_Number_Detected": SolveStatus.NUMERICAL,
}
_NOT_BEGUN = ("Not_Enough_Degrees_Of_Freedom", "Invalid_Problem_Definition", "Invalid_Option")
"""Words with which the count of iterations is still that of the solve before."""


@dataclass(frozen=True)
class Ipopt(Solver):
    """Primal-dual interior-point filter line-search method (Waechter and Biegler, 2006).

    The barrier strategy is adaptive in never-monotone mode: the best options found for this family of problems.

    A built solver is kept for the next program of the same symbols (see :mod:`tightspot.solvers.built`).

    Attributes:
        tolerance: IPOPT's ``tol``.
        max_iterations: Limit.
        time_limit: Wall-clock limit of one solve, s; looked at after each iteration. To derive the program's functions
            counts, too (seconds for a hundred intervals among twenty obstacles), but is not broken off: then the first
            iterate is the last. Compiling them does not count.
        compiled: Evaluate the functions in machine code that the user's C compiler makes of them, kept in the user's
            cache (see :mod:`tightspot.solvers.compiled`). Making it takes 10 to 100 s, once for a structure. Without
            a compiler they are evaluated by CasADi as usual, and the report's ``note`` says so.
        options: Further IPOPT options, by IPOPT's names; they override ours.
    """

    name: ClassVar[str] = "ipopt"
    tolerance: float = 1e-8
    max_iterations: int = 1000
    time_limit: float = 60.0
    compiled: bool = False
    options: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if problems := limit_problems(self):
            raise InputError(problems)

    def with_time_limit(self, seconds: float) -> Ipopt:
        return replace(self, time_limit=min(self.time_limit, max(seconds, 0.1)))

    def solve(
        self, nlp: Nlp, *, warm: WarmStart | None = None, callback: IterationCallback | None = None
    ) -> SolveReport:
        started = time.perf_counter()
        interrupts = Interrupts()
        options = self._ipopt_options(warm)
        key = self.name, self.compiled, repr(sorted(options.items(), key=str))
        with built(nlp, key, lambda: self._build(nlp, options)) as solver:
            ready = time.perf_counter()
            left = self.time_limit if self.compiled else max(self.time_limit - (ready - started), 0.0)
            solver.watcher.begin(nlp, callback, interrupts, left)
            with interrupts:
                result = solver.function(**_arguments(nlp, warm))
            interrupts.deliver()
            if solver.watcher.raised is not None:
                raise solver.watcher.raised
            timings = {"build": ready - started, "solve": time.perf_counter() - ready}
            return self._report(nlp, solver, result, timings)

    def _build(self, nlp: Nlp, ipopt: Mapping[str, Any]) -> _Built:
        watcher = Watcher(nlp)
        options = {
            "ipopt": dict(ipopt),
            "iteration_callback": watcher,
            "print_time": False,
            "error_on_fail": False,
            "show_eval_warnings": False,
        }
        symbols = {"x": nlp.x, "p": nlp.p, "f": nlp.f, "g": nlp.g}
        program: Mapping[str, Any] | Path = symbols
        note = ""
        if self.compiled:
            sizes = {"variables": nlp.n_variables, "rows": nlp.n_rows}

            def write_source(path: Path) -> None:
                write_functions(ca.nlpsol("nlp", "ipopt", symbols, {"ipopt": dict(ipopt)}), path)

            found = library(text_of(*symbols.values()), self.name, sizes, write_source)
            program, note = found.path or symbols, found.note
        return _Built(self._nlpsol(program, options), watcher, note)

    def _nlpsol(self, program: Mapping[str, Any] | Path, options: Mapping[str, Any]) -> Any:
        try:
            return ca.nlpsol("nlp", "ipopt", str(program) if isinstance(program, Path) else program, options)
        except RuntimeError as error:
            reason = str(error).strip().splitlines()[-1].split(": ", 1)[-1]
            raise InputError(Problem("solver.options", f"IPOPT refuses the options: {reason}")) from None

    def _ipopt_options(self, warm: WarmStart | None) -> dict[str, Any]:
        options: dict[str, Any] = {
            "print_level": 0,
            "sb": "yes",
            "tol": self.tolerance,
            "max_iter": self.max_iterations,
            "mu_strategy": "adaptive",
            "adaptive_mu_globalization": "never-monotone-mode",
            "bound_relax_factor": 0.0,
            # MUMPS' default scaling makes it run out of memory, again and again, where the steering has no effect
            # (v = 0), as in a straight-line guess.
            "mumps_scaling": 8,
        }
        if warm is not None and warm.lam_g is not None:
            options |= {
                "warm_start_init_point": "yes",
                "warm_start_bound_push": warm.push,
                "warm_start_slack_bound_push": warm.push,
                "warm_start_mult_bound_push": warm.push,
                "mu_init": max(1e-4, 10 * warm.push),
            }
        return options | dict(self.options)

    def _loosest(self) -> float:
        """The tolerance that IPOPT has reached when it speaks of success."""
        told = dict(self.options)
        return float(max(told.get("tol", self.tolerance), told.get("constr_viol_tol", 0.0)))

    def _report(self, nlp: Nlp, solver: _Built, result: Mapping[str, Any], timings: dict[str, float]) -> SolveReport:
        stats = solver.function.stats()
        x, g, lam_x, lam_g = (np.array(result[key], float).ravel() for key in ("x", "g", "lam_x", "lam_g"))
        functions = [value for key, value in stats.items() if key.startswith("t_wall_nlp_")]
        timings["functions"] = float(sum(functions))
        timings["callback"] = float(stats.get("t_wall_callback_fun", 0.0))
        worst, violation = nlp.worst(x, g)
        status = _STATUS.get(stats["return_status"], SolveStatus.FAILED)
        if status is SolveStatus.STOPPED and solver.watcher.late:
            status = SolveStatus.TIME_LIMIT
        if status.success and not upheld(np.array([float(result["f"]), *x, violation]), self._loosest()):
            status = SolveStatus.NUMERICAL
        return SolveReport(
            status=status,
            solver=self.name,
            x=x,
            objective=float(result["f"]),
            g=g,
            lam_x=lam_x,
            lam_g=lam_g,
            iterations=0 if stats["return_status"] in _NOT_BEGUN else int(stats["iter_count"]),
            violation=violation,
            stationarity=_stationarity(solver.function, nlp, x, lam_x, lam_g),
            worst=worst,
            timings=timings,
            backend_status=str(stats["return_status"]),
            note=solver.note,
        )


class _Built(NamedTuple):
    """What can be kept for programs of the same symbols."""

    function: Any
    watcher: Watcher
    note: str


def _arguments(nlp: Nlp, warm: WarmStart | None) -> dict[str, Any]:
    arguments: dict[str, Any] = {
        "x0": nlp.x0 if warm is None else warm.x,
        "p": nlp.p0,
        "lbx": nlp.lbx,
        "ubx": nlp.ubx,
        "lbg": nlp.lbg,
        "ubg": nlp.ubg,
    }
    if warm is not None and warm.lam_x is not None and warm.lam_g is not None:
        arguments |= {"lam_x0": warm.lam_x, "lam_g0": warm.lam_g}
    return arguments


def _stationarity(function: Any, nlp: Nlp, x: Array, lam_x: Array, lam_g: Array) -> float:
    """Largest absolute entry of ``grad f + J^T lam_g + lam_x`` at x, relative to ``max(1, max|lam|)``."""
    gradient = np.array(function.get_function("nlp_grad_f")(x, nlp.p0)[1]).ravel()
    if lam_g.size:
        jacobian = function.get_function("nlp_jac_g")(x, nlp.p0)[1]
        with np.errstate(invalid="ignore", over="ignore"):
            gradient = gradient + np.array(ca.mtimes(jacobian.T, lam_g)).ravel()
    return relative_stationarity(gradient, lam_x, lam_g)
