"""fatrop: an interior-point method that exploits the stages, from CasADi's wheel, for models that are not compiled in.

It has no time limit and cannot be interrupted. So it runs in a process of its own, which is stopped when the time is
up, at Ctrl-C, or when the callback says so; a crash or a hang there is a status here.
"""

from __future__ import annotations

import hashlib
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
from tightspot.solvers.functions import complementarity, lagrangian_gradient, relative_stationarity, text_of, values
from tightspot.solvers.nlp import Nlp
from tightspot.solvers.remote import Outcome, solve_elsewhere
from tightspot.solvers.stage_form import StageForm, stage_form

TOO_MANY_EQUATIONS = "number_of_eq_constraints"
"""In what fatrop says of a stage with more equations than it can hold."""

LOOSEST = 1e-6
"""Violation, stationarity and complementarity, the latter two relative to the largest multiplier, of a solution."""


@dataclass(frozen=True)
class Fatrop(Solver):
    """Primal-dual interior-point method with a stagewise factorisation.

    It takes any :class:`Nlp` whose rows couple neighbouring stages only. Use formulations without null directions:
    from the lines with a unit normal it converges, with a normal of free length and with the duals mostly not.

    Attributes:
        tolerance: fatrop's ``tol``.
        max_iterations: Limit.
        time_limit: Wall-clock limit of one solve, s; writing the stages and fatrop's own set-up count, compiling does
            not.
        compiled: As in :class:`tightspot.solvers.Ipopt`.
        options: Further fatrop options, by fatrop's names; they override ours.

    Reference: L. Vanroye, A. Sathya, J. De Schutter, W. Decre, FATROP: a fast constrained optimal control problem
    solver for robot trajectory optimization and control, IROS 2023.
    """

    name: ClassVar[str] = "fatrop"
    tolerance: float = 1e-8
    max_iterations: int = 500
    time_limit: float = 60.0
    compiled: bool = False
    options: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if problems := limit_problems(self):
            raise InputError(problems)

    def with_time_limit(self, seconds: float) -> Fatrop:
        return replace(self, time_limit=min(self.time_limit, max(seconds, 0.1)))

    def solve(
        self, nlp: Nlp, *, warm: WarmStart | None = None, callback: IterationCallback | None = None
    ) -> SolveReport:
        """As all backends do; of ``warm`` only the point is used.

        Raises:
            InputError: Rows or terms of the objective couple stages that are not neighbours, or fatrop refuses an
                option.
            KeyboardInterrupt: If the user interrupts.
        """
        started = time.perf_counter()
        start = nlp.x0 if warm is None else warm.x
        with built(nlp, (self.name, self.compiled), lambda: self._program(nlp)) as program:
            ready = time.perf_counter()
            deadline = (ready if self.compiled else started) + self.time_limit
            outcome = self._outcome(nlp, program, start, callback, deadline)
            timings = {"build": ready - started + outcome.build, "solve": outcome.solve, "functions": outcome.functions}
            return self._report(nlp, program, start, outcome, timings)

    def _program(self, nlp: Nlp) -> _Program:
        form = stage_form(nlp)
        text, path, note = text_of(form.x, nlp.p, form.f, form.g), None, ""
        if self.compiled:
            sizes = {"variables": form.x.numel(), "rows": form.g.numel()}

            def write_source(path: Path) -> None:
                symbols = {"x": form.x, "p": nlp.p, "f": form.f, "g": form.g}
                write_functions(ca.nlpsol("nlp", "fatrop", symbols, _structure(form)), path)

            found = library(text, self.name, sizes, write_source)
            path, note = found.path, found.note
        key = hashlib.sha256(f"{path} {text}".encode()).hexdigest()
        return _Program(form, text, None if path is None else str(path), key, note)

    def _outcome(
        self, nlp: Nlp, program: _Program, start: Array, callback: IterationCallback | None, deadline: float
    ) -> Outcome:
        """What comes of the program in the other process."""
        form = program.form
        bounds = form.bounds(nlp)
        fatrop = {"print_level": 10, "tol": self.tolerance, "max_iter": self.max_iterations} | dict(self.options)
        options = {**_structure(form), "equality": (bounds["lbg"] == bounds["ubg"]).tolist(), "fatrop": fatrop}
        task = {
            "plugin": "fatrop",
            "key": f"fatrop {program.key} {options}",
            "options": options,
            "arguments": {"x0": start[form.variables], "p": nlp.p0, **bounds},
        }
        outcome = solve_elsewhere(task, program.text, program.library, callback, deadline=deadline)
        if outcome.refusal and TOO_MANY_EQUATIONS not in outcome.refusal:
            raise InputError(Problem("solver.options", f"fatrop refuses: {outcome.refusal.split(': ', 1)[-1]}"))
        return outcome

    def _report(
        self, nlp: Nlp, program: _Program, start: Array, outcome: Outcome, timings: dict[str, float]
    ) -> SolveReport:
        x, lam_x, lam_g = start, np.zeros(nlp.n_variables), np.zeros(nlp.n_rows)
        if outcome.answer is not None:
            x, lam_x, lam_g = program.form.solution(nlp, *(outcome.answer[name] for name in ("x", "lam_x", "lam_g")))
        objective, g = values(nlp, x)
        worst, violation = nlp.worst(x, g)
        scale = max(1.0, np.abs(lam_g).max(initial=0.0))
        stationarity = relative_stationarity(lagrangian_gradient(nlp, x, lam_g), lam_x, lam_g)
        status = outcome.status
        if status is None:
            with np.errstate(invalid="ignore"):
                residuals = [violation, stationarity, complementarity(nlp, x, g, lam_x, lam_g) / scale]
            status = self._status(outcome.answer or {}, np.array([objective, *residuals]))
        return SolveReport(
            status=status,
            solver=self.name,
            x=x,
            objective=objective,
            g=g,
            lam_x=lam_x,
            lam_g=lam_g,
            iterations=min(outcome.answer["iterations"] if outcome.answer else outcome.iterations, self._limit()),
            violation=violation,
            stationarity=stationarity,
            worst=worst,
            timings=timings,
            backend_status=f"return flag {outcome.word}" if outcome.answer else outcome.word,
            note=program.note,
        )

    def _status(self, answer: Mapping[str, Any], facts: Array) -> SolveStatus:
        """What objective, violation, stationarity and complementarity, looked at from outside, say of fatrop's word.

        Close to the solution it often stops without saying success, as steps become too small to tell progress.
        """
        if not np.isfinite(facts).all():
            return SolveStatus.NUMERICAL
        if (facts[1:] <= LOOSEST).all():
            return SolveStatus.SOLVED if answer["success"] else SolveStatus.ACCEPTABLE
        if answer["success"]:
            return SolveStatus.NUMERICAL
        return SolveStatus.ITERATION_LIMIT if answer["iterations"] >= self._limit() else SolveStatus.FAILED

    def _limit(self) -> int:
        """Of iterations; fatrop counts the one that it does not make, too."""
        return int(dict(self.options).get("max_iter", self.max_iterations))


class _Program(NamedTuple):
    """What is kept for programs of the same symbols."""

    form: StageForm
    text: str
    library: str | None
    key: str
    note: str


def _structure(form: StageForm) -> dict[str, Any]:
    """CasADi's options: what the stages are."""
    return {
        "structure_detection": "manual",
        "N": len(form.nx) - 1,
        "nx": list(form.nx),
        "nu": list(form.nu),
        "ng": list(form.ng),
        "print_time": False,
        "error_on_fail": False,
        "show_eval_warnings": False,
    }
