"""What to solve first, and what next when the solver fails or the judge objects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tightspot.formulations import Formulation, SeparatingLine
from tightspot.planner.mesh import poses_for, steps_for
from tightspot.planner.pairs import Room
from tightspot.planner.request import Request
from tightspot.planner.rounds import Mesh, Round
from tightspot.trajectory import Trajectory
from tightspot.transcription import TimeGrid
from tightspot.verification import Certificate
from tightspot.verification.replay import Replay

REACH = 2.0
WALL_REACH = 4.0
FEW_PAIRS = 100
EXTRA = 0.002
LARGEST_EXTRA = 0.1
MOST_STEPS = 240
FAILED_SOLVES = 3
ABOUT_CLEARANCE = ("obstacles", "workspace")


@dataclass(frozen=True, eq=False)
class Step:
    """What to solve and from where, and why, for people."""

    mesh: Mesh
    start: Trajectory
    reason: str


def first_step(request: Request, guess: Trajectory) -> Step:
    """The guess's own mesh. A guess that may collide is first made free at the knots, which is easier."""
    steps = request.steps or steps_for(guess)
    formulation = request.formulation if request.guess.collision_free else at_knots(request.formulation)
    return Step(_mesh(request, formulation, guess, steps), guess, "from the guess")


def next_step(request: Request, rounds: Sequence[Round], guess: Trajectory) -> Step | None:
    """After a round that was not certified; ``None`` when there is nothing left to try."""
    last = rounds[-1]
    if last.certificate and last.replay:
        if last.mesh.formulation is not request.formulation:
            return _whole_intervals(request, last, last.trajectory)
        mesh = refine(request, last.mesh, last.replay, last.certificate, len(rounds))
        news = f"{mesh.grid.steps} intervals, {1000 * mesh.extra:.0f} mm beyond the margin"
        return Step(mesh, last.trajectory, news)
    if sum(not outcome.solved for outcome in rounds) > FAILED_SOLVES:
        return None
    return _after_failure(request, rounds, guess)


def at_knots(formulation: Formulation) -> Formulation:
    """A member that holds at the knots only: the given one if it does, otherwise the paper's (17)."""
    return SeparatingLine() if formulation.holds == "interval" else formulation


def _mesh(request: Request, formulation: Formulation, guess: Trajectory, steps: int) -> Mesh:
    grid = TimeGrid.uniform(steps)
    room = Room.of_guess(guess, grid, request.scenario, request.vehicle)
    poses = poses_for(formulation, guess, request.vehicle, steps)
    small = room.obstacles.size <= FEW_PAIRS
    active, walls = room.obstacles < (np.inf if small else REACH), room.walls < (np.inf if small else WALL_REACH)
    return Mesh(formulation, grid, poses, EXTRA, active, walls)


def _whole_intervals(request: Request, last: Round, start: Trajectory) -> Step:
    """From a solution that is free at the knots to the demanded member, which holds in between, too."""
    mesh = last.mesh
    room = Room.of_guess(start, mesh.grid, request.scenario, request.vehicle)
    active, walls = mesh.active | (room.obstacles < REACH), mesh.walls | (room.walls < WALL_REACH)
    poses = poses_for(request.formulation, start, request.vehicle, mesh.grid.steps)
    return Step(
        replace(mesh, formulation=request.formulation, poses=poses, active=active, walls=walls),
        start,
        f"free at the knots; now between them, too, by {request.formulation.name}",
    )


def _after_failure(request: Request, rounds: Sequence[Round], guess: Trajectory) -> Step:
    """From the last solution on a finer mesh; or, without any, at the knots only first; or more intervals."""
    last = rounds[-1].mesh
    solved = [outcome for outcome in rounds if outcome.solved]
    if solved:
        mesh = solved[-1].mesh
        finer = _split(mesh, np.ones(mesh.grid.steps, bool))
        return Step(
            replace(finer, formulation=request.formulation, extra=EXTRA, poses=last.poses),
            solved[-1].trajectory,
            f"the solver failed; {finer.grid.steps} intervals from the last solution",
        )
    if last.formulation.holds == "interval":
        mesh = replace(last, formulation=at_knots(last.formulation), poses=1)
        return Step(mesh, guess, "the solver failed; once more at the knots only, from the guess")
    steps = min(int(np.ceil(1.5 * last.grid.steps)), MOST_STEPS)
    mesh = replace(_mesh(request, request.formulation, guess, steps), extra=EXTRA / 2)
    return Step(mesh, guess, f"the solver failed; {steps} intervals from the guess")


def refine(request: Request, mesh: Mesh, motion: Replay, certificate: Certificate, number: int) -> Mesh:
    """More intervals where the motion comes too near; from the third round on a larger margin, too.

    Pairs that the motion comes near to and that were not in the problem are added. If the judge objects to something
    else than clearance (the integration's defect on a coarse mesh), every interval is split.
    """
    room = Room.of_replay(motion, request.scenario, request.vehicle)
    clear = room.obstacles
    too_near = (clear < request.margin + mesh.extra / 2).any(axis=(1, 2)) | (room.walls < 0).any(axis=(1, 2))
    short = np.asarray(too_near, bool)
    if any(check.name not in ABOUT_CLEARANCE for check in certificate.failed):
        short[:] = True
    near = replace(
        mesh,
        active=_with_neighbours(mesh.active | (clear < REACH)),
        walls=_with_neighbours(mesh.walls | (room.walls < WALL_REACH)),
    )
    finer = _split(near, short) if near.grid.steps + int(short.sum()) <= MOST_STEPS else near
    if number <= 2 and finer.grid.steps > mesh.grid.steps:
        return finer
    deficit = request.margin - float(clear.min(initial=np.inf))
    return replace(finer, extra=float(min(mesh.extra + np.clip(deficit / 2, 0.002, 0.02), LARGEST_EXTRA)))


def _split(mesh: Mesh, chosen: NDArray[np.bool_]) -> Mesh:
    """The mesh with the chosen intervals (N,) halved; what is in the problem there stays in it on both halves."""
    repeats = np.where(chosen, 2, 1)
    return replace(
        mesh,
        grid=mesh.grid.split(np.flatnonzero(chosen)),
        active=np.repeat(mesh.active, repeats, axis=0),
        walls=np.repeat(mesh.walls, repeats, axis=0),
    )


def _with_neighbours(active: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """A pair near on one interval is in the problem on the intervals beside it, too."""
    grown = active.copy()
    grown[1:] |= active[:-1]
    grown[:-1] |= active[1:]
    return grown
