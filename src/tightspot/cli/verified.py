"""What ``tightspot verify`` says about a plan file and about a table: for people, for programs, and as a picture."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from tightspot.cli.summary import certificate_facts
from tightspot.errors import InputError, Problem

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tightspot.scenarios import Scenario
    from tightspot.vehicles import VehicleModel
    from tightspot.verification import Certificate, Plan, Table


_T = TypeVar("_T")


@dataclass(frozen=True)
class Judgement:
    """An answer.

    Attributes:
        upheld: Whether nothing speaks against the trajectory.
        lines: For people.
        facts: For programs.
        figure: Draws the worst moment.
    """

    upheld: bool
    lines: list[str]
    facts: dict[str, Any]
    figure: Callable[[], Figure]


def judged_plan(path: Path, scene: str | None, vehicle: str | None, margin: float | None) -> Judgement:
    """A plan file in its own scene, or its trajectory in another scene, with another vehicle, for another margin."""
    from dataclasses import replace

    from tightspot.verification import load_plan, plan_scores, verify_plan

    plan = load_plan(path)
    scores = plan_scores(plan)
    if scene is None and vehicle is None and margin is None:
        verdict = verify_plan(plan)
        upheld, judged, lines = verdict.upheld, verdict.certificate, verdict.summary()
        stored, reasons = verdict.stored.ok, list(verdict.stored.reasons)
    else:
        plan = elsewhere(plan, scene, vehicle)
        judged = _anew(plan, margin)
        upheld, stored, reasons = judged.certified, None, []
        head = "the plan's trajectory is upheld" if upheld else "the plan's trajectory is NOT upheld"
        lines = [head, *judged.summary(), "the stored certificate was not asked: it is about what the file says"]
    facts = {
        "status": "upheld" if upheld else "not-upheld",
        "kind": "plan",
        "collision": _collision(judged),
        "margin": judged.margin,
        "clearance": _finite(judged.clearance),
        "certificate": certificate_facts(plan.certificate),
        "stored_certificate_proves_its_claim": stored,
        "reasons": reasons,
        "judged_anew": {
            **certificate_facts(judged),
            "failed": [check.sentence for check in judged.failed],
            "checks": [asdict(check) | {"value": _finite(check.value)} for check in judged.checks],
            "witnesses": [_witness(plan.scenario, witness) for witness in judged.witnesses],
        },
        "scores": scores.to_dict(),
        "scene": plan.scenario.name,
        "vehicle": plan.vehicle.name,
    }

    def figure() -> Figure:
        from tightspot.plotting import figure_judged_plan

        return figure_judged_plan(replace(plan, certificate=judged), judged)

    return Judgement(upheld, [*lines, *scores.summary()], facts, figure)


def judged_table(
    path: Path, scene: str | None, vehicle: str | None, margin: float | None, columns: Sequence[str] | None
) -> Judgement:
    """A table in a scene."""
    from tightspot.verification import judge_table

    scenario, car, table = _read(path, scene, vehicle, columns)
    verdict = judge_table(scenario, car, table, margin=0.0 if margin is None else margin)

    def figure() -> Figure:
        from tightspot.plotting import figure_judged_table

        return figure_judged_table(verdict)

    return Judgement(verdict.upheld, verdict.summary(), verdict.to_dict(), figure)


def _read(
    path: Path, scene: str | None, vehicle: str | None, columns: Sequence[str] | None
) -> tuple[Scenario, VehicleModel, Table]:
    """Scene, vehicle and table; what is wrong with any of them is told at once."""
    from tightspot.scenarios import load
    from tightspot.vehicles import load_vehicle
    from tightspot.verification import read_table

    problems: list[Problem] = []
    table = _tried(lambda: read_table(path, columns=columns), problems)
    scenario = None
    if scene is None:
        sentence = "is missing: a table does not say what is around; give a built-in scene or a scene file"
        problems.append(Problem("--scene", sentence))
    else:
        scenario = _tried(lambda: load(scene), problems)
    car: VehicleModel | None = None
    if vehicle is not None:
        car = _tried(lambda: load_vehicle(vehicle), problems)
    elif scenario is not None:
        car = _tried(scenario.vehicle_model, problems)
    if problems or scenario is None or car is None or table is None:
        raise InputError(problems)
    return scenario, car, table


def _tried(read: Callable[[], _T], problems: list[Problem]) -> _T | None:
    try:
        return read()
    except InputError as error:
        problems += error.problems
    return None


def elsewhere(plan: Plan, scene: str | None, vehicle: str | None) -> Plan:
    """The plan's trajectory in another scene or with another vehicle; its certificate is none for that."""
    from tightspot.scenarios import load
    from tightspot.vehicles import load_vehicle
    from tightspot.verification import Plan

    scenario = plan.scenario if scene is None else load(scene)
    car = plan.vehicle if vehicle is None else load_vehicle(vehicle)
    trajectory = plan.trajectory.shifted(np.asarray(plan.scenario.offset) - scenario.offset)
    return Plan(scenario, car, trajectory, plan.certificate, plan.report)


def _anew(plan: Plan, margin: float | None) -> Certificate:
    from tightspot.verification import JudgeSettings, verify

    demanded = max(0.0, plan.certificate.margin) if margin is None else margin
    settings = JudgeSettings(in_core=False)
    return verify(plan.scenario, plan.vehicle, plan.trajectory, margin=demanded, settings=settings)


def _collision(judged: Certificate) -> str:
    """``free``, ``collides`` or ``undecided``, as for tables."""
    from tightspot.verification.certificate import WORKSPACE

    if any(witness.kind == "collision" and witness.obstacle != WORKSPACE for witness in judged.witnesses):
        return "collides"
    return "free" if judged.check("obstacles").value >= 0 else "undecided"


def _witness(scenario: Scenario, witness: Any) -> dict[str, Any]:
    """A witness with its pose in the coordinates of the scene's file."""
    x, y, theta = witness.pose
    pose = [x + float(scenario.offset[0]), y + float(scenario.offset[1]), theta]
    return {**asdict(witness), "pose": pose, "penetration": witness.penetration, "sentence": str(witness)}


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
