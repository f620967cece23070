"""Formulations: ways to write that two convex polygons do not meet. One file a member."""

from tightspot.errors import InputError, Problem
from tightspot.formulations.base import Formulation, Pair, Pose, Rows
from tightspot.formulations.disc_cover import DiscCover
from tightspot.formulations.farkas_dual import FarkasDual
from tightspot.formulations.min_edge_distance import MinEdgeDistance
from tightspot.formulations.normalised_farkas_dual import NormalisedFarkasDual
from tightspot.formulations.separating_gap import SeparatingGap
from tightspot.formulations.separating_line import SeparatingLine
from tightspot.formulations.shared_vertex_exclusion import SharedVertexExclusion
from tightspot.formulations.signed_distance_dual import SignedDistanceDual
from tightspot.formulations.soft_signed_distance import SoftSignedDistance
from tightspot.formulations.soft_unit_normal_line import SoftSweptUnitNormalLine, SoftUnitNormalLine
from tightspot.formulations.swept_line import SweptLine, SweptUnitNormalLine
from tightspot.formulations.triangle_area import TriangleArea
from tightspot.formulations.twins import with_unit_normal
from tightspot.formulations.unit_normal_line import UnitNormalLine
from tightspot.formulations.vertex_exclusion import VertexExclusion

FORMULATIONS: dict[str, type[Formulation]] = {
    member.name: member
    for member in (
        SeparatingLine,
        UnitNormalLine,
        SweptLine,
        SweptUnitNormalLine,
        SeparatingGap,
        VertexExclusion,
        SharedVertexExclusion,
        FarkasDual,
        NormalisedFarkasDual,
        SignedDistanceDual,
        MinEdgeDistance,
        TriangleArea,
        DiscCover,
    )
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
    "DiscCover",
    "FarkasDual",
    "Formulation",
    "MinEdgeDistance",
    "NormalisedFarkasDual",
    "Pair",
    "Pose",
    "Rows",
    "SeparatingGap",
    "SeparatingLine",
    "SharedVertexExclusion",
    "SignedDistanceDual",
    "SoftSignedDistance",
    "SoftSweptUnitNormalLine",
    "SoftUnitNormalLine",
    "SweptLine",
    "SweptUnitNormalLine",
    "TriangleArea",
    "UnitNormalLine",
    "VertexExclusion",
    "formulation",
    "with_unit_normal",
]
