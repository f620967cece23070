"""Other people's trajectories: tables of poses, read from files or arrays, and judged for all times."""

from tightspot.verification.tables.clearance import Clearances, Reading
from tightspot.verification.tables.consistency import Tolerances
from tightspot.verification.tables.findings import Finding, Place
from tightspot.verification.tables.scores import Scores, plan_scores
from tightspot.verification.tables.table import Table, parse_table, read_table
from tightspot.verification.tables.verdict import TableVerdict, judge_table

__all__ = [
    "Clearances",
    "Finding",
    "Place",
    "Reading",
    "Scores",
    "Table",
    "TableVerdict",
    "Tolerances",
    "judge_table",
    "parse_table",
    "plan_scores",
    "read_table",
]
