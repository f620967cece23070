"""What the picture of a judged motion is about: the motion, densely sampled, and its worst moment."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tightspot.plotting import style
from tightspot.plotting.captions import floor_mm
from tightspot.plotting.motion import dense_motion
from tightspot.scenarios import Scenario
from tightspot.trajectory import Trajectory
from tightspot.vehicles import VehicleModel
from tightspot.verification import Certificate, Plan, TableVerdict
from tightspot.verification.certificate import Witness
from tightspot.verification.dense import ClearanceSeries, clearance_series
from tightspot.verification.tables.motion import RowMotion

Array = NDArray[np.float64]

_SAMPLES = 1500


@dataclass(frozen=True, eq=False)
class Judged:
    """What the picture shows of a judged motion.

    Attributes:
        scenario: Where it was judged.
        vehicle: With what.
        motion: Densely sampled; its times may be lengths driven.
        series: Clearance at the samples.
        axis: Label of the curve's horizontal axis.
        pose: The body's at the worst moment, (3,).
        at: When that is, on the curve's axis.
        obstacle: What is touched or nearest then, ``workspace`` included; empty if the moment is about something else.
        sentence: What happens then.
        upheld: Whether nothing speaks against the motion.
        margin: Demanded clearance, m.
        directions: Whether heading and direction of motion are to be compared.
        rows: Positions (M, 2) that were given, if they are to be seen in the detail.
    """

    scenario: Scenario
    vehicle: VehicleModel
    motion: Trajectory
    series: ClearanceSeries
    axis: str
    pose: Array
    at: float
    obstacle: str
    sentence: str
    upheld: bool
    margin: float
    directions: bool = False
    rows: Array | None = None

    @property
    def color(self) -> str:
        """Of the moment."""
        return style.GOOD if self.upheld else style.BAD


def of_table(verdict: TableVerdict) -> Judged:
    """The worst moment of somebody's table."""
    count = len(verdict.poses)
    rows = np.union1d(np.linspace(0, count - 1, min(max(count, 600), _SAMPLES)), _moments(verdict))
    motion = RowMotion.of(verdict.vehicle, verdict.poses, extent=0.0)
    poses, place = motion.at(rows), verdict.place
    axis, at = _axis(verdict, rows)
    witness = _worst(verdict)
    fault = verdict.failed[0] if verdict.failed and witness is None else None
    if witness is not None:
        row, obstacle, pose = witness.time, witness.obstacle, np.array(witness.pose)
        clearance = verdict.clearances.interpolated.clearance
        sentence = verdict.sentence(witness)
        if verdict.upheld:
            sentence = f"clearance ≥ {floor_mm(clearance)} m between all rows, too; least {place.words(row)}"
    else:
        row = fault.row if fault is not None and fault.row is not None else 0.0
        obstacle, pose = "", motion.at(np.array([row]))[0]
        sentence = fault.sentence if fault is not None else "free: there is nothing to touch"
    return Judged(
        scenario=verdict.scenario,
        vehicle=verdict.vehicle,
        motion=_driven(poses, at),
        series=clearance_series(verdict.scenario, verdict.vehicle, poses, at),
        axis=axis,
        pose=pose,
        at=float(np.interp(row, rows, at)),
        obstacle=obstacle,
        sentence=sentence,
        upheld=verdict.upheld,
        margin=verdict.margin,
        directions=fault is not None and fault.group == "kinematics",
        rows=verdict.poses[:, :2],
    )


def of_plan(plan: Plan, certificate: Certificate) -> Judged:
    """The worst moment of a plan's trajectory, which got that certificate in the plan's scenario."""
    motion = dense_motion(plan.vehicle, plan.trajectory)
    series = clearance_series(plan.scenario, plan.vehicle, motion.states, motion.t)
    witness = certificate.witness
    failed = certificate.failed
    if witness is not None:
        at, pose, obstacle, sentence = witness.time, np.array(witness.pose), witness.obstacle, str(witness)
    else:
        at = float(series.t[series.worst])
        pose, obstacle = motion.states[series.worst, :3], series.obstacle[series.worst]
        sentence = failed[0].sentence if failed else "certified for all times: nothing to touch"
        if not failed and obstacle:
            sentence = (
                f"certified for all times: clearance ≥ {floor_mm(certificate.clearance)} m; least at t = {at:.2f} s"
            )
    upheld = certificate.certified
    axis = "time (s)"
    return Judged(
        plan.scenario,
        plan.vehicle,
        motion,
        series,
        axis,
        pose,
        at,
        obstacle if upheld or witness else "",
        sentence,
        upheld,
        certificate.margin,
    )


def _moments(verdict: TableVerdict) -> Array:
    return np.array([witness.time for witness in verdict.witnesses[:20]], dtype=float)


def _worst(verdict: TableVerdict) -> Witness | None:
    """What the picture is about: a collision, else one on arcs, else the nearest approach if nothing else is wrong."""
    for reading in (verdict.clearances.interpolated, verdict.clearances.arcs):
        if reading.moments:
            return reading.moments[0]
    return verdict.clearances.interpolated.nearest if verdict.upheld else None


def _axis(verdict: TableVerdict, rows: Array) -> tuple[str, Array]:
    """Label and values of the curve's axis at the samples; strictly increasing."""
    place = verdict.place
    index = np.arange(len(verdict.poses))
    if place.t is not None:
        return "time (s)", np.interp(rows, index, place.t)
    standing = 1e-9 * np.arange(rows.size)  # rows at the same place must not share a place on the axis
    return "length driven (m)", np.interp(rows, index, place.driven) + standing


def _driven(poses: Array, at: Array) -> Trajectory:
    """The samples as a trajectory whose speeds have the sign of the motion along the heading."""
    step, middle = np.diff(poses, axis=0), 0.5 * (poses[1:, 2] + poses[:-1, 2])
    along = np.cos(middle) * step[:, 0] + np.sin(middle) * step[:, 1]
    speed = np.concatenate([along[:1], 0.5 * (along[1:] + along[:-1]), along[-1:]])
    states = np.column_stack([poses, speed, np.zeros(len(poses))])
    return Trajectory(at, states, np.zeros((len(poses) - 1, 2)))
