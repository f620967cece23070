"""Formulations: ways to write that two convex polygons do not meet. One file a member."""

from tightspot.errors import InputError, Problem
from tightspot.formulations.base import Formulation, Pair, Pose, Rows
from tightspot.formulations.separating_line import SeparatingLine
from tightspot.formulations.swept_line import SweptLine
from tightspot.formulations.unit_normal_line import UnitNormalLine

FORMULATIONS: dict[str, type[Formulation]] = {
    member.name: member for member in (SeparatingLine, UnitNormalLine, SweptLine)
}
"""Members by the name used at the edges (command line, files)."""


def formulation(name: str) -> Formulation:
    """The member of that name; ``separating-line``, ``separating_line`` and ``SeparatingLine`` are the same.

    Raises:
        InputError: Naming the members there are.
    """
    key = name.replace("-", "").replace("_", "").replace(" ", "").lower()
    for member_name, member in FORMULATIONS.items():
        if key == member_name.replace("-", ""):
            return member()
    raise InputError(Problem("formulation", f"{name!r} is not known; choose one of {', '.join(FORMULATIONS)}"))


__all__ = [
    "FORMULATIONS",
    "Formulation",
    "Pair",
    "Pose",
    "Rows",
    "SeparatingLine",
    "SweptLine",
    "UnitNormalLine",
    "formulation",
]
