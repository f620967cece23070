"""One round of planning: transcribe, solve, replay, judge."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot.formulations import Formulation
from tightspot.planner.progress import Progress, ProgressCallback
from tightspot.planner.request import Request
from tightspot.solvers import Iteration, SolveReport
from tightspot.trajectory import Trajectory
from tightspot.transcription import Settings, TimeGrid, Transcription, transcribe
from tightspot.verification import Certificate, verify
from tightspot.verification.replay import Replay, replay

FEASIBLE = 1e-5


@dataclass(frozen=True, eq=False)
class Mesh:
    """What may change from round to round.

    Attributes:
        formulation: How separation is written.
        grid: Knots.
        poses: Sub-intervals of an interval with rows (members that hold on the interval).
        extra: Clearance demanded beyond the margin, m, so that the judge has room to prove the margin.
        active: Pairs in the problem, (N, parts, obstacle parts).
        walls: Edges of W in the problem, (N, parts, edges).
    """

    formulation: Formulation
    grid: TimeGrid
    poses: int
    extra: float
    active: NDArray[np.bool_]
    walls: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Round:
    """A round's outcome.

    Attributes:
        mesh: What was solved.
        report: The solver's.
        trajectory: The replayed trajectory: the inputs integrated from the start, sampled at the knots.
        replay: The continuous motion; ``None`` if the solve failed.
        certificate: The judge's word; ``None`` if the solve failed.
        seconds: Time of set-up, solve and judge.
    """

    mesh: Mesh
    report: SolveReport
    trajectory: Trajectory
    replay: Replay | None
    certificate: Certificate | None
    seconds: float

    @property
    def solved(self) -> bool:
        """True if the last iterate satisfies the constraints, so that it could be judged."""
        return self.certificate is not None

    def to_dict(self) -> dict[str, Any]:
        """Plain data for the report."""
        judged = self.certificate
        return {
            "formulation": self.mesh.formulation.name,
            "steps": self.mesh.grid.steps,
            "poses_per_interval": self.mesh.poses,
            "demanded_clearance_extra": self.mesh.extra,
            "pairs": int(self.mesh.active.sum()),
            "solve": self.report.to_dict(),
            "certified": bool(judged.certified) if judged else False,
            "clearance": judged.clearance if judged and np.isfinite(judged.clearance) else None,
            "witness": str(judged.witness) if judged and judged.witness else None,
            "seconds": self.seconds,
        }


def run_round(
    request: Request, mesh: Mesh, guess: Trajectory, number: int, progress: ProgressCallback, seconds: float
) -> Round:
    """Transcribe onto the mesh, solve from the guess within ``seconds``, replay and judge."""
    started = time.perf_counter()
    pairs = int(mesh.active.sum())
    progress(Progress("solve", f"{mesh.grid.steps} intervals, {pairs} pairs of parts near each other", number))
    transcription = transcribe(
        request.scenario,
        request.vehicle,
        guess,
        _settings(request, mesh),
        grid=mesh.grid,
        active=mesh.active,
        walls=mesh.walls,
    )

    def watch(iteration: Iteration) -> None:
        progress(Progress("solve", f"iteration {iteration.number}", number, iteration))

    report = request.solver.with_time_limit(seconds).solve(transcription.nlp, callback=watch)
    return _judged(request, mesh, transcription, report, number, progress, started)


def _settings(request: Request, mesh: Mesh) -> Settings:
    return Settings(
        objective=request.objective,
        formulation=mesh.formulation,
        margin=request.margin + mesh.extra,
        end_margin=request.margin,
        workspace_margin=mesh.extra,
        substeps=max(2, mesh.poses),
        poses=mesh.poses,
    )


def _judged(
    request: Request,
    mesh: Mesh,
    transcription: Transcription,
    report: SolveReport,
    number: int,
    progress: ProgressCallback,
    started: float,
) -> Round:
    trajectory = transcription.trajectory(np.nan_to_num(report.x))
    motion = certificate = None
    if report.violation <= FEASIBLE and np.isfinite(report.objective):
        progress(Progress("verify", "replaying the inputs and covering all times", number))
        motion = replay(request.vehicle, trajectory)
        trajectory = replace(trajectory, states=_within_bounds(motion.knots, request))
        certificate = verify(request.scenario, request.vehicle, trajectory, margin=request.margin)
    return Round(mesh, report, trajectory, motion, certificate, time.perf_counter() - started)


def _within_bounds(states: NDArray[np.float64], request: Request) -> NDArray[np.float64]:
    """The states with rounding errors beyond a bound (below 1e-9) put back onto it."""
    low, high = request.vehicle.state_bounds
    clipped = np.clip(states, low, high)
    return np.where(np.abs(clipped - states) < 1e-9, clipped, states)
