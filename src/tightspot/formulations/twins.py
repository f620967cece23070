"""Members that say the same with other variables."""

from __future__ import annotations

from tightspot.formulations.base import Formulation
from tightspot.formulations.separating_gap import SeparatingGap
from tightspot.formulations.separating_line import SeparatingLine
from tightspot.formulations.swept_line import SweptLine, SweptUnitNormalLine
from tightspot.formulations.unit_normal_line import UnitNormalLine

_UNIT_NORMAL: dict[type[Formulation], type[Formulation]] = {
    SeparatingLine: UnitNormalLine,
    SeparatingGap: UnitNormalLine,
    UnitNormalLine: UnitNormalLine,
    SweptLine: SweptUnitNormalLine,
    SweptUnitNormalLine: SweptUnitNormalLine,
}


def with_unit_normal(formulation: Formulation) -> Formulation | None:
    """The member that allows the same motions by a line whose normal has length 1; ``None`` if there is none.

    A normal of free length has a null direction where the pair is far apart, which some solvers cannot cope with.
    """
    twin = _UNIT_NORMAL.get(type(formulation))
    return None if twin is None else twin()
