"""What to solve first, and what next when the solver fails or the judge objects.

The usual course: solve with separation at the knots, which is cheap; see by the judge's replay where the motion between
them comes near; add intervals there; and solve for separation on whole intervals, started with the lines, states and
multipliers of the first solution. That is certified, or the judge's witness says where intervals are still missing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tightspot.formulations import Formulation, SeparatingLine
from tightspot.planner.mesh import covers_of, poses_for, poses_on, steps_for, travels_of
from tightspot.planner.pairs import Room
from tightspot.planner.request import Request
from tightspot.planner.rounds import Mesh, Round, Step
from tightspot.solvers import Stagewise
from tightspot.trajectory import Trajectory
from tightspot.transcription import TimeGrid
from tightspot.transcription.sampling import inputs_on, times_on
from tightspot.verification import Certificate
from tightspot.verification.replay import Replay

REACH, WALL_REACH = 2.0, 4.0
FAR = (8.0, 5.0, 3.0)
FEW_PAIRS, MANY_PAIRS = 100, 5000
NEAR, DEEP, HOPELESS = 0.15, 0.1, 0.6
AGAIN = 1
ASTRAY = 3
EXTRA = 0.002
FIRST_EXTRA, ENOUGH = 0.01, 0.05
"""Demanded at the knots, m, where the guess has that much more: then the motion between them often keeps the margin,
too. In narrow places it would cost more than it saves."""
LARGEST_EXTRA = 0.1
MOST_STEPS = 240
FAILED_SOLVES = 4
ABOUT_CLEARANCE = ("obstacles", "workspace")


def first_step(request: Request, guess: Trajectory) -> Step:
    """At the knots only, on the guess's own mesh: with (17), or with the demanded member if it holds there."""
    steps = request.steps or steps_for(guess)
    formulation = at_knots(request.formulation)
    return Step(_uniform(request, formulation, guess, steps), guess, "knots", "from the guess")


def next_step(request: Request, rounds: Sequence[Round], guess: Trajectory) -> Step | None:
    """After a round that was not certified; ``None`` when there is nothing left to try."""
    last = rounds[-1]
    if last.replay is None:
        return _after_failure(request, rounds, guess)
    room = last.room or Room.of_replay(last.replay, request.scenario)
    if _is_astray(last.mesh, room) and sum(outcome.step.kind == "pairs" for outcome in rounds) < ASTRAY:
        return _with_what_was_missing(request, last, room)
    if last.mesh.formulation == request.formulation:
        assert last.certificate is not None
        mesh = refine(request, last.mesh, room, last.certificate, len(rounds))
        news = f"{mesh.grid.steps} intervals, {1000 * mesh.extra:.0f} mm beyond the margin"
        return Step(mesh, on_grid(last.replay, mesh.grid), "refine", news, last)
    if room.deepest < -HOPELESS and _failures(rounds, "guess") == 0:
        return _from_guess(request, rounds[0].mesh.grid.steps, guess, "the knots jump over an obstacle")
    if room.spare(request.margin).min() < -DEEP and sum(outcome.step.kind == "again" for outcome in rounds) < AGAIN:
        return _again(request, last, last.replay, room, loose=len(rounds) < request.refinements)
    return between_the_knots(request, last, last.replay, room)


def at_knots(formulation: Formulation) -> Formulation:
    """A member that holds at the knots only: the given one if it does, otherwise the paper's (17)."""
    return SeparatingLine() if formulation.holds == "interval" else formulation


def on_grid(motion: Replay, grid: TimeGrid) -> Trajectory:
    """The replayed motion at the knots of a finer grid: it satisfies the dynamics there."""
    driven = motion.trajectory
    t = times_on(driven, grid)
    return Trajectory.of_sound(t, motion.at(t), inputs_on(driven, t), driven.state_names, driven.input_names)


