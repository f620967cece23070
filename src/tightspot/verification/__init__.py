"""The independent judge: replay, proof for all times, certificate, and the checker that trusts nobody."""

from tightspot.verification.certificate import Certificate, Check, PairProof, Witness, WorkspaceProof
from tightspot.verification.checks import Limits
from tightspot.verification.judge import JudgeSettings, verify
from tightspot.verification.replay import Replay, replay

__all__ = [
    "Certificate",
    "Check",
    "JudgeSettings",
    "Limits",
    "PairProof",
    "Replay",
    "Witness",
    "WorkspaceProof",
    "replay",
    "verify",
]
