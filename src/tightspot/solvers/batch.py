"""Many problems solved at once."""

from __future__ import annotations

from collections.abc import Sequence

from tightspot.solvers.stage_problem import StageProblem
from tightspot.solvers.stage_report import StageReport
from tightspot.solvers.stagewise import Stagewise


def solve_many(
    problems: Sequence[StageProblem],
    *,
    threads: int = 1,
    solver: Stagewise | None = None,
    time_limit: float | None = None,
) -> list[StageReport]:
    """Solve each problem by itself, from its own start, on the compiled core's threads.

    A report depends on its problem and the solver's settings alone (but for times): not on the number of threads, nor
    on the other problems. One that cannot be used, say with arrays that do not fit each other, has a report that says
    so, with status :attr:`SolveStatus.FAILED`; the others are solved.

    Args:
        problems: From :func:`tightspot.transcription.stage_problem`; in any mixture of structures.
        threads: How many problems are solved at a time.
        solver: Its tolerance, limits and whether it is robust; default: :class:`Stagewise` as it comes.
        time_limit: Of all together, s. A problem whose turn comes later is reported with
            :attr:`SolveStatus.TIME_LIMIT` at its start; which ones these are depends on the machine. The solver's own
            limit holds for each problem.

    Returns:
        The reports, in the order of the problems.

    Raises:
        InputError: ``threads`` or ``time_limit`` make no sense, or something in the list is no :class:`StageProblem`.
        BuildError: The compiled core is missing.
    """
    return (solver or Stagewise()).solve_many(problems, threads=threads, time_limit=time_limit)