def _uniform(request: Request, formulation: Formulation, guess: Trajectory, steps: int) -> Mesh:
    grid = TimeGrid.uniform(steps)
    room = Room.of_guess(guess, grid, request.scenario, request.vehicle)
    poses = (poses_for(formulation, guess, request.vehicle, steps),) * steps
    roomy = formulation != request.formulation and room.spare(request.margin).min() >= ENOUGH
    extra = FIRST_EXTRA if roomy else EXTRA
    return Mesh(formulation, grid, poses, extra, _within_reach(request, room), np.ones_like(room.walls, bool))


def between_the_knots(request: Request, last: Round, motion: Replay, room: Room) -> Step:
    """From a solution that is free at the knots to the demanded member, on a mesh that is finer where it is near.

    Intervals with less than ``NEAR`` to spare are halved, those too near by more than ``DEEP`` quartered. Pairs within
    reach of the motion are in the problem.
    """
    spare = room.spare(request.margin)
    pieces = _pieces(spare)
    mesh = replace(
        last.mesh,
        formulation=request.formulation,
        extra=min(last.mesh.extra, EXTRA),
        active=_near(request, room),
        walls=_walls_near(request, room),
    ).cut(pieces)
    start = on_grid(motion, mesh.grid)
    covers, travels = covers_of(start, request.vehicle), travels_of(start, request.vehicle)
    poses = poses_on(request.formulation, covers, np.repeat(spare, pieces), travels)
    return Step(
        replace(mesh, poses=poses),
        start,
        "between",
        f"free at the knots; now between them, too, with {mesh.grid.steps} intervals",
        last,
    )


def _again(request: Request, last: Round, motion: Replay, room: Room, *, loose: bool) -> Step:
    """Once more at the knots, on a mesh that is finer where the motion collides: cheap, and a better start."""
    near = replace(last.mesh, active=last.mesh.active | _within_reach(request, room))
    mesh = near.cut(_pieces(room.spare(request.margin)))
    news = f"collides between the knots; {mesh.grid.steps} intervals"
    return Step(mesh, on_grid(motion, mesh.grid), "again", news, last, loose)


def _is_astray(mesh: Mesh, room: Room) -> bool:
    """Whether the motion is deep inside something that was not in the problem."""
    return bool((room.within(-DEEP) & ~mesh.active).any() or (room.walls[~mesh.walls] < -DEEP).any())


def _with_what_was_missing(request: Request, last: Round, room: Room) -> Step:
    """The same step from the same start: from where the motion went there may be no way back."""
    mesh = replace(
        last.mesh,
        active=last.mesh.active | _within_reach(request, room),
        walls=last.mesh.walls | _walls_within_reach(request, room),
    )
    news = "went astray through what was not in the problem; the same again with that"
    return Step(mesh, last.step.start, "pairs", news, last.step.before)


def _pieces(spare: NDArray[np.float64]) -> NDArray[np.intp]:
    """Into how many pieces each interval is cut."""
    pieces = np.where(spare < -DEEP, 4, np.where(spare < NEAR, 2, 1))
    return pieces if pieces.sum() <= MOST_STEPS else np.ones_like(pieces)


def _from_guess(request: Request, steps: int, guess: Trajectory, why: str) -> Step:
    mesh = _uniform(request, request.formulation, guess, steps)
    return Step(mesh, guess, "guess", f"{why}; on whole intervals, from the guess")


def _after_failure(request: Request, rounds: Sequence[Round], guess: Trajectory) -> Step | None:
    """From the last solution on a finer mesh; or on whole intervals from the guess; or more intervals."""
    if sum(not outcome.solved for outcome in rounds) > FAILED_SOLVES:
        return None
    whole = [outcome for outcome in rounds if outcome.solved and outcome.mesh.formulation == request.formulation]
    if whole and whole[-1].replay and _failures(rounds, "finer") == 0:
        mesh = whole[-1].mesh
        finer = replace(mesh.cut(np.full(mesh.grid.steps, 2)), extra=EXTRA)
        news = f"the solver failed; {finer.grid.steps} intervals from the last solution"
        return Step(finer, on_grid(whole[-1].replay, finer.grid), "finer", news)
    steps = max(outcome.mesh.grid.steps for outcome in rounds if outcome.step.kind in ("knots", "guess"))
    if request.formulation.holds == "interval" and _failures(rounds, "guess", steps) == 0:
        return _from_guess(request, steps, guess, "the solver failed")
    steps = min(int(np.ceil(1.5 * steps)), MOST_STEPS)
    mesh = replace(_uniform(request, at_knots(request.formulation), guess, steps), extra=EXTRA / 2)
    return Step(mesh, guess, "knots", f"the solver failed; {steps} intervals from the guess")


