"""Everything the judge was asked while a plan was made, and whether its refusals were right."""

from __future__ import annotations

import dataclasses
import math
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import tightspot.planner
from benchmarks.replay import Replay, replay
from tightspot import verification
from tightspot.scenarios import Scenario
from tightspot.trajectory import Trajectory
from tightspot.vehicles import VehicleModel
from tightspot.verification import Certificate, Plan

SLACK = 1e-3
"""A refusal for want of clearance is a false alarm if the replay finds this much more than was demanded, m."""
BESIDE = 1.1e-3
"""A trajectory judged again must be certified for the replay's clearance less this, m."""


@dataclass(frozen=True, eq=False)
class Judged:
    """One question to the judge and its answer."""

    scenario: Scenario
    vehicle: VehicleModel
    trajectory: Trajectory
    margin: float
    certificate: Certificate


@contextmanager
def recorded() -> Iterator[list[Judged]]:
    """Within the block, every trajectory that the planner has judged is kept in the list."""
    kept: list[Judged] = []
    prefix = tightspot.planner.__name__

    def verify(
        scenario: Scenario, vehicle: VehicleModel, trajectory: Trajectory, *, margin: float = 0.0, **others: Any
    ) -> Certificate:
        answer = verification.verify(scenario, vehicle, trajectory, margin=margin, **others)
        kept.append(Judged(scenario, vehicle, trajectory, margin, answer))
        return answer

    places = [
        module
        for name, module in list(sys.modules.items())
        if name.startswith(prefix) and getattr(module, "verify", None) is verification.verify
    ]
    if not places:
        raise RuntimeError("no module of the planner asks tightspot.verification.verify; nothing can be recorded")
    for module in places:
        module.verify = verify  # type: ignore[attr-defined]
    try:
        yield kept
    finally:
        for module in places:
            module.verify = verification.verify  # type: ignore[attr-defined]


def replayed(judged: Judged) -> Replay:
    """The 1 ms replay of a judged trajectory, from what a plan file would say of it."""
    return replay(Plan(judged.scenario, judged.vehicle, judged.trajectory, judged.certificate).to_dict())


def refused_for_room(judged: Judged, fine: Replay) -> list[dict[str, Any]]:
    """For each of the judge's two refusals about room: by how much the replay finds more than was demanded."""
    rooms = {"obstacles": fine.clearance - judged.margin, "workspace": fine.room}
    failed = [check.name for check in judged.certificate.checks if not check.passed]
    return [
        {"about": name, "beyond": _number(rooms[name]), "false_alarm": rooms[name] > SLACK}
        for name in rooms
        if name in failed
    ]


def judged_again(judged: Judged, fine: Replay) -> dict[str, Any] | None:
    """The judge's word for a margin just below the replay's clearance; ``None`` if there is no room to ask."""
    margin = fine.clearance - BESIDE
    if not 0 <= margin < math.inf:
        return None
    answer = verification.verify(judged.scenario, judged.vehicle, judged.trajectory, margin=margin)
    passed = next(check.passed for check in answer.checks if check.name == "obstacles")
    return {"margin": margin, "certified": passed}


def as_row(fine: Replay) -> dict[str, Any]:
    """The replay without its list of times, as plain data."""
    facts = {**dataclasses.asdict(fine), "overlaps": len(fine.overlaps)}
    return {key: _number(value) for key, value in facts.items()}


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None
