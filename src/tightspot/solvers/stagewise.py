"""Our structure-exploiting interior-point solver, compiled: the Python face."""

from __future__ import annotations

import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from tightspot.errors import InputError, Problem, is_number, shown
from tightspot.solvers import knots_first
from tightspot.solvers.base import (
    Iteration,
    IterationCallback,
    Solver,
    SolveReport,
    SolveStatus,
    WarmStart,
    asks_to_stop,
    limit_problems,
)
from tightspot.solvers.nlp import Nlp
from tightspot.solvers.stage_batch import AT_ONCE, check_batch, solve_together
from tightspot.solvers.stage_core import compiled, core_solver, move_ends, set_start
from tightspot.solvers.stage_order import CorePoint
from tightspot.solvers.stage_problem import StageProblem
from tightspot.solvers.stage_report import ROUNDING, Attempt, StagePoint, StageReport

_STATUS = {
    "solved": SolveStatus.SOLVED,
    "acceptable": SolveStatus.ACCEPTABLE,
    "infeasible": SolveStatus.INFEASIBLE,
    "iteration_limit": SolveStatus.ITERATION_LIMIT,
    "time_limit": SolveStatus.TIME_LIMIT,
    "stopped": SolveStatus.STOPPED,
    "diverged": SolveStatus.DIVERGED,
    "numerical": SolveStatus.NUMERICAL,
}
_TRY_AGAIN = (
    SolveStatus.INFEASIBLE,
    SolveStatus.NUMERICAL,
    SolveStatus.DIVERGED,
    SolveStatus.ITERATION_LIMIT,
)
WARM_PUSH = 1e-5
"""How far a warm start is moved away from bounds that it is at."""
WARM_BARRIER = 1e-7
"""mu_0 of a warm start: multipliers and slacks of an earlier solution fit one another as they are."""
WARM_ITERATIONS = 50
"""A warm start that takes longer was a bad one."""


