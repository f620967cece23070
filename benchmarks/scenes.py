"""The scenes that the promises are about."""

from __future__ import annotations

from pathlib import Path

from tightspot import scenarios

TPCAP = Path(__file__).resolve().parents[2] / "shared" / "data" / "tpcap"
"""Not part of the repository; what needs it is skipped where it is not beside the project."""

CASES = ("Case1", "Case2", "Case3", "Case5", "Case9", "Case10", "Case13", "Case16", "Case18")
PROMISED_MARGIN = {"builtin": 0.05, "tpcap": 0.02}


def builtin_scenes() -> list[str]:
    """Names that ``tightspot plan`` understands."""
    return list(scenarios.names())


def tpcap_scenes() -> list[Path]:
    """The competition's cases that are there."""
    return [path for case in CASES if (path := TPCAP / f"{case}.csv").exists()]
