"""Campaigns: many runs, kept row by row, and reports of what they showed."""

from tightspot.campaigns.best_of import best_of
from tightspot.campaigns.claims import Claim, claims
from tightspot.campaigns.methods import METHODS, Method
from tightspot.campaigns.paper import News, Outcome, Plan, run
from tightspot.campaigns.report import Machine, report_markdown
from tightspot.campaigns.rows import Row, RowFile
from tightspot.campaigns.settings import PaperSettings, paper_settings

__all__ = [
    "METHODS",
    "Claim",
    "Machine",
    "Method",
    "News",
    "Outcome",
    "PaperSettings",
    "Plan",
    "Row",
    "RowFile",
    "best_of",
    "claims",
    "paper_settings",
    "report_markdown",
    "run",
]
