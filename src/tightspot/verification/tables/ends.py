"""How far the table begins from the scene's start, and ends from its goal."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tightspot.scenarios import Scenario
from tightspot.verification.tables.findings import Finding, not_judged
from tightspot.verification.tables.steps import Steps

Array = NDArray[np.float64]


def ends(scenario: Scenario, steps: Steps, poses: Array) -> list[Finding]:
    """Position, heading and speed at both ends within the scene's tolerances; the steering angle is only told.

    Headings are compared modulo whole turns. Rounding is added to the tolerances, and where the heading is the
    direction of motion also how far it may turn on a step. What the scene leaves free is not asked for.
    """
    findings = []
    for group, wanted, row in (("start", scenario.start, 0), ("goal", scenario.goal, len(poses) - 1)):
        findings += _end(scenario, steps, poses[row], group, wanted, row)
    return findings


def _end(scenario: Scenario, steps: Steps, pose: Array, group: str, wanted: Array, row: int) -> list[Finding]:
    tolerance = scenario.tolerance
    distance = float(np.hypot(*(pose[:2] - wanted[:2])))
    turn = float(pose[2] - wanted[2])
    turn = abs(turn - 2 * np.pi * round(turn / (2 * np.pi)))
    found = [
        _finding(f"{group} position", group, distance, tolerance.position + steps.xy, "m", row),
        _finding(f"{group} heading", group, turn, tolerance.heading + steps.heading_blur, "rad", row),
    ]
    column = steps.table.get("v")
    if column is None:
        found.append(not_judged(f"{group} speed", group, "there is no column of speeds"))
    elif not np.isnan(wanted[3]):
        gap = abs(float(column[row] - wanted[3]))
        found.append(_finding(f"{group} speed", group, gap, tolerance.speed + steps.rounding("v"), "m/s", row))
    column = steps.table.get("delta")
    if column is not None and not np.isnan(wanted[4]):
        gap = abs(float(column[row] - wanted[4]))
        sentence = f"{group} steering: {gap:.4g} rad from the scene's, which is told but not judged"
        found.append(Finding(f"{group} steering", group, None, sentence, gap, None, "rad", float(row)))
    return found


def _finding(name: str, group: str, value: float, limit: float, unit: str, row: int) -> Finding:
    sentence = f"{name}: {value:.4g} {unit} from the scene's (at most {limit:.4g})"
    return Finding(name, group, value <= limit, sentence, value, limit, unit, float(row))
