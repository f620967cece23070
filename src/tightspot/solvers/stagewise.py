"""Our structure-exploiting interior-point solver, compiled: the Python face."""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import BuildError, InputError, Problem, is_number, shown
from tightspot.solvers import knots_first
from tightspot.solvers.base import (
    Array,
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
from tightspot.solvers.stage_order import CorePoint, order_of
from tightspot.solvers.stage_problem import StageProblem

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
_MODELS = {"single_track": "StagewiseSingleTrack"}
LOG_COLUMNS = (
    "iteration", "objective", "violation", "stationarity", "complementarity", "barrier", "regularisation",
    "primal_step", "dual_step", "trials",
)  # fmt: skip
"""What the columns of a report's log mean."""
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
AT_ONCE = 64
"""Problems that each thread of a batch is given at a time; between them, Python is told of Ctrl-C."""
ROUNDING = 1e-9
_LAZY = ("x", "g", "lam_x", "lam_g", "worst")


@dataclass(frozen=True, eq=False)
class StagePoint:
    """Where a solve ended, in the core's order: enough to start another one of the same structure.

    Attributes:
        v: States, inputs, t_f, (phi, mu) of each pair, the penetrations of soft ones.
        s: Slacks of the rows, (m,).
        z: Multipliers of the rows, (m,).
        zb: Multipliers of the bounds.
        lam: Multipliers of the dynamics, N n_x.
        nu: Multipliers of the goal, n_x.
    """

    v: Array
    s: Array
    z: Array
    zb: Array
    lam: Array
    nu: Array


@dataclass(frozen=True)
class Attempt:
    """One of the starts that a solve was made from.

    Attributes:
        start: ``"warm"``: the earlier solution; ``"given"``: the problem's own; ``"given, at the knots"`` and ``"from
            the knots"``: see :mod:`tightspot.solvers.knots_first`; or how it was made (see
            :mod:`tightspot.solvers.rough_starts`).
        status: How the solve from there ended, or the drive without obstacles that it should have followed.
        iterations: Of both.
    """

    start: str
    status: SolveStatus
    iterations: int


@dataclass(frozen=True, eq=False)
class StageReport(SolveReport):
    """A :class:`SolveReport` whose vectors are in the order of the Nlp that says the same, and the stagewise ones.

    The solver's reports compute ``x``, ``g``, ``lam_x``, ``lam_g`` and ``worst`` when they are first asked for.
    ``worst`` is empty if nothing is violated by more than 1e-9.

    Attributes:
        problem: What was solved.
        point: The last iterate, to start another solve from.
        states: (N + 1, n_x).
        inputs: (N, n_u).
        final_time: s.
        pairs: (interval, part, obstacle part) of each pair, (n, 3).
        lines: (phi, mu) of each pair, (n, 2).
        penetrations: sigma of each pair, m, 0 for those that allow none, (n,).
        log: One line an iteration of the solve that is reported, columns :data:`LOG_COLUMNS`.
        attempts: The starts that were tried; the report is that of the last one if it succeeded, else of the first.
            ``iterations`` and ``timings`` are those of all together.
        least: Of problems that were not solved: the shallowest solution found with soft obstacles, whose
            ``penetrations`` tell what clearance is lacking where; ``None`` if there was none.
        core: What the compiled solver returned.
    """

    problem: StageProblem | None = None
    point: StagePoint | None = None
    states: Array | None = None
    inputs: Array | None = None
    final_time: float = np.nan
    pairs: NDArray[np.int64] | None = None
    lines: Array | None = None
    penetrations: Array | None = None
    log: Array | None = None
    attempts: tuple[Attempt, ...] = ()
    least: StageReport | None = field(default=None, repr=False)
    core: CorePoint | None = field(default=None, repr=False)

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            core, problem = (self.__dict__.get(key) for key in ("core", "problem"))
            if name not in _LAZY or core is None or problem is None:
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            with np.errstate(invalid="ignore", over="ignore"):
                if name == "worst":
                    found = {"worst": "" if self.violation <= ROUNDING else _worst(problem, core)}
                else:
                    found = order_of(problem).point(core)._asdict()
            self.__dict__.update(found)
            return found[name]

    @classmethod
    def _of(cls, **attributes: Any) -> StageReport:
        """A report that computes what is left out when it is asked for."""
        report = object.__new__(cls)
        report.__dict__.update(attributes)
        return report

    def _after(self, begun: StageReport) -> StageReport:
        """This one with what was spent before."""
        timings = {name: begun.timings[name] + seconds for name, seconds in self.timings.items()}
        iterations = begun.iterations + self.iterations
        told = {"timings": timings, "attempts": begun.attempts + self.attempts, "iterations": iterations}
        return StageReport._of(**(self.__dict__ | told))

    def _named(self, start: str) -> StageReport:
        """This one, solved once, with the start's name."""
        return StageReport._of(**(self.__dict__ | {"attempts": (replace(self.attempts[0], start=start),)}))

    @property
    def n_variables(self) -> int:
        """n, without computing x."""
        return super().n_variables if self.core is None else self.core.v.size + self._units

    @property
    def n_rows(self) -> int:
        """m, without computing g."""
        core = self.core
        return super().n_rows if core is None else core.rows.size + core.defects.size + self._units

    @property
    def _units(self) -> int:
        """How many lines are written as vectors of at most unit length."""
        problem = self.problem
        return len(problem.pairs) if problem is not None and problem.form.vector else 0

    def to_dict(self) -> dict[str, Any]:
        """As :meth:`SolveReport.to_dict`, with the starts that were tried."""
        tried = [{"start": one.start, "status": one.status.name, "iterations": one.iterations} for one in self.attempts]
        return super().to_dict() | {"attempts": tried}


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
        return replace(self, time_limit=min(self.time_limit, max(seconds, 1e-3)))

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
        limited = replace(self, max_iterations=left).with_time_limit(self.time_limit - begun.timings["solve"])
        return self._gone_on(problem, limited._first()._once(problem, None, callback)._after(begun), callback)

    def _begins_at_knots(self, problem: StageProblem) -> bool:
        chosen = self.knots_first and self.initial_barrier is None and self.max_iterations >= knots_first.SHARE
        return chosen and knots_first.has_rows_between(problem)

    def _at_knots(self) -> Stagewise:
        tolerance, most = max(self.tolerance, knots_first.TOLERANCE), self.max_iterations // knots_first.SHARE
        return replace(self, tolerance=tolerance, max_iterations=most)

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
        return replace(self, max_iterations=most, initial_barrier=knots_first.BARRIER, slack_push=slack)

    def _first(self) -> Stagewise:
        """For the first start: other ones are to have their turn, too."""
        return replace(self, max_iterations=2 * self.max_iterations // 5) if self.robust else self

    def _warm(
        self, problem: StageProblem, warm: StagePoint, callback: IterationCallback | None, core: Any
    ) -> StageReport:
        quick = replace(self, max_iterations=min(self.max_iterations, WARM_ITERATIONS)) if self.robust else self
        report = quick._once(problem, warm, callback, core=core)
        if not self.robust or report.status not in _TRY_AGAIN:
            return report
        left = self.max_iterations - report.iterations
        seconds = max(self.time_limit - report.timings["solve"], 1e-3)
        cold = replace(self, max_iterations=left, time_limit=seconds).solve_stages(problem, callback=callback)
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
            limited = replace(self, time_limit=seconds, max_iterations=iterations)
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
            _move_ends(core, problem)
        options = self.options(warm=warm is not None)
        _start(core, problem, warm)
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
        _check_batch(problems, threads, time_limit)
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
        answers = _solve_together(problems, self.options(), threads, until - time.perf_counter())
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
        options = _core().StagewiseOptions()
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
        largest = max(1.0, *(float(np.abs(of).max(initial=0.0)) for of in (core.z, core.lam)))
        return StageReport._of(
            status=status,
            solver=self.name,
            objective=answer["objective"],
            iterations=answer["iterations"],
            violation=answer["audited"],
            stationarity=answer["residual"] / largest,
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
        )


def _begun_at(problem: StageProblem, loose: StageReport) -> StageProblem:
    assert loose.point is not None
    return knots_first.begun_at(problem, loose.point.v)


def _leads_on(loose: StageReport) -> bool:
    """Whether all rows are to be solved from there; if only to be told that time is up, in the order of all rows."""
    return loose.status is not SolveStatus.FAILED and loose.status not in _TRY_AGAIN


def _led_on(near: StageReport, loose: StageReport, problem: StageProblem) -> StageReport:
    """The solve with all rows, as one of the problem with its own start."""
    both = near._named("from the knots")._after(loose._named("given, at the knots"))
    return StageReport._of(**(both.__dict__ | {"problem": problem}))


def _at_the_knots(loose: StageReport, problem: StageProblem) -> StageReport:
    """Of a solve that leads nowhere: what was spent on it; or that the problem cannot be used."""
    unusable = loose.status is SolveStatus.FAILED
    return replace(loose, problem=problem) if unusable else loose._named("given, at the knots")


def _stop(news: Iteration) -> bool:
    return False


def _where(problems: Sequence[StageProblem], chosen: Sequence[bool], wanted: bool) -> list[StageProblem]:
    return [problem for problem, one in zip(problems, chosen, strict=True) if one is wanted]


def _move_ends(core: Any, problem: StageProblem) -> None:
    try:
        core.set_ends(problem.start, problem.goal)
    except ValueError as error:
        raise InputError(Problem("core", f"it is another problem's: {error}")) from None


def _start(core: Any, problem: StageProblem, warm: StagePoint | None) -> None:
    try:
        with np.errstate(invalid="ignore", over="ignore"):
            core.set(problem.starting_point() if warm is None else warm.v)
        if warm is not None:
            core.set_multipliers(warm.s, warm.z, warm.zb, warm.lam, warm.nu)
    except ValueError as error:
        raise InputError(Problem("warm" if warm else "problem", str(error))) from None


def _check_batch(problems: Sequence[StageProblem], threads: int, time_limit: float | None) -> None:
    if not isinstance(threads, (int, np.integer)) or threads < 1:
        raise InputError(Problem("threads", f"{threads!r} is no number of threads; give at least 1"))
    if time_limit is not None and not (isinstance(time_limit, (float, int, np.number)) and time_limit > 0):
        raise InputError(Problem("time_limit", f"{time_limit!r} must be positive"))
    if not isinstance(problems, Sequence):
        raise InputError(Problem("problems", f"{type(problems).__name__} is no sequence of problems; give a list"))
    others = [(i, type(one).__name__) for i, one in enumerate(problems) if not isinstance(one, StageProblem)]
    if others:
        raise InputError([Problem(f"problems[{i}]", f"{name} is not a StageProblem") for i, name in others])


def _solve_together(
    problems: Sequence[StageProblem], options: Any, threads: int, seconds: float
) -> Iterable[dict[str, Any]]:
    """The core's answer to each problem, with ``flaw`` alone where one cannot be used."""
    models = sorted({problem.model for problem in problems})
    answers: list[dict[str, Any]] = [{} for _ in problems]
    for model in models:
        mine = [i for i, problem in enumerate(problems) if problem.model == model]
        if model not in _MODELS:
            found = [{"flaw": f"the model {model!r} is not compiled in"}] * len(mine)
        else:
            starts = [_start_of(problems[i]) for i in mine]
            core = getattr(_core(), _MODELS[model])
            found = core.solve_many([problems[i] for i in mine], starts, options, threads, seconds)
        for i, answer in zip(mine, found, strict=True):
            answers[i] = answer
    return answers


def _start_of(problem: StageProblem) -> Array | None:
    """``None`` if its arrays do not fit each other."""
    try:
        with np.errstate(invalid="ignore", over="ignore"):
            return problem.starting_point()
    except (ValueError, TypeError, IndexError, AttributeError):
        return None


def _worst(problem: StageProblem, core: CorePoint) -> str:
    """What is violated most: a row, the dynamics, a bound, start or goal, and where it is."""
    states, inputs, final_time, *_ = problem.unpack(core.v)
    inner = np.maximum(problem.state_low - states, states - problem.state_high)
    for knot, end in ((0, problem.start), (-1, problem.goal)):
        away = np.abs(states[knot] - end)
        inner[knot] = np.where(np.isnan(end), inner[knot], away)
    outside = np.maximum(problem.input_low - inputs, inputs - problem.input_high)
    late = max(problem.time_low - final_time, final_time - problem.time_high)
    found = {
        "rows": -core.rows,
        "dynamics at knot": np.abs(core.defects),
        "bounds of the state at knot": inner.ravel(),
        "bounds of the input at knot": outside.ravel(),
        "bounds of t_f": np.array([late]),
    }
    places = {kind: int(values.argmax()) for kind, values in found.items() if values.size}  # NaN counts as the largest
    largest = {kind: float(found[kind][place]) for kind, place in places.items()}
    worst = max(largest, key=lambda kind: np.inf if np.isnan(largest[kind]) else largest[kind])
    if largest[worst] <= 0:
        return ""
    if worst == "rows":
        return _row_sentence(problem, places[worst])
    if not worst.endswith("knot"):
        return worst
    width = problem.input_weights.size if worst.startswith("bounds of the input") else problem.start.size
    return f"{worst} {places[worst] // width}"


def _row_sentence(problem: StageProblem, row: int) -> str:
    order = order_of(problem)
    pair = int(order.pair_of_row[row])
    knot = int(np.searchsorted(order.dynamics[:, 0], order.rows[row])) + 1
    if pair < 0:
        return f"workspace at knot {knot}"
    _, part, obstacle = problem.pairs[pair]
    return f"separation of part {part} against obstacle part {obstacle} at knot {knot}"


def core_solver(problem: StageProblem) -> Any:
    """The compiled solver of one problem, whose set-up allocates everything that solving needs.

    Raises:
        InputError: The model is not compiled in, or an array does not fit the others.
    """
    if problem.model not in _MODELS:
        raise InputError(Problem("model", f"{problem.model!r} is not compiled in; there are {', '.join(_MODELS)}"))
    if problem.penetrations.shape != (len(problem.pairs),):
        given = f"penetrations: has shape {problem.penetrations.shape}, but there are {len(problem.pairs)} pairs"
        raise InputError(Problem("problem", given))
    try:
        return getattr(_core(), _MODELS[problem.model])(problem)
    except ValueError as error:
        raise InputError(Problem("problem", str(error))) from None


class StartLines(NamedTuple):
    """Separating lines in closed form.

    Attributes:
        lines: (phi, mu) of each pair, midway between the obstacle and the body, (n, 2).
        origins: Points next to the body to measure mu from, m, (n, 2).
        overlaps: How far the body reaches beyond the obstacle's edge of the line, m, 0 if it does not, (n,).
    """

    lines: Array
    origins: Array
    overlaps: Array

    def beside_obstacles(self) -> Array:
        """The lines, those of overlapping pairs at the obstacle's edge."""
        return self.lines + np.column_stack([np.zeros_like(self.overlaps), self.overlaps / 2])


def start_lines(
    states: Array,
    pieces: NDArray[np.int64],
    pairs: NDArray[np.int64],
    part_vertices: Array,
    part_first: NDArray[np.int64],
    obstacle_vertices: Array,
    obstacle_first: NDArray[np.int64],
    *,
    whole: NDArray[np.bool_],
    moving: NDArray[np.int64] | None = None,
    frames: Array | None = None,
) -> StartLines:
    """Lines of pairs to start from.

    As :func:`tightspot.formulations.lines.line_of_guess`: the best normal at the interval's middle pose, and the offset
    midway between the obstacle and the body at all the interval's poses, interpolated between the knots, or at the last
    one alone where it is not ``whole``, (N,). The arrays are those of a :class:`StageProblem`, the states the guess's.
    Obstacles that move (``moving``, (M,)) have lines and points in their frames, whose poses at each sample are
    ``frames``, (M, S, 3).
    """
    states = np.ascontiguousarray(states)
    polygons = (part_vertices, part_first, obstacle_vertices, obstacle_first)
    moving = np.zeros(0, np.int64) if moving is None else moving
    frames = np.zeros((0, 0, 3)) if frames is None else frames
    table = _core().stagewise_start_lines(
        states, pieces, np.flatnonzero(~whole), *polygons, np.ascontiguousarray(pairs), moving, frames
    )
    overlaps = np.maximum(0.0, -table[:, 4])
    return StartLines(np.ascontiguousarray(table[:, :2]), np.ascontiguousarray(table[:, 2:4]), overlaps)


def with_states(problem: StageProblem, states: Array, inputs: Array, final_time: float) -> StageProblem:
    """The problem, starting from other states, inputs and t_f, with the lines that separate best there."""
    first = np.concatenate([[0], np.cumsum(problem.pieces + 1)[:-1]])
    whole = ~np.isnan(problem.pair_demands[first, 0])
    polygons = (problem.part_vertices, problem.part_first, problem.obstacle_vertices, problem.obstacle_first)
    moving, frames = problem.motion_obstacles, problem.frames(final_time)
    found = start_lines(states, problem.pieces, problem.pairs, *polygons, whole=whole, moving=moving, frames=frames)
    soft = problem.soft
    return problem.replaced(
        states=states,
        inputs=inputs,
        final_time=final_time,
        lines=np.where(soft[:, None], found.beside_obstacles(), found.lines),
        penetrations=np.where(soft, found.overlaps, 0.0),
        pair_origins=found.origins,
    )


def _core() -> Any:
    try:
        from tightspot import _core
    except ImportError as error:
        raise BuildError(
            f"tightspot's compiled core cannot be loaded ({error}); install a C++17 compiler, e.g. "
            "`apt install g++`, and install tightspot again with `pip install .` in its folder"
        ) from None
    return _core
