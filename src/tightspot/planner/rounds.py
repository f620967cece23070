"""One round of planning: transcribe, solve, replay, judge."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot.formulations import Formulation, with_unit_normal
from tightspot.planner.pairs import Room
from tightspot.planner.progress import Progress, ProgressCallback, iterations_told
from tightspot.planner.request import Request
from tightspot.solvers import (
    Fatrop,
    IterationCallback,
    Solver,
    SolveReport,
    StageProblem,
    StageReport,
    Stagewise,
)
from tightspot.trajectory import Trajectory
from tightspot.transcription import (
    Settings,
    TimeGrid,
    Transcription,
    carry_lines,
    carry_over,
    fits_stages,
    stage_problem,
    transcribe,
)
from tightspot.verification import Certificate, verify
from tightspot.verification.replay import Replay, replay

FEASIBLE = 1e-5
LOOSE = 1e-2
"""Tolerance of steps that are to be gone on from: what the next one changes is more."""
WARM_BARRIER = 1e-3
"""Small enough not to push a solution on a coarser mesh over into another valley."""
BETWEEN_BARRIER, BETWEEN_SLACK = 3e-3, 0.1
"""For rows between the knots, m: a solution at the knots violates some of them by about as much."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """What may change from round to round.

    Attributes:
        formulation: How separation is written.
        grid: Knots.
        poses: Sub-intervals with rows of each interval (members that hold on the interval), N numbers; 0: at its last
            knot only.
        extra: Clearance demanded beyond the margin, m, so that the judge has room to prove the margin.
        active: Pairs in the problem, (N, parts, obstacle parts).
        walls: Edges of W in the problem, (N, parts, edges).
    """

    formulation: Formulation
    grid: TimeGrid
    poses: tuple[int, ...]
    extra: float
    active: NDArray[np.bool_]
    walls: NDArray[np.bool_]

    def cut(self, pieces: NDArray[np.intp]) -> Mesh:
        """Interval k cut into ``pieces[k]``; what is in the problem there stays in it on all pieces."""
        return replace(
            self,
            grid=self.grid.cut(pieces),
            poses=tuple(np.repeat(self.poses, pieces).tolist()),
            active=np.repeat(self.active, pieces, axis=0),
            walls=np.repeat(self.walls, pieces, axis=0),
        )


@dataclass(frozen=True, eq=False)
class Step:
    """What to solve and from where.

    Attributes:
        mesh: On which mesh.
        start: From which trajectory.
        kind: What the planner is trying, one word for itself.
        reason: The same for people.
        before: The round whose lines and multipliers are carried over; ``None``: closed-form lines, no multipliers.
        loose: Only a start for the next step: solved to a few digits, and not certified.
    """

    mesh: Mesh
    start: Trajectory
    kind: str
    reason: str
    before: Round | None = None
    loose: bool = False


@dataclass(frozen=True, eq=False)
class Round:
    """A round's outcome.

    Attributes:
        step: What was solved, from where and why.
        program: Builds the nonlinear program, for fatrop that with unit normals; solvers that take arrays do without
            it.
        report: The solver's.
        abandoned: Reports of the solvers that failed before.
        trajectory: The replayed trajectory: the inputs integrated from the start, sampled at the knots.
        replay: The continuous motion; ``None`` if the solve failed.
        verdict: The judge's word, or what asks the judge; ``None`` if the solve failed.
        room: How near the motion comes to everything, if that was looked at.
        objection: What was seen there that no judge certifies; empty if nothing was.
        timings: Seconds of ``set_up`` (program and its derivatives), ``solve`` and ``judge``.
    """

    step: Step
    program: Callable[[], Transcription]
    report: SolveReport
    abandoned: tuple[SolveReport, ...]
    trajectory: Trajectory
    replay: Replay | None
    verdict: Certificate | Callable[[], Certificate] | None
    room: Room | None
    objection: str
    timings: dict[str, float]

    @property
    def transcription(self) -> Transcription:
        """The nonlinear program, built when it is first asked for; the report's vectors are in its order."""
        return self.program()

    @property
    def mesh(self) -> Mesh:
        """What was solved."""
        return self.step.mesh

    @property
    def seconds(self) -> float:
        """Time of the whole round."""
        return sum(self.timings.values())

    @property
    def solved(self) -> bool:
        """True if the last iterate satisfies the constraints, so that it could be judged."""
        return self.verdict is not None

    @cached_property
    def certificate(self) -> Certificate | None:
        """The judge's word, who is asked now if there was no need to before; ``None`` if the solve failed."""
        return self.verdict() if callable(self.verdict) else self.verdict

    @property
    def certified(self) -> bool:
        """Whether this is a plan."""
        if self.objection or self.step.loose:
            return False
        return self.certificate is not None and self.certificate.certified

    def _finding(self) -> dict[str, Any]:
        """What came of it; the judge is not asked where there is no need to."""
        if self.room is not None and not self.certified:
            return {"certified": False, "clearance": self.room.deepest, "witness": self.objection or None}
        judged = self.certificate
        clearance = judged.clearance if judged and np.isfinite(judged.clearance) else None
        witness = str(judged.witness) if judged and judged.witness else None
        return {"certified": self.certified, "clearance": clearance, "witness": witness}

    def to_dict(self) -> dict[str, Any]:
        """Plain data for the report."""
        return {
            "reason": self.step.reason,
            "formulation": self.mesh.formulation.name,
            "steps": self.mesh.grid.steps,
            "poses": sum(self.mesh.poses),
            "demanded_clearance_extra": self.mesh.extra,
            "pairs": int(np.count_nonzero(self.mesh.active)),
            "variables": self.report.n_variables,
            "rows": self.report.n_rows,
            "warm": self.step.before is not None,
            "solve": self.report.to_dict(),
            "fell_back_from": [report.to_dict() for report in self.abandoned],
            **self._finding(),
            "seconds": self.seconds,
            "timings": self.timings,
        }


