"""VN and CN of Table II, from the programs themselves."""

import pytest

from tightspot.formulations import (
    FarkasDual,
    NormalisedFarkasDual,
    SeparatingGap,
    SeparatingLine,
    SharedVertexExclusion,
    SignedDistanceDual,
    VertexExclusion,
)
from tightspot.guesses import LinearInterpolation
from tightspot.scenarios.library import builtin
from tightspot.transcription import Settings, TimeGrid, counts, transcribe
from tightspot.vehicles import vehicle

CAR = vehicle("paper-recovered")
SCENES = ("vertical", "parallel", "oblique")
PAPER = [
    (SeparatingLine(), 266, 1166),
    (SeparatingGap(), 306, 1286),
    (VertexExclusion(), 1426, 3446),
    (FarkasDual(copies=4), 1426, 3606),
    (NormalisedFarkasDual(copies=4), 1426, 3766),
    (SignedDistanceDual(copies=4), 1426, 3766),
]


def size(scene, member):
    scenario = builtin(scene)
    guess = LinearInterpolation().make(scenario, CAR, margin=0.0).trajectory
    nlp = transcribe(scenario, CAR, guess, Settings(formulation=member), grid=TimeGrid.uniform(20)).nlp
    assert nlp.x.numel() == counts(nlp).VN
    assert nlp.g.numel() == counts(nlp).rows
    return counts(nlp)


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize(("member", "VN", "CN"), PAPER, ids=[member.name for member, *_ in PAPER])
def test_the_paper_s_variants_have_the_paper_s_sizes(scene, member, VN, CN):
    assert size(scene, member)[:2] == (VN, CN)


@pytest.mark.parametrize(
    ("member", "rows"),
    [(FarkasDual(), 3), (NormalisedFarkasDual(), 4), (SignedDistanceDual(), 4), (SharedVertexExclusion(), 8)],
    ids=lambda value: getattr(value, "name", ""),
)
def test_one_copy_needs_466_variables(member, rows):
    found = size("vertical", member)
    assert found.VN == 466
    assert found.auxiliary == 8 * 40
    assert found.rows == 100 + 320 + rows * 40
