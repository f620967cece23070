"""One round of planning: transcribe, solve, verify; and what to change if the judge does not agree."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot.planner.pairs import replay_clearance
from tightspot.planner.progress import Progress, ProgressCallback
from tightspot.planner.request import Request
from tightspot.solvers import Iteration, SolveReport
from tightspot.trajectory import Trajectory
from tightspot.transcription import Settings, TimeGrid, Transcription, transcribe
from tightspot.verification import Certificate, verify
from tightspot.verification.replay import Replay, replay

REACH = 3.0
MOST_STEPS = 240
SAMPLES = 12
FEASIBLE = 1e-5


@dataclass(frozen=True, eq=False)
class Mesh:
    """What may change from round to round.

    Attributes:
        grid: Knots.
        poses: Sub-intervals of an interval with rows (members that hold on the interval).
        extra: Clearance demanded beyond the margin, m, so that the judge has room to prove the margin.
        active: Pairs in the problem, (N, parts, obstacle parts).
    """

    grid: TimeGrid
    poses: int
    extra: float
    active: NDArray[np.bool_]


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
        """True if the solver found a point that satisfies the constraints."""
        return self.report.violation <= FEASIBLE and np.isfinite(self.report.objective)

    def to_dict(self) -> dict[str, Any]:
        """Plain data for the report."""
        judged = self.certificate
        return {
            "steps": self.mesh.grid.steps,
            "poses_per_interval": self.mesh.poses,
            "demanded_clearance_extra": self.mesh.extra,
            "pairs": int(self.mesh.active.sum()),
            "solve": self.report.to_dict(),
            "certified": bool(judged.certified) if judged else False,
            "clearance": judged.clearance if judged else None,
            "witness": str(judged.witness) if judged and judged.witness else None,
            "seconds": self.seconds,
        }


def run_round(request: Request, mesh: Mesh, guess: Trajectory, number: int, progress: ProgressCallback) -> Round:
    """Transcribe onto the mesh, solve from the guess, replay and judge."""
    started = time.perf_counter()
    pairs = int(mesh.active.sum())
    progress(Progress("solve", f"{mesh.grid.steps} intervals, {pairs} pairs of parts near each other", number))
    transcription = transcribe(
        request.scenario, request.vehicle, guess, _settings(request, mesh), grid=mesh.grid, active=mesh.active
    )

    def watch(iteration: Iteration) -> None:
        progress(Progress("solve", f"iteration {iteration.number}", number, iteration))

    report = request.solver.solve(transcription.nlp, callback=watch)
    return _judged(request, mesh, transcription, report, number, progress, started)


def _settings(request: Request, mesh: Mesh) -> Settings:
    return Settings(
        objective=request.objective,
        formulation=request.formulation,
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
    outcome = Round(mesh, report, trajectory, None, None, 0.0)
    motion = certificate = None
    if outcome.solved:
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


def refine(request: Request, last: Round, number: int) -> Mesh:
    """More intervals where the motion comes too near; from the third round on a larger margin, too.

    Pairs that the motion comes near to and that were not in the problem are added.
    """
    assert last.replay is not None
    clear = replay_clearance(last.replay, request.scenario, request.vehicle, SAMPLES)
    near = last.mesh.active | (clear < REACH)
    short = (clear < request.margin + last.mesh.extra / 2).any(axis=(1, 2)) | _outside(request, last.replay)
    grid, poses, extra = last.mesh.grid, last.mesh.poses, last.mesh.extra
    if not short.any():
        extra += 0.002
    elif grid.steps + int(short.sum()) <= MOST_STEPS:
        grid = grid.split(np.flatnonzero(short))
        near = np.repeat(near, np.where(short, 2, 1), axis=0)
    if number >= 2 or grid is last.mesh.grid:
        deficit = request.margin - float(clear.min(initial=np.inf))
        extra = min(extra + np.clip(deficit / 2, 0.001, 0.02), 0.1)
    return Mesh(grid, poses, extra, _with_neighbours(near))


def _outside(request: Request, motion: Replay) -> NDArray[np.bool_]:
    """Intervals on which the body leaves W."""
    from tightspot.geometry.transforms import transform

    workspace = request.scenario.workspace
    t = motion.trajectory.t
    weights = np.arange(SAMPLES + 1) / SAMPLES
    times = t[:-1, None] + np.diff(t)[:, None] * weights
    states = motion.at(times)
    frames = request.vehicle.frames(list(np.moveaxis(states, -1, 0)), np)
    result = np.zeros(len(times), bool)
    for part in request.vehicle.parts:
        body = transform(part.polygon.vertices, np.stack(frames[part.frame], axis=-1))
        excess = body @ workspace.A.T - workspace.b
        result |= (excess > 0).any(axis=(1, 2, 3))
    return result


def _with_neighbours(active: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """A pair near on one interval is in the problem on the intervals beside it, too."""
    grown = active.copy()
    grown[1:] |= active[:-1]
    grown[:-1] |= active[1:]
    return grown
