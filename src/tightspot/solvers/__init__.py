"""Solvers of nonlinear programs. They know nothing of cars."""

from tightspot.solvers.base import Iteration, IterationCallback, Solver, SolveReport, SolveStatus, WarmStart
from tightspot.solvers.batch import solve_many
from tightspot.solvers.fatrop import Fatrop
from tightspot.solvers.ipopt import Ipopt
from tightspot.solvers.nlp import Nlp, RowBlock, Stage
from tightspot.solvers.sqp import Sqp
from tightspot.solvers.stage_problem import StageProblem
from tightspot.solvers.stage_report import StagePoint, StageReport
from tightspot.solvers.stagewise import Stagewise

SOLVERS: dict[str, type[Solver]] = {Ipopt.name: Ipopt, Fatrop.name: Fatrop, Sqp.name: Sqp}
"""Backends that solve any :class:`Nlp`, by the name used at the edges (command line, files)."""

BACKENDS: dict[str, type[Solver]] = {Stagewise.name: Stagewise, **SOLVERS}
"""All backends by name; the stagewise one takes a :class:`StageProblem`."""

__all__ = [
    "BACKENDS",
    "SOLVERS",
    "Fatrop",
    "Ipopt",
    "Iteration",
    "IterationCallback",
    "Nlp",
    "RowBlock",
    "SolveReport",
    "SolveStatus",
    "Solver",
    "Sqp",
    "Stage",
    "StagePoint",
    "StageProblem",
    "StageReport",
    "Stagewise",
    "WarmStart",
    "solve_many",
]
