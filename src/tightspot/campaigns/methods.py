"""The formulations that Table II compares, in the paper's variant and with as few variables as they need."""

from __future__ import annotations

from dataclasses import dataclass

from tightspot.formulations import (
    FarkasDual,
    Formulation,
    NormalisedFarkasDual,
    SeparatingGap,
    SeparatingLine,
    SharedVertexExclusion,
    SignedDistanceDual,
    VertexExclusion,
)


@dataclass(frozen=True)
class Method:
    """A formulation in one variant.

    Attributes:
        key: ``17``; for the single-copy variant of what the paper has four copies of ``18-single``.
        equation: The paper's number.
        paper_variant: Whether it has the paper's numbers of variables and rows.
        formulation: The member.
        title: For tables.
    """

    key: str
    equation: str
    paper_variant: bool
    formulation: Formulation
    title: str


METHODS: dict[str, Method] = {
    method.key: method
    for method in (
        Method("17", "17", True, SeparatingLine(), "(17) separating line"),
        Method("16", "16", True, SeparatingGap(), "(16) separating gap"),
        Method("14", "14", True, VertexExclusion(), "(14) vertex exclusion, 32 variables"),
        Method("14-single", "14", False, SharedVertexExclusion(), "(14) with shared columns, 8 variables"),
        Method("18", "18", True, FarkasDual(copies=4), "(18) Farkas dual, four copies"),
        Method("18-single", "18", False, FarkasDual(), "(18) Farkas dual, one copy"),
        Method("19", "19", True, NormalisedFarkasDual(copies=4), "(19) normalised dual, four copies"),
        Method("19-single", "19", False, NormalisedFarkasDual(), "(19) normalised dual, one copy"),
        Method("21", "21", True, SignedDistanceDual(copies=4), "(21) signed-distance dual, four copies"),
        Method("21-single", "21", False, SignedDistanceDual(), "(21) signed-distance dual, one copy"),
    )
}
"""By key, in the order of the tables."""
