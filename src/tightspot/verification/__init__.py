"""The independent judge: replay, proof for all times, certificate, and the checker that trusts nobody."""

from tightspot.verification.certificate import Certificate, Check, ObstaclePart, PairProof, Witness, WorkspaceProof
from tightspot.verification.checker import CheckResult, check_certificate
from tightspot.verification.checks import Limits
from tightspot.verification.dense import ClearanceSeries, minimum_clearance
from tightspot.verification.driven import DrivenTrajectory
from tightspot.verification.file_exact import file_exact
from tightspot.verification.judge import JudgeSettings, verify
from tightspot.verification.plan_file import (
    Plan,
    Verdict,
    load_plan,
    save_plan,
    verify_plan,
    write_trajectory_csv,
)
from tightspot.verification.replay import Replay, replay
from tightspot.verification.tables import Scores, Table, TableVerdict, Tolerances, judge_table, plan_scores, read_table

__all__ = [
    "Certificate",
    "Check",
    "CheckResult",
    "ClearanceSeries",
    "DrivenTrajectory",
    "JudgeSettings",
    "Limits",
    "ObstaclePart",
    "PairProof",
    "Plan",
    "Replay",
    "Scores",
    "Table",
    "TableVerdict",
    "Tolerances",
    "Verdict",
    "Witness",
    "WorkspaceProof",
    "check_certificate",
    "file_exact",
    "judge_table",
    "load_plan",
    "minimum_clearance",
    "plan_scores",
    "read_table",
    "replay",
    "save_plan",
    "verify",
    "verify_plan",
    "write_trajectory_csv",
]
