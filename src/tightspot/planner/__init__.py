"""The planner: ``plan()`` wires guess, transcription, solver and judge together."""

from tightspot.planner.explanation import Explanation, FailureKind
from tightspot.planner.optima import Optimum, find_optima
from tightspot.planner.passing import Deeper, Passing
from tightspot.planner.penetration import Contact, Penetration
from tightspot.planner.pipeline import plan
from tightspot.planner.planner import Planner
from tightspot.planner.progress import Progress, ProgressCallback
from tightspot.planner.reach import Reach
from tightspot.planner.shallowest import minimum_penetration
from tightspot.planner.solver_stop import SolverStop, WorstConstraint

__all__ = [
    "Contact",
    "Deeper",
    "Explanation",
    "FailureKind",
    "Optimum",
    "Passing",
    "Penetration",
    "Planner",
    "Progress",
    "ProgressCallback",
    "Reach",
    "SolverStop",
    "WorstConstraint",
    "find_optima",
    "minimum_penetration",
    "plan",
]
