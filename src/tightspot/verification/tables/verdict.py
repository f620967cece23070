"""The verdict about a table: is it free of collisions, does it fit the vehicle, does it lead to the goal."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem, is_number, shown
from tightspot.scenarios import Scenario
from tightspot.scenarios.labels import labels
from tightspot.vehicles import SingleTrack, VehicleModel
from tightspot.verification.certificate import Witness
from tightspot.verification.tables.clearance import Clearances, clearances
from tightspot.verification.tables.collisions import (
    COLLIDES,
    FREE,
    UNDECIDED,
    clearance_findings,
    collision,
    moment_sentence,
)
from tightspot.verification.tables.consistency import Tolerances, consistency
from tightspot.verification.tables.ends import ends
from tightspot.verification.tables.findings import Finding, Place, finite
from tightspot.verification.tables.heading import headings
from tightspot.verification.tables.limits import limits
from tightspot.verification.tables.scores import Scores, table_scores
from tightspot.verification.tables.steps import Steps
from tightspot.verification.tables.table import Table

Array = NDArray[np.float64]

_MOST_LINES = 5
_ROUGH = 0.1
"""If sampling explains more side slip than this share of the way, the table is called coarse."""
_COLLISIONS = {
    FREE: "collision-free: proved for the interpolated motion at all times",
    COLLIDES: "collision: the interpolated motion collides",
    UNDECIDED: "collision: not decided, the interpolated motion touches or nearly does",
}


@dataclass(frozen=True, eq=False)
class TableVerdict:
    """What the judge says about a table.

    Attributes:
        scenario: Where it was judged.
        vehicle: With what.
        table: What was judged.
        poses: Its poses in the scenario's recentred coordinates, without jumps of the heading, m and rad, (M, 3).
        margin: Demanded clearance, m.
        collision: ``free`` (proved for the interpolated motion at all times), ``collides`` (a witness says when) or
            ``undecided``.
        clearances: What was proved and seen of the clearance, in both readings.
        findings: Everything that was checked, in a fixed order.
        scores: Its costs.
        notes: How it was read and what was assumed.
    """

    scenario: Scenario
    vehicle: SingleTrack
    table: Table
    poses: Array
    margin: float
    collision: str
    clearances: Clearances
    findings: tuple[Finding, ...]
    scores: Scores
    notes: tuple[str, ...]

    @property
    def upheld(self) -> bool:
        """Whether nothing speaks against it: everything that this table allows to judge has passed."""
        return all(finding.passed is not False for finding in self.findings)

    @property
    def failed(self) -> tuple[Finding, ...]:
        """What speaks against it."""
        return tuple(finding for finding in self.findings if finding.passed is False)

    @property
    def witnesses(self) -> tuple[Witness, ...]:
        """The worst moment of each pair that keeps not clear, the worst first; their times are rows, see ``place``."""
        return self.clearances.interpolated.moments

    @cached_property
    def place(self) -> Place:
        """Where in the table a row is."""
        return Place.of(self.table)

    def finding(self, name: str) -> Finding:
        """The finding of that name; raises ``KeyError`` if there is none."""
        for finding in self.findings:
            if finding.name == name:
                return finding
        raise KeyError(name)

    def summary(self) -> list[str]:
        """Lines for people: the verdict, then what speaks against it, then everything else."""
        marks = {True: "ok", False: "FAILED", None: "-"}
        head = "the trajectory is upheld" if self.upheld else "the trajectory is NOT upheld"
        ordered = sorted(self.findings, key=lambda finding: finding.passed is not False)
        lines = [head, _COLLISIONS[self.collision]]
        lines += [f"{marks[finding.passed]:6s} {finding.sentence}" for finding in ordered]
        lines += [f"witness: {self.sentence(witness)}" for witness in self.witnesses[:_MOST_LINES]]
        if len(self.witnesses) > _MOST_LINES:
            lines.append(f"and {len(self.witnesses) - _MOST_LINES} more pairs")
        return [*lines, *self.scores.summary(), *(f"note: {note}" for note in self.notes)]

    def sentence(self, witness: Witness) -> str:
        """A moment for people."""
        return moment_sentence(witness, self.scenario, self.place)

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON, in the coordinates of the scene's file; see the documentation for the keys."""
        interpolated, arcs = self.clearances.interpolated, self.clearances.arcs
        return {
            "status": "upheld" if self.upheld else "not-upheld",
            "kind": "table",
            "collision": self.collision,
            "margin": self.margin,
            "clearance": finite(interpolated.clearance),
            "nearest": None if interpolated.nearest is None else self._moment(interpolated.nearest),
            "witnesses": [self._moment(witness) for witness in interpolated.moments],
            "arcs": {
                "collision": collision(arcs),
                "clearance": finite(arcs.clearance),
                "apart": self.clearances.apart,
                "witnesses": [self._moment(witness) for witness in arcs.moments],
            },
            "checks": [finding.to_dict(self.place) for finding in self.findings],
            "reasons": [finding.sentence for finding in self.failed],
            "scores": self.scores.to_dict(),
            "scene": self.scenario.name,
            "vehicle": self.vehicle.name,
            "table": {
                "source": self.table.source,
                "rows": self.table.rows,
                "columns": {key: self.table.names.get(key, key) for key in self.table.columns},
                "rounding": dict(self.table.rounding),
            },
            "notes": list(self.notes),
        }

    def _moment(self, witness: Witness) -> dict[str, Any]:
        x, y = np.asarray(witness.pose[:2]) + self.scenario.offset
        return {
            "where": self.place.to_dict(witness.time),
            "part": witness.part,
            "obstacle": labels(self.scenario).get(witness.obstacle, witness.obstacle),
            "obstacle_part": witness.obstacle,
            "clearance": witness.clearance,
            "penetration": witness.penetration,
            "pose": [float(x), float(y), witness.pose[2]],
            "kind": witness.kind,
            "sentence": self.sentence(witness),
        }