def _failures(rounds: Sequence[Round], kind: str, steps: int | None = None) -> int:
    """How many rounds of that kind (and number of intervals) came to nothing."""
    return sum(
        outcome.step.kind == kind and not outcome.solved and steps in (None, outcome.mesh.grid.steps)
        for outcome in rounds
    )


def refine(request: Request, mesh: Mesh, room: Room, certificate: Certificate, number: int) -> Mesh:
    """More intervals where the motion comes too near; from the fourth round on a larger margin, too.

    Pairs that the motion comes near to and that were not in the problem are added. If the judge objects to something
    else than clearance (the integration's defect on a coarse mesh), every interval is split.
    """
    too_near = (room.by_obstacles < request.margin + mesh.extra / 2) | (room.walls < 0).any(axis=(1, 2))
    short = np.asarray(too_near, bool)
    if any(check.name not in ABOUT_CLEARANCE for check in certificate.failed):
        short[:] = True
    near = replace(
        mesh,
        active=mesh.active | _near(request, room),
        walls=mesh.walls | _walls_near(request, room),
        poses=tuple(max(count, 1) for count in mesh.poses),
    )
    finer = near.cut(np.where(short, 2, 1)) if near.grid.steps + int(short.sum()) <= MOST_STEPS else near
    if number <= 3 and finer.grid.steps > mesh.grid.steps:
        return finer
    deficit = request.margin - float(room.by_obstacles.min())
    return replace(finer, extra=float(min(mesh.extra + np.clip(deficit / 2, 0.002, 0.02), LARGEST_EXTRA)))


def _within_reach(request: Request, room: Room) -> NDArray[np.bool_]:
    """Pairs that enter the problem: those that the motion might come near to once it is optimised.

    For the stagewise solver a pair costs little, and a motion that goes astray through one that is missing costs much:
    all within the farthest of ``FAR`` in which there are not too many. For others those within ``REACH``, or all if
    they are few.
    """
    if isinstance(request.solver, Stagewise):
        for reach in FAR:
            far = room.within(reach)
            if far.sum() <= MANY_PAIRS:
                return _with_neighbours(far)
        return _with_neighbours(room.within(REACH))
    near = room.within(REACH)
    return np.ones_like(near) if near.size <= FEW_PAIRS else _with_neighbours(near)


def _near(request: Request, room: Room) -> NDArray[np.bool_]:
    """Pairs that enter the problem when the motion is a solution already: those within ``REACH``.

    Rows on whole intervals are many, and of what is farther the judge sees that it is not needed, or asks for it. A
    motion that collides will move more: then those of :func:`_within_reach`.
    """
    if room.spare(request.margin).min() < -DEEP:
        return _within_reach(request, room)
    return _within_reach(request, room) & _with_neighbours(room.within(REACH))


def _walls_within_reach(request: Request, room: Room) -> NDArray[np.bool_]:
    if isinstance(request.solver, Stagewise):
        return np.ones_like(room.walls, bool)
    return _with_neighbours(room.walls < WALL_REACH)


def _walls_near(request: Request, room: Room) -> NDArray[np.bool_]:
    """The same for the edges of W."""
    if room.spare(request.margin).min() < -DEEP:
        return _walls_within_reach(request, room)
    return _walls_within_reach(request, room) & _with_neighbours(room.walls < WALL_REACH)


def _with_neighbours(active: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """A pair near on one interval is in the problem on the intervals beside it, too."""
    grown = active.copy()
    grown[1:] |= active[:-1]
    grown[:-1] |= active[1:]
    return grown
