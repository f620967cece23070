"""What every solver takes and gives back."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import Problem, is_number, is_whole, shown
from tightspot.solvers.nlp import Nlp

Array = NDArray[np.float64]

MOST = 2**31 - 1
"""Iterations: what compiled code counts to."""


class SolveStatus(Enum):
    """How a solve ended; the value is the sentence for people."""

    SOLVED = "Solved to the tolerance."
    ACCEPTABLE = "Solved to the acceptable tolerance only."
    INFEASIBLE = "The solver converged to a point that violates the constraints; no feasible one is near."
    ITERATION_LIMIT = "The iteration limit was reached."
    TIME_LIMIT = "The time limit was reached."
    STOPPED = "Stopped by the caller."
    DIVERGED = "The iterates diverged."
    NUMERICAL = "The solver met numbers it could not handle (NaN, a singular system or too small a step)."
    FAILED = "The solver stopped for a reason of its own."

    @property
    def sentence(self) -> str:
        """What it means."""
        return self.value

    @property
    def success(self) -> bool:
        """True if the point satisfies the constraints and the optimality conditions."""
        return self in (SolveStatus.SOLVED, SolveStatus.ACCEPTABLE)


@dataclass(frozen=True)
class Iteration:
    """Progress of one iteration.

    Attributes:
        number: 0 for the starting point.
        objective: f.
        violation: Largest constraint violation.
    """

    number: int
    objective: float
    violation: float


IterationCallback = Callable[[Iteration], bool | None]
"""Called after each iteration; return ``False``, Python's or NumPy's, to stop the solve."""


def asks_to_stop(answer: object) -> bool:
    """Whether a callback's answer is ``False``; a comparison with a NumPy number has NumPy's."""
    return isinstance(answer, (bool, np.bool_)) and not answer


@dataclass(frozen=True, eq=False)
class SolveReport:
    """A solve's outcome. Check ``status.success`` before using ``x`` as a solution.

    Attributes:
        status: How it ended.
        solver: Name of the backend.
        x: Last iterate, (n,).
        objective: f at x.
        g: Rows at x, (m,).
        lam_x: Multipliers of the bounds, (n,).
        lam_g: Multipliers of the rows, (m,).
        iterations: Number of iterations.
        violation: Largest violation of a row or bound at x, recomputed here, not the solver's word.
        stationarity: Largest entry of the Lagrangian's gradient at x, recomputed here.
        worst: What the most violated row is about.
        timings: Seconds: ``build`` (symbolic set-up), ``solve``, inside it ``functions`` and ``callback``.
        backend_status: The backend's own word.
        note: What else there is to tell, for example why functions were not compiled; usually empty.
    """

    status: SolveStatus
    solver: str
    x: Array
    objective: float
    g: Array
    lam_x: Array
    lam_g: Array
    iterations: int
    violation: float
    stationarity: float
    worst: str
    timings: dict[str, float] = field(default_factory=dict)
    backend_status: str = ""
    note: str = ""

    @property
    def n_variables(self) -> int:
        """n."""
        return self.x.size

    @property
    def n_rows(self) -> int:
        """m."""
        return self.g.size

    def to_dict(self) -> dict[str, Any]:
        """Plain data for reports, without the vectors."""
        return {
            "status": self.status.name,
            "sentence": self.status.sentence,
            "solver": self.solver,
            "objective": self.objective,
            "iterations": self.iterations,
            "violation": self.violation,
            "stationarity": self.stationarity,
            "worst_constraint": self.worst,
            "timings": self.timings,
            "backend_status": self.backend_status,
            **({"note": self.note} if self.note else {}),
        }


@dataclass(frozen=True)
class WarmStart:
    """A point and multipliers to start from.

    Attributes:
        x: Variables, (n,).
        lam_x: Multipliers of the bounds, (n,); ``None``: of the backend's own making.
        lam_g: Multipliers of the rows, (m,).
        push: How far an interior-point backend moves the start away from bounds it is at: the less, the nearer the
            start is to the solution. Too little, and the iterates creep along bounds that ought to be left.
    """

    x: Array
    lam_x: Array | None = None
    lam_g: Array | None = None
    push: float = 1e-6


def limit_problems(solver: Solver) -> list[Problem]:
    """What is wrong with a backend's ``tolerance``, ``time_limit`` and ``max_iterations``."""
    problems = []
    for name in ("tolerance", "time_limit"):
        value = getattr(solver, name)
        if not (is_number(value) and 0 < value < np.inf):
            problems.append(Problem(f"solver.{name}", f"{shown(value)} must be positive and finite"))
    most = solver.max_iterations
    if not (is_whole(most) and 0 <= most <= MOST):
        problems.append(
            Problem("solver.max_iterations", f"{shown(most)} must be a whole number, not negative, at most {MOST}")
        )
    return problems


class Solver(ABC):
    """A backend: solves any :class:`Nlp` whose structure it can use."""

    name: ClassVar[str]
    tolerance: float
    max_iterations: int
    time_limit: float

    @abstractmethod
    def with_time_limit(self, seconds: float) -> Solver:
        """The same backend with a wall-clock limit of ``seconds`` or its own, whichever is shorter."""

    @abstractmethod
    def solve(
        self, nlp: Nlp, *, warm: WarmStart | None = None, callback: IterationCallback | None = None
    ) -> SolveReport:
        """Solve from ``nlp.x0`` or from ``warm``.

        Returns:
            A report whatever happens: a failed solve is a status, not an exception.

        Raises:
            KeyboardInterrupt: If the user interrupts.
        """
