"""From clearances to findings and sentences: free, colliding or undecided, by which obstacle and when."""

from __future__ import annotations

import math

from tightspot.scenarios import Scenario
from tightspot.scenarios.labels import labels
from tightspot.verification.certificate import WORKSPACE, Witness, metres, rounded_down
from tightspot.verification.tables.clearance import Clearances, Reading
from tightspot.verification.tables.findings import Finding, Place
from tightspot.verification.witnesses import WORKSPACE_SLACK

GROUP = "clearance"
FREE, COLLIDES, UNDECIDED = "free", "collides", "undecided"

_SAME = 1e-4
"""Readings that are not further apart than this, m, need no second sentence."""


def collision(reading: Reading) -> str:
    """``free`` if that is proved for all times, ``collides`` if a moment shows it, else ``undecided``."""
    if any(moment.kind == "collision" for moment in reading.obstacles):
        return COLLIDES
    return FREE if reading.clearance >= 0 else UNDECIDED


def clearance_findings(found: Clearances, scenario: Scenario, place: Place, margin: float) -> list[Finding]:
    """Obstacles, workspace, and both once more on arcs."""
    return [
        _obstacles(found.interpolated, scenario, place, margin),
        _workspace(found.interpolated, scenario, place),
        _arcs(found, scenario, place, margin),
    ]


def moment_sentence(moment: Witness, scenario: Scenario, place: Place) -> str:
    """What happens at a moment, whose time is a row."""
    where, name = place.words(moment.time), labels(scenario).get(moment.obstacle, moment.obstacle)
    if moment.obstacle == WORKSPACE:
        return f"{moment.part} leaves the workspace by {metres(moment.penetration)} m {where}"
    if moment.kind == "collision":
        return f"{moment.part} overlaps {name} by {metres(moment.penetration)} m {where}"
    if moment.kind == "undecided":
        return f"{moment.part} is {moment.clearance:.9f} m from {name} {where}: too near to decide"
    return f"{moment.part} is only {metres(moment.clearance)} m from {name} {where}"


def _obstacles(reading: Reading, scenario: Scenario, place: Place, margin: float) -> Finding:
    demanded = f"demanded {margin:.4g} m"
    if reading.obstacles:
        worst = reading.obstacles[0]
        sentence = f"obstacles: {moment_sentence(worst, scenario, place)} ({demanded})"
        return Finding("obstacles", GROUP, False, sentence, worst.clearance, margin, "m", worst.time)
    if math.isinf(reading.clearance):
        return Finding("obstacles", GROUP, True, "obstacles: there are none", None, margin, "m")
    sentence = f"obstacles: the clearance is at least {rounded_down(reading.clearance)} m at all times"
    row = None
    if reading.nearest is not None:
        row = reading.nearest.time
        name = labels(scenario).get(reading.nearest.obstacle, reading.nearest.obstacle)
        sentence += f", least {place.words(row)} to {name}"
    return Finding("obstacles", GROUP, True, f"{sentence} ({demanded})", reading.clearance, margin, "m", row)


def _workspace(reading: Reading, scenario: Scenario, place: Place) -> Finding:
    if reading.workspace:
        worst = reading.workspace[0]
        sentence = f"workspace: {moment_sentence(worst, scenario, place)}"
        return Finding("workspace", GROUP, False, sentence, worst.clearance, -WORKSPACE_SLACK, "m", worst.time)
    inside = rounded_down(max(0.0, reading.inside))
    sentence = f"workspace: the body stays {inside} m inside at all times"
    return Finding("workspace", GROUP, True, sentence, reading.inside, -WORKSPACE_SLACK, "m")


def _arcs(found: Clearances, scenario: Scenario, place: Place, margin: float) -> Finding:
    """What a vehicle would do that drives arcs between the rows instead."""
    straight, arcs = found.interpolated, found.arcs
    apart = f"on circular arcs between the rows, at most {found.apart:.2g} m away"
    if not arcs.moments:
        value = None if math.isinf(arcs.clearance) else arcs.clearance
        least = "nothing is touched" if value is None else f"the clearance is at least {rounded_down(value)} m"
        if straight.moments and found.apart > _SAME:
            least += ": these rows are too far apart to tell; give the table more of them"
        return Finding("arcs", GROUP, True, f"arcs: {apart}, {least}", value, margin, "m")
    worst = arcs.moments[0]
    sentence = f"arcs: {apart}, {moment_sentence(worst, scenario, place)}"
    if not straight.moments:
        sentence += "; give the table more rows"
    return Finding("arcs", GROUP, False, sentence, worst.clearance, margin, "m", worst.time)