@dataclass(frozen=True)
class Stagewise(Solver):
    """Primal-dual interior-point method that eliminates each line by itself and sweeps over the stages.

    See docs/stagewise-solver.md. It takes a :class:`StageProblem`, not an :class:`Nlp`. Deterministic; releases the
    GIL; allocates nothing after set-up.

    Attributes:
        tolerance: Of violation, and of stationarity and complementarity scaled as IPOPT does.
        max_iterations: Limit.
        time_limit: Wall-clock limit of one solve, s.
        initial_barrier: mu_0; ``None``: chosen from the objective at the start, or :data:`WARM_BARRIER` where a solve
            begins with an earlier solution.
        slack_push: Least slack of a row where a solve begins, m; ``None``: the core's, 0.01. With more, a start that
            violates rows by about as much can move without running into them at once.
        knots_first: Problems with rows between the knots are solved loosely with those at the knots alone at first
            (see :mod:`tightspot.solvers.knots_first`), unless ``initial_barrier`` says that the start is a good one.
            If that leads nowhere, the solve begins at the given start. Iterations and times are those of all together.
        robust: When the solve from the given start comes to nothing, try the ways of
            :mod:`tightspot.solvers.rough_starts`. All together keep to the limits on iterations and time.
    """

    name: ClassVar[str] = "stagewise"
    tolerance: float = 1e-8
    max_iterations: int = 1000
    time_limit: float = 10.0
    initial_barrier: float | None = None
    slack_push: float | None = None
    knots_first: bool = True
    robust: bool = True

    def __post_init__(self) -> None:
        problems = limit_problems(self)
        for name in ("initial_barrier", "slack_push"):
            value = getattr(self, name)
            if value is not None and not (is_number(value) and 0 < value < np.inf):
                problems.append(Problem(f"solver.{name}", f"{shown(value)} must be positive and finite"))
        if problems:
            raise InputError(problems)

    def with_time_limit(self, seconds: float) -> Stagewise:
        return self.with_options(time_limit=min(self.time_limit, max(seconds, 1e-3)))

    def with_options(self, **options: Any) -> Stagewise:
        """With other options, which nobody looks at; :func:`dataclasses.replace` is for those that may not do."""
        other = object.__new__(type(self))
        other.__dict__.update(self.__dict__, **options)
        return other

    def solve(
        self, nlp: Nlp, *, warm: WarmStart | None = None, callback: IterationCallback | None = None
    ) -> SolveReport:
        """Not possible: an Nlp is symbols, this solver takes arrays.

        Raises:
            InputError: Always.
        """
        raise InputError(Problem("solver", "stagewise solves a StageProblem, not an Nlp; use solve_stages, or ipopt"))

    def solve_stages(
        self,
        problem: StageProblem,
        *,
        warm: StagePoint | None = None,
        callback: IterationCallback | None = None,
        core: Any = None,
    ) -> StageReport:
        """Solve from the problem's own start, or from a point of an earlier solve of the same structure.

        Args:
            problem: From :func:`tightspot.transcription.stage_problem`.
            warm: :attr:`StageReport.point` of a problem with as many intervals, pairs and rows.
            callback: Called after each iteration; return ``False`` to stop. Without one, the core itself asks for
                Ctrl-C now and then.
            core: The :func:`core_solver` of a problem that differs from this one in its starting point and in the
                values of start and goal alone. It spares the set-up, and serves one thread at a time.

        Returns:
            A report whatever happens: a failed solve is a status, not an exception. Where the warm start comes to
            nothing, ``robust`` goes on from the problem's own start.

        Raises:
            InputError: An array does not fit the others.
        """
        if warm is not None:
            return self._warm(problem, warm, callback, core)
        begun = self._from_knots(problem, callback) if core is None and self._begins_at_knots(problem) else None
        return self._from_given(problem, begun, callback, core)

    def _from_given(
        self, problem: StageProblem, begun: StageReport | None, callback: IterationCallback | None, core: Any = None
    ) -> StageReport:
        """What was begun at the knots if that is the end of it, or from the given start with what is left."""
        if begun is None:
            return self._gone_on(problem, self._first()._once(problem, None, callback, core=core), callback)
        left = self.max_iterations - begun.iterations
        if begun.status not in _TRY_AGAIN or left < 1:
            return begun
        limited = self.with_options(max_iterations=left).with_time_limit(self.time_limit - begun.timings["solve"])
        return self._gone_on(problem, limited._first()._once(problem, None, callback).after(begun), callback)

    def _begins_at_knots(self, problem: StageProblem) -> bool:
        chosen = self.knots_first and self.initial_barrier is None and self.max_iterations >= knots_first.SHARE
        return chosen and knots_first.has_rows_between(problem)

    def _at_knots(self) -> Stagewise:
        tolerance, most = max(self.tolerance, knots_first.TOLERANCE), self.max_iterations // knots_first.SHARE
        return self.with_options(tolerance=tolerance, max_iterations=most)

    def _from_knots(self, problem: StageProblem, callback: IterationCallback | None) -> StageReport:
        """From the given start with the rows at the knots alone, then with all; or the former if it failed."""
        loose = self._at_knots()._once(knots_first.at_knots(problem), None, callback)
        if not _leads_on(loose):
            return _at_the_knots(loose, problem)
        near = self._near().with_time_limit(self.time_limit - loose.timings["solve"])
        watch = _stop if loose.status is SolveStatus.STOPPED else callback
        return _led_on(near._once(_begun_at(problem, loose), None, watch), loose, problem)

    def _near(self) -> Stagewise:
        """For a start that satisfies the rows at the knots."""
        most = self.max_iterations - self.max_iterations // knots_first.SHARE
        most = min(most, 2 * self.max_iterations // 5) if self.robust else most
        slack = knots_first.SLACK if self.slack_push is None else self.slack_push
        return self.with_options(max_iterations=most, initial_barrier=knots_first.BARRIER, slack_push=slack)

    def _first(self) -> Stagewise:
        """For the first start: other ones are to have their turn, too."""
        return self.with_options(max_iterations=2 * self.max_iterations // 5) if self.robust else self

    def _warm(
        self, problem: StageProblem, warm: StagePoint, callback: IterationCallback | None, core: Any
    ) -> StageReport:
        quick = self.with_options(max_iterations=min(self.max_iterations, WARM_ITERATIONS)) if self.robust else self
        report = quick._once(problem, warm, callback, core=core)
        if not self.robust or report.status not in _TRY_AGAIN:
            return report
        left = self.max_iterations - report.iterations
        seconds = max(self.time_limit - report.timings["solve"], 1e-3)
        cold = self.with_options(max_iterations=left, time_limit=seconds).solve_stages(problem, callback=callback)
        note = "Not solved from the earlier solution, but from the given start."
        return replace(
            cold,
            iterations=report.iterations + cold.iterations,
            attempts=report.attempts + cold.attempts,
            timings={name: report.timings[name] + cold.timings[name] for name in ("build", "solve")},
            note=cold.note or (note if cold.status.success else ""),
        )

    def _gone_on(self, problem: StageProblem, report: StageReport, callback: IterationCallback | None) -> StageReport:
        """The report of the given start, or that of another one if ``robust`` asks for it."""
        if not self.robust or report.status not in _TRY_AGAIN:
            return report
        with np.errstate(all="ignore"):
            return self._from_other_starts(problem, report, callback)

    def _from_other_starts(
        self, problem: StageProblem, failed: StageReport, callback: IterationCallback | None
    ) -> StageReport:
        from tightspot.solvers.other_starts import from_other_starts

        def once(start: StageProblem, original: StageProblem | None, iterations: int, seconds: float) -> StageReport:
            limited = self.with_options(time_limit=seconds, max_iterations=iterations)
            return limited._once(start, None, callback, original=original)

        return from_other_starts(problem, failed, once, self.max_iterations, self.time_limit)

    def _once(
        self,
        problem: StageProblem,
        warm: StagePoint | None,
        callback: IterationCallback | None,
        original: StageProblem | None = None,
        core: Any = None,
    ) -> StageReport:
        """One solve from one start; the report is in the order of ``original``, the problem with its own lines."""
        started = time.perf_counter()
        if core is None:
            core = core_solver(problem)
        else:
            move_ends(core, problem)
        options = self.options(warm=warm is not None)
        set_start(core, problem, warm)
        built = time.perf_counter()
        watch = None
        if callback is not None:
            given = callback

            def watch(number: int, objective: float, violation: float) -> bool:
                return not asks_to_stop(given(Iteration(number, objective, violation)))

        answer = core.solve(options, watch)
        timings = {"build": built - started, "solve": answer["seconds"]}
        with np.errstate(invalid="ignore", over="ignore"):
            if original is not None:
                answer["v"] = original.variables(*problem.unpack(answer["v"]))
            return self._report(original or problem, answer, timings, "given" if warm is None else "warm")

    def solve_many(
        self, problems: Sequence[StageProblem], *, threads: int = 1, time_limit: float | None = None
    ) -> list[StageReport]:
        """As :func:`tightspot.solvers.solve_many`, with this solver."""
        check_batch(problems, threads, time_limit)
        until = np.inf if time_limit is None else time.perf_counter() + time_limit
        reports: list[tuple[StageProblem, StageReport, bool]] = []
        for at in range(0, len(problems), AT_ONCE * threads):
            reports += self._begun_together(problems[at : at + AT_ONCE * threads], threads, until)

        def gone_on(problem: StageProblem, report: StageReport, from_knots: bool) -> StageReport:
            left = until - time.perf_counter()
            limited = self.with_time_limit(left)
            if from_knots:
                return limited._from_given(problem, report, None)
            return report if report.problem is None or left <= 0 else limited._gone_on(problem, report, None)

        if threads == 1:
            return [gone_on(*begun) for begun in reports]
        with ThreadPoolExecutor(threads) as pool:
            return list(pool.map(lambda begun: gone_on(*begun), reports))

    def _begun_together(
        self, problems: Sequence[StageProblem], threads: int, until: float
    ) -> list[tuple[StageProblem, StageReport, bool]]:
        """As :meth:`solve_stages` begins each: with its report, and whether it began at the knots."""
        chosen = [self._begins_at_knots(problem) for problem in problems]
        plain = iter(self._first()._together(_where(problems, chosen, False), threads, until))
        eased = _where(problems, chosen, True)
        loose = self._at_knots()._together([knots_first.at_knots(problem) for problem in eased], threads, until)
        led = [(problem, report) for problem, report in zip(eased, loose, strict=True) if _leads_on(report)]
        near = iter(self._near()._together([_begun_at(*one) for one in led], threads, until))
        both = iter(
            _led_on(next(near), report, problem) if _leads_on(report) else _at_the_knots(report, problem)
            for problem, report in zip(eased, loose, strict=True)
        )
        return [(problem, next(both if at else plain), at) for problem, at in zip(problems, chosen, strict=True)]

    def _together(self, problems: Sequence[StageProblem], threads: int, until: float) -> list[StageReport]:
        """One solve of each from its own start, by the core's threads."""
        answers = solve_together(problems, self.options(), threads, until - time.perf_counter())
        with np.errstate(invalid="ignore", over="ignore"):
            return [
                self._unusable(problem, answer["flaw"])
                if "flaw" in answer
                else self._report(problem, answer, {"build": answer["build"], "solve": answer["seconds"]}, "given")
                for problem, answer in zip(problems, answers, strict=True)
            ]

    def _unusable(self, problem: StageProblem, flaw: str) -> StageReport:
        none = np.zeros(0)
        return StageReport(
            SolveStatus.FAILED,
            self.name,
            *(none, np.nan, none, none, none),
            iterations=0,
            violation=np.inf,
            stationarity=np.inf,
            worst="",
            timings={"build": 0.0, "solve": 0.0},
            backend_status="unusable",
            note=f"The problem cannot be solved: {flaw}.",
            problem=problem,
        )

    def options(self, *, warm: bool = False) -> Any:
        """The core's options, for those who call it directly (see :func:`core_solver`)."""
        options = compiled().StagewiseOptions()
        options.tolerance, options.max_iterations = self.tolerance, self.max_iterations
        options.time_limit = self.time_limit
        options.warm = warm
        if warm:
            options.bound_push = options.slack_push = WARM_PUSH
            options.initial_barrier = WARM_BARRIER
        if self.initial_barrier is not None:
            options.initial_barrier = self.initial_barrier
        if self.slack_push is not None:
            options.slack_push = self.slack_push
        return options

    def _report(
        self, problem: StageProblem, answer: dict[str, Any], timings: dict[str, float], start: str
    ) -> StageReport:
        core = CorePoint(*(answer[name] for name in CorePoint._fields))
        point = StagePoint(**{name: answer[name] for name in ("v", "s", "z", "zb", "lam", "nu")})
        states, inputs, final_time, lines, penetrations = problem.unpack(core.v)
        status = _STATUS[answer["status"]]
        if status.success and not answer["audited"] <= 100 * self.tolerance:
            status = SolveStatus.NUMERICAL
        told = {} if self.tolerance <= 100 * ROUNDING or not status.success else {"worst": ""}
        return StageReport.lazily(
            status=status,
            solver=self.name,
            objective=answer["objective"],
            iterations=answer["iterations"],
            violation=answer["audited"],
            stationarity=answer["residual"] / answer["largest_multiplier"],
            timings=timings,
            backend_status=answer["status"],
            problem=problem,
            point=point,
            states=states,
            inputs=inputs,
            final_time=final_time,
            pairs=problem.pairs,
            lines=lines,
            penetrations=penetrations,
            log=answer["log"],
            attempts=(Attempt(start, status, answer["iterations"]),),
            core=core,
            **told,
        )


def _begun_at(problem: StageProblem, loose: StageReport) -> StageProblem:
    assert loose.point is not None
    return knots_first.begun_at(problem, loose.point.v)


def _leads_on(loose: StageReport) -> bool:
    """Whether all rows are to be solved from there; if only to be told that time is up, in the order of all rows."""
    return loose.status is not SolveStatus.FAILED and loose.status not in _TRY_AGAIN


def _led_on(near: StageReport, loose: StageReport, problem: StageProblem) -> StageReport:
    """The solve with all rows, as one of the problem with its own start."""
    both = near.named("from the knots").after(loose.named("given, at the knots"))
    return StageReport.lazily(**(both.__dict__ | {"problem": problem}))


def _at_the_knots(loose: StageReport, problem: StageProblem) -> StageReport:
    """Of a solve that leads nowhere: what was spent on it; or that the problem cannot be used."""
    unusable = loose.status is SolveStatus.FAILED
    return replace(loose, problem=problem) if unusable else loose.named("given, at the knots")


def _stop(news: Iteration) -> bool:
    return False


def _where(problems: Sequence[StageProblem], chosen: Sequence[bool], wanted: bool) -> list[StageProblem]:
    return [problem for problem, one in zip(problems, chosen, strict=True) if one is wanted]
