"""The judge: is this trajectory safe at all times? If so, here is the proof; if not, here is the moment."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem, is_number, shown
from tightspot.scenarios import Scenario
from tightspot.trajectory import Trajectory
from tightspot.vehicles import VehicleModel
from tightspot.verification.barriers import ObstaclePairs, WorkspacePairs
from tightspot.verification.certificate import (
    Certificate,
    Check,
    Integration,
    digest,
    package_version,
    rounded_down,
)
from tightspot.verification.checks import Limits, motion_checks
from tightspot.verification.cover import Cover, cover
from tightspot.verification.file_exact import file_exact
from tightspot.verification.motion import ReplayedMotion
from tightspot.verification.proofs import ObstacleParts, PairProofs, WorkspaceProofs
from tightspot.verification.replay import METHOD, Replay, replay
from tightspot.verification.witnesses import WORKSPACE_SLACK, obstacle_witnesses, workspace_witnesses

Array = NDArray[np.float64]
Index = NDArray[np.intp]


@dataclass(frozen=True)
class JudgeSettings:
    """How hard the judge works. None of it changes what a certificate means.

    Attributes:
        tolerance: Of the integration, m and rad; counted against every clearance.
        resolution: The proved clearance is brought within this of the true one, m.
        floor: Intervals that are still undecided below this length are given up, s.
        limits: What the other checks allow.
        in_core: The compiled judge, if it knows the vehicle's model; otherwise NumPy, by the same steps.
    """

    tolerance: float = 1e-7
    resolution: float = 1e-3
    floor: float = 1e-5
    limits: Limits = field(default_factory=Limits)
    in_core: bool = True


def verify(
    scenario: Scenario,
    vehicle: VehicleModel,
    trajectory: Trajectory,
    *,
    margin: float = 0.0,
    settings: JudgeSettings | None = None,
    known: Replay | None = None,
) -> Certificate:
    """Judge the continuous trajectory: the inputs integrated from the first state, at all times of the
    horizon.

    For every body part and obstacle part the horizon is covered by intervals that carry one separating line
    each; the lemma of :mod:`tightspot.verification.motion` proves a clearance on the whole interval. The same
    lemma holds the body inside the workspace (on its boundary it may lie: 1e-6 m are allowed). Then dynamics
    defect, bounds, start and goal are checked. If the scenario has an offset, everything is first rounded to
    what a plan file can say of it (:mod:`tightspot.verification.file_exact`).

    Args:
        scenario: In its recentred coordinates, as all arguments.
        vehicle: Its dynamics, bounds and body count, whatever vehicle the scenario names.
        trajectory: The motion to judge.
        margin: Demanded clearance, m.
        settings: See :class:`JudgeSettings`.
        known: A :func:`~tightspot.verification.replay.replay` that was made before; see there.

    Returns:
        A certificate with ``certified`` true and the proof, or with the failed checks and the witnesses.

    Raises:
        InputError: The trajectory does not fit the vehicle or cannot be integrated, or the margin is no
            length.
    """
    settings = settings or JudgeSettings()
    if not (is_number(margin) and 0 <= margin < np.inf):
        raise InputError(Problem("margin", f"{shown(margin)} m must be a finite length, 0 or more"))
    scenario, trajectory = file_exact(scenario, trajectory)
    played = replay(vehicle, trajectory, tolerance=settings.tolerance, in_core=settings.in_core, known=known)
    names, polygons = scenario.part_names, scenario.obstacle_polygons
    motion = ReplayedMotion.of(played, extent=max(_extent(scenario.workspace.vertices), _extent(polygons.vertices)))
    pairs, walls = (
        ObstaclePairs(len(vehicle.parts), polygons),
        WorkspacePairs(len(vehicle.parts), scenario.workspace),
    )
    work = {"resolution": settings.resolution, "floor": settings.floor}
    clear, inside = cover(motion, pairs, margin, **work), cover(motion, walls, -WORKSPACE_SLACK, **work)
    witnesses = [
        *obstacle_witnesses(motion, pairs, clear, margin, names),
        *workspace_witnesses(motion, walls, inside),
    ]
    checks = [_obstacle_check(clear, margin), _workspace_check(inside)]
    checks += motion_checks(scenario, played, settings.limits)
    certificate = Certificate(
        certified=all(check.passed for check in checks),
        margin=float(margin),
        clearance=clear.clearance,
        witnesses=tuple(sorted(witnesses, key=lambda witness: witness.clearance)),
        checks=tuple(checks),
        obstacles=ObstacleParts(scenario),
        pairs=PairProofs(motion, pairs, clear, names),
        workspace=WorkspaceProofs(motion, walls, inside),
        integration=Integration(METHOD, played.nodes.size - 1, played.position_error, played.heading_error),
        offset=(float(scenario.offset[0]), float(scenario.offset[1])),
        version=package_version(),
    )
    object.__setattr__(certificate, "digest", _Seal(certificate, scenario, vehicle, trajectory))
    return certificate


@dataclass(frozen=True)
class _Seal:
    """The digest of a certificate and what it is about, when it is asked for."""

    certificate: Certificate
    scenario: Scenario
    vehicle: VehicleModel
    trajectory: Trajectory

    def __call__(self) -> str:
        written = self.trajectory.shifted(self.certificate.offset).to_dict()
        unsealed = replace(self.certificate, digest="")
        return digest(self.scenario.to_dict(), self.vehicle.to_dict(), written, unsealed.to_dict())


def _extent(vertices: Array) -> float:
    """Largest absolute coordinate, m; zero without vertices."""
    return float(max(vertices.max(initial=0.0), -vertices.min(initial=0.0)))


def _obstacle_check(clear: Cover, margin: float) -> Check:
    proved, passed = clear.clearance, bool(clear.holds.all())
    worst = float(clear.seen.min(initial=np.inf))
    return Check("obstacles", passed, proved, float(margin), partial(_of_obstacles, passed, proved, worst, margin))


def _of_obstacles(passed: bool, proved: float, worst: float, margin: float) -> str:
    if not passed:
        return f"clearance of obstacles is {worst:.4f} m at worst (demanded {margin:.4g} m)"
    if np.isinf(proved):
        return "there are no obstacles"
    return f"clearance of obstacles is at least {rounded_down(proved)} m at all times (demanded {margin:.4g} m)"


def _workspace_check(inside: Cover) -> Check:
    proved, passed = inside.clearance, bool(inside.holds.all())
    worst = float(inside.seen.min(initial=np.inf))
    return Check("workspace", passed, proved, -WORKSPACE_SLACK, partial(_of_workspace, passed, proved, worst))


def _of_workspace(passed: bool, proved: float, worst: float) -> str:
    if passed:
        return f"the body stays {rounded_down(max(0.0, proved))} m inside the workspace at all times"
    return f"the body leaves the workspace by {-worst:.4g} m"