def judge_table(
    scenario: Scenario,
    vehicle: VehicleModel,
    table: Table,
    *,
    margin: float = 0.0,
    tolerances: Tolerances | None = None,
) -> TableVerdict:
    """Judge somebody's trajectory: collisions at all times, kinematics, limits, start and goal.

    The motion between the rows is interpolated: x, y and the heading (without jumps) run linearly from row to row. For
    this motion the clearance is *proved*, not sampled. It is proved again for a vehicle that drives circular arcs
    between the rows; both must be free.

    Args:
        scenario: What must not be touched, and where start and goal are.
        vehicle: Its body, wheelbase and limits, whatever vehicle the scenario names.
        table: In the coordinates of the scene's *file*, see :func:`read_table`.
        margin: Demanded clearance, m; 0 asks for no collision only.
        tolerances: What is allowed beyond sampling and rounding.

    Raises:
        InputError: The margin is no length, the vehicle is no single-track model, or headings are missing and cannot
            be told from the positions.
    """
    if not (is_number(margin) and 0 <= margin < np.inf):
        raise InputError(Problem("margin", f"{shown(margin)} m must be a finite length, 0 or more"))
    if not isinstance(vehicle, SingleTrack):
        raise InputError(Problem("vehicle", "tables are judged for single-track vehicles only"))
    tolerances = tolerances or Tolerances()
    poses, notes = _poses(scenario, table)
    found = clearances(scenario, vehicle, poses, margin)
    place, steps = Place.of(table), Steps.of(table, poses, vehicle)
    if steps.across_error.sum() > _ROUGH * steps.length.sum():
        notes.append("rows are so far apart that much may happen in between: kinematics are judged only roughly")
    findings = [
        *clearance_findings(found, scenario, place, margin),
        *consistency(steps, place, tolerances),
        *limits(steps, place, tolerances),
        *ends(scenario, steps, poses),
    ]
    return TableVerdict(
        scenario=scenario,
        vehicle=vehicle,
        table=table,
        poses=poses,
        margin=float(margin),
        collision=collision(found.interpolated),
        clearances=found,
        findings=tuple(findings),
        scores=table_scores(steps, place),
        notes=(*table.notes, *notes),
    )


def _poses(scenario: Scenario, table: Table) -> tuple[Array, list[str]]:
    """The poses in recentred coordinates, and what was assumed."""
    x, y = table.columns["x"] - scenario.offset[0], table.columns["y"] - scenario.offset[1]
    theta, notes = table.get("theta"), []
    if theta is None:
        rounding = float(np.hypot(table.rounding.get("x", 0.0), table.rounding.get("y", 0.0)))
        theta = headings(x, y, float(scenario.start[2]), rounding)
        notes.append("there is no column of headings: they are the directions of motion")
    if table.get("t") is None:
        notes.append("there are no times: collisions and curvature are judged along the path, nothing that takes time")
    return np.column_stack([x, y, theta]), notes