def run_round(
    request: Request,
    step: Step,
    number: int,
    progress: ProgressCallback,
    seconds: float,
    solved: StageReport | None = None,
) -> Round:
    """Transcribe onto the mesh, solve from the start within ``seconds``, replay and judge.

    With ``solved``, the answer to :func:`problem_of` the step, nothing is left to solve.
    """
    started = time.perf_counter()
    mesh = step.mesh
    pairs = int(np.count_nonzero(mesh.active))
    progress(Progress("solve", f"{mesh.grid.steps} intervals, {pairs} pairs of parts near each other", number))

    @cache
    def program(formulation: Formulation) -> Transcription:
        settings = _settings(request, mesh)
        arguments = request.scenario, request.vehicle, step.start, replace(settings, formulation=formulation)
        return transcribe(*arguments, grid=mesh.grid, active=mesh.active, walls=mesh.walls)

    def program_of(solver: str) -> Callable[[], Transcription]:
        member = with_unit_normal(mesh.formulation) if solver == Fatrop.name else None
        return partial(program, member or mesh.formulation)

    watch = iterations_told(progress, number)
    reports: list[SolveReport] = [] if solved is None else [solved]
    for solver in () if solved is not None else (request.solver, *request.fallbacks):
        if isinstance(solver, Stagewise) and not fits_stages(request.vehicle, mesh.formulation):
            continue
        limited = solver.with_time_limit(seconds - (time.perf_counter() - started))
        reports.append(_solved(request, step, limited, program_of(solver.name), watch))
        if reports[-1].status.success:
            break
    best = min(reports, key=lambda report: (not report.status.success, report.violation > FEASIBLE))
    abandoned = tuple(report for report in reports if report is not best)
    solve = sum(report.timings.get("solve", 0.0) for report in reports)
    timings = {"set_up": time.perf_counter() - started - (solve if solved is None else 0.0), "solve": solve}
    return _judged(request, step, program_of(best.solver), best, abandoned, number, progress, timings)


def problem_of(request: Request, step: Step) -> StageProblem:
    """What the stagewise solver is given for a step, with closed-form lines.

    Raises:
        InputError: The stagewise solver does not know the vehicle's model or the formulation.
    """
    mesh = step.mesh
    arguments = request.scenario, request.vehicle, step.start, _settings(request, mesh)
    return stage_problem(*arguments, grid=mesh.grid, active=mesh.active, walls=mesh.walls)


