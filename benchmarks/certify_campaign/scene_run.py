"""One scene: draw, plan, replay, question the judge. Runs in a worker process."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

import tightspot
from benchmarks.certify_campaign.judged import Judged, as_row, judged_again, recorded, refused_for_room, replayed
from benchmarks.random_scenes import random_scene
from benchmarks.random_scenes.__main__ import write
from benchmarks.replay import replay
from tightspot.errors import PlanningError, TightspotError
from tightspot.verification import Plan


def run_scene(seed: int, index: int, limit: float, directory: str) -> dict[str, Any]:
    """The row of one scene; its scene file, and the plan file if there is one, are kept in the directory."""
    scene = random_scene(seed, index)
    write(scene, Path(directory) / "scenes")
    row: dict[str, Any] = scene.facts()
    wall, processor = time.perf_counter(), time.process_time()
    with recorded() as asked:
        try:
            plan = tightspot.plan(scene.scenario, time_limit=limit)
            row |= {"outcome": "plan", **_facts(plan.report)}
        except PlanningError as error:
            plan = None
            row |= {"outcome": _kind(error), "reason": error.reason, **_facts(error.report)}
        except TightspotError as error:
            plan = None
            row |= {"outcome": "error", "reason": f"{type(error).__name__}: {error}"}
    row |= {"seconds": time.perf_counter() - wall, "processor_seconds": time.process_time() - processor}
    if plan is None and row["seconds"] >= limit:
        row["outcome"] = "time"
    if plan is not None:
        row |= _audit(plan, Path(directory) / "plans" / f"{scene.scenario.name}.json")
    different = {judged.certificate.digest: judged for judged in asked}.values()
    return row | {"judged": [_questioned(judged) for judged in different]}


def _audit(plan: Plan, path: Path) -> dict[str, Any]:
    """The plan as its file says it, replayed; everything that a certified plan must not show is a problem."""
    tightspot.save_plan(plan, path)
    fine = replay(json.loads(path.read_text(encoding="utf-8")))
    certificate = plan.certificate
    promised = certificate.clearance if plan.scenario.obstacles else 0.0
    return {
        "certified_clearance": promised,
        "replay": as_row(fine),
        "problems": fine.problems(max(certificate.margin, promised)),
        "upheld": tightspot.verify_plan(tightspot.load_plan(path)).upheld,
    }


def _questioned(judged: Judged) -> dict[str, Any]:
    fine = replayed(judged)
    return {
        "certified": judged.certificate.certified,
        "replay_clearance": as_row(fine)["clearance"],
        "refusals": refused_for_room(judged, fine),
        "again": judged_again(judged, fine),
    }


def _kind(error: PlanningError) -> str:
    """The planner's own word for what stopped it."""
    return error.explanation.kind.word.replace("-", " ") if error.explanation else "unexplained"


def _facts(report: dict[str, Any]) -> dict[str, Any]:
    rounds = report.get("rounds", [])
    facts: dict[str, Any] = {
        "rounds": len(rounds),
        "iterations": sum(each["solve"]["iterations"] for each in rounds),
        "steps": rounds[-1]["steps"] if rounds else None,
        "guess_seconds": report.get("guess", {}).get("seconds"),
    }
    return facts | {key: report[key] for key in ("duration", "gear_changes") if key in report}
