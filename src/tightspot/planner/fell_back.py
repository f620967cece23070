"""Who fell back from which solver, and why: for the report."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from tightspot.planner.portfolio import Course
from tightspot.planner.request import Request


def fell_back_from(request: Request, tried: Sequence[Course]) -> list[dict[str, Any]]:
    """The solvers that were to be used before the one whose answer it is, in order, each with what became of it."""
    last = tried[-1].rounds[-1] if tried and tried[-1].rounds else None
    if last is None:
        return []
    fallen = [
        {
            "solver": name,
            "status": "NOT_USABLE",
            "sentence": f"It cannot be used for {type(request.vehicle).__name__} with {request.formulation.name}.",
        }
        for name in request.unusable
    ]
    rounds = [outcome for course in tried for outcome in course.rounds]
    reports = [report for outcome in rounds for report in (*outcome.abandoned, outcome.report)]
    for name in dict.fromkeys(report.solver for report in reports):
        mine = [report for report in reports if report.solver == name]
        if name == last.report.solver:
            continue
        failed = next((report for report in mine if not report.status.success), None)
        fallen.append(
            {
                "solver": name,
                "status": failed.status.name if failed else mine[-1].status.name,
                "sentence": failed.status.sentence if failed else "It solved, but the judge certified nothing of it.",
            }
        )
    return fallen