def _solved(
    request: Request,
    step: Step,
    solver: Solver,
    program: Callable[[], Transcription],
    watch: IterationCallback | None,
) -> SolveReport:
    """By the stagewise solver from arrays, by others from the nonlinear program, each with what can be carried over."""
    before = step.before
    if step.loose and isinstance(solver, Stagewise):
        solver = solver.with_options(tolerance=max(solver.tolerance, LOOSE))
    if not isinstance(solver, Stagewise):
        warm = carry_over(before.transcription, before.report, program()) if before else None
        return solver.solve(program().nlp, warm=warm, callback=watch)
    if before is None or not isinstance(before.report, StageReport):
        return solver.solve_stages(problem_of(request, step), callback=watch)
    problem = carry_lines(before.mesh.grid, before.report, problem_of(request, step))
    solver = solver.with_options(knots_first=False)  # these lines have chosen their edges
    if solver.initial_barrier is None:
        between = step.mesh.formulation.holds == "interval"
        barrier, slack = (BETWEEN_BARRIER, BETWEEN_SLACK) if between else (WARM_BARRIER, None)
        near = solver.with_options(initial_barrier=barrier, slack_push=slack).solve_stages(problem, callback=watch)
        if near.status.success:
            return near
    return solver.solve_stages(problem, callback=watch)


def _settings(request: Request, mesh: Mesh) -> Settings:
    return Settings(
        objective=request.objective,
        formulation=mesh.formulation,
        margin=request.margin + mesh.extra,
        end_margin=request.margin,
        workspace_margin=mesh.extra,
        substeps=2,
        poses=mesh.poses,
    )


def _judged(
    request: Request,
    step: Step,
    program: Callable[[], Transcription],
    report: SolveReport,
    abandoned: tuple[SolveReport, ...],
    number: int,
    progress: ProgressCallback,
    timings: dict[str, float],
) -> Round:
    started = time.perf_counter()
    scenario, vehicle, margin = request.scenario, request.vehicle, request.margin
    trajectory = _trajectory(request, step, program, report)
    motion, verdict, room, objection = None, None, None, ""
    if report.violation <= (LOOSE if step.loose else FEASIBLE) and np.isfinite(report.objective):
        progress(Progress("verify", "replaying the inputs and covering all times", number))
        motion = replay(vehicle, trajectory)
        names = trajectory.state_names, trajectory.input_names
        trajectory = Trajectory.of_sound(trajectory.t, _within_bounds(motion.knots, request), trajectory.inputs, *names)
        if step.mesh.formulation != request.formulation and step.kind != "warm":  # which is free as a rule
            room = Room.of_replay(motion, scenario)
            objection = room.objection(trajectory.t, margin, scenario, vehicle)
        judge = partial(verify, scenario, vehicle, trajectory, margin=margin, known=motion)
        verdict = judge if objection or step.loose else judge()
    timings = timings | {"judge": time.perf_counter() - started}
    return Round(step, program, report, abandoned, trajectory, motion, verdict, room, objection, timings)


def _trajectory(request: Request, step: Step, program: Callable[[], Transcription], report: SolveReport) -> Trajectory:
    if not isinstance(report, StageReport) or report.states is None or report.inputs is None:
        return program().trajectory(_finite(report.x))
    t = (report.final_time if np.isfinite(report.final_time) else 1.0) * step.mesh.grid.fractions
    names = request.vehicle.state_names, request.vehicle.input_names
    if report.status.success:
        return Trajectory.of_sound(t, report.states, report.inputs, *names)
    return Trajectory(t, _finite(report.states), _finite(report.inputs), *names)


def _finite(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of a solve that went astray what can be put into numbers."""
    return values if np.isfinite(values).all() else np.nan_to_num(values)


def _within_bounds(states: NDArray[np.float64], request: Request) -> NDArray[np.float64]:
    """The states with rounding errors beyond a bound (below 1e-9) put back onto it."""
    low, high = request.vehicle.state_bounds
    if not ((states < low) | (states > high)).any():
        return states
    clipped = np.minimum(np.maximum(states, low), high)
    return np.where(np.abs(clipped - states) < 1e-9, clipped, states)
