"""What the stagewise solver answers, in the order of the Nlp that says the same; where another solve may start."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tightspot.solvers.base import Array, SolveReport, SolveStatus
from tightspot.solvers.stage_order import CorePoint, order_of
from tightspot.solvers.stage_problem import StageProblem

LOG_COLUMNS = (
    "iteration", "objective", "violation", "stationarity", "complementarity", "barrier", "regularisation",
    "primal_step", "dual_step", "trials",
)  # fmt: skip
"""What the columns of a report's log mean."""
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
    ``worst`` is empty if nothing is violated by more than 1e-9, or a loose solve (tolerance above 1e-7) succeeded.

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
    def lazily(cls, **attributes: Any) -> StageReport:
        """A report that computes what is left out when it is asked for."""
        report = object.__new__(cls)
        report.__dict__.update(attributes)
        return report

    def after(self, begun: StageReport) -> StageReport:
        """This one with what was spent before."""
        timings = {name: begun.timings[name] + seconds for name, seconds in self.timings.items()}
        iterations = begun.iterations + self.iterations
        told = {"timings": timings, "attempts": begun.attempts + self.attempts, "iterations": iterations}
        return StageReport.lazily(**(self.__dict__ | told))

    def named(self, start: str) -> StageReport:
        """This one, solved once, with the start's name."""
        return StageReport.lazily(**(self.__dict__ | {"attempts": (replace(self.attempts[0], start=start),)}))

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
