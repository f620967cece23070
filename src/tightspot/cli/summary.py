"""What a plan is, in a few lines for people and as a JSON object for programs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from rich.table import Table

from tightspot.verification.certificate import rounded_down

if TYPE_CHECKING:
    from tightspot.verification import Certificate, Plan


def summary_table(plan: Plan) -> Table:
    """The numbers one looks for first."""
    report = plan.report
    rounds = report["rounds"]
    objective = report["objective"]
    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_column(style="bold", no_wrap=True)
    table.add_column()
    table.add_row("scene", plan.scenario.name)
    table.add_row("vehicle", plan.vehicle.name)
    table.add_row("duration", f"{report['duration']:.2f} s")
    table.add_row("path length", f"{report['path_length']:.2f} m")
    table.add_row("gear changes", str(report["gear_changes"]))
    table.add_row("steps", str(plan.trajectory.steps))
    table.add_row("objective", f"{objective['value']:.4f} (weight {objective['time_weight']:g} on time)")
    table.add_row("clearance", _clearance(plan.certificate))
    table.add_row("method", _method(report))
    for number, entry in enumerate(rounds, start=1):
        table.add_row("rounds" if number == 1 else "", f"{number}: {_round(entry)}")
    if len(report["tried"]) > 1:
        good = sum(entry["certified"] for entry in report["tried"])
        table.add_row("tried", f"{len(report['tried'])} guesses, {good} certified")
    table.add_row("time", f"{report['seconds']:.2f} s ({report['guess']['seconds']:.2f} s for the guess)")
    return table


def _method(report: dict[str, Any]) -> str:
    solve = report["rounds"][-1]["solve"]
    if solve["status"] == "NOT_SOLVED":
        return f"{report['guess']['name']}: {solve['sentence']}"
    return f"{report['formulation']} from {report['guess']['name']}, {solve['solver']}"


def certificate_facts(certificate: Certificate) -> dict[str, Any]:
    """The certificate without its proof; a clearance of ``None`` is unbounded: there is nothing to touch."""
    finite = math.isfinite(certificate.clearance)
    return {
        "certified": certificate.certified,
        "margin": certificate.margin,
        "clearance": certificate.clearance if finite else None,
        "intervals": certificate.intervals,
        "pairs": len(certificate.pairs),
        "digest": certificate.digest,
    }


def plan_facts(plan: Plan) -> dict[str, Any]:
    """The summary for programs."""
    report = plan.report
    return {
        "scene": plan.scenario.name,
        "vehicle": plan.vehicle.name,
        "duration": report["duration"],
        "path_length": report["path_length"],
        "gear_changes": report["gear_changes"],
        "steps": plan.trajectory.steps,
        "objective": report["objective"]["value"],
        "rounds": len(report["rounds"]),
        "course": [_round_facts(entry) for entry in report["rounds"]],
        "tried": report["tried"],
        "seconds": report["seconds"],
        "certificate": certificate_facts(plan.certificate),
    }


def _round(entry: dict[str, Any]) -> str:
    """What a round solved and what it cost."""
    solve, ms = entry["solve"], {key: f"{1000 * value:.0f} ms" for key, value in entry["timings"].items()}
    fallen = "".join(f" after {report['solver']} failed" for report in entry["fell_back_from"])
    what = f"{entry['formulation']}, {entry['steps']} intervals"
    how = f"{solve['iterations']} iterations of {solve['solver']}{fallen}"
    cost = f"set-up {ms['set_up']}, solve {ms['solve']}, judge {ms['judge']}"
    return f"{what}: {how}; {cost}; {'certified' if entry['certified'] else 'not certified'}"


def _round_facts(entry: dict[str, Any]) -> dict[str, Any]:
    facts = {key: entry[key] for key in ("reason", "formulation", "steps", "pairs", "certified", "timings")}
    solve = {key: entry["solve"][key] for key in ("solver", "status", "iterations", "objective")}
    return facts | solve | {"fell_back_from": [report["solver"] for report in entry["fell_back_from"]]}


def _clearance(certificate: Certificate) -> str:
    if math.isinf(certificate.clearance):
        return "nothing to touch"
    return f"at least {rounded_down(certificate.clearance)} m at all times (demanded {certificate.margin:g} m)"
