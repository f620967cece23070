"""Solvers of nonlinear programs. They know nothing of cars."""

from tightspot.solvers.base import Iteration, IterationCallback, Solver, SolveReport, SolveStatus, WarmStart
from tightspot.solvers.ipopt import Ipopt
from tightspot.solvers.nlp import Nlp, RowBlock, Stage
from tightspot.solvers.sqp import Sqp

SOLVERS: dict[str, type[Solver]] = {Ipopt.name: Ipopt, Sqp.name: Sqp}
"""Backends by the name used at the edges (command line, files)."""

__all__ = [
    "SOLVERS",
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
    "WarmStart",
]
