"""Planning among obstacles whose motion is a function of time: solve, take the motions' tangents where t_f came out,
solve again, until t_f settles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem
from tightspot.scenarios.scenario import Scenario
from tightspot.solvers.base import Solver, SolveReport, WarmStart
from tightspot.solvers.ipopt import Ipopt
from tightspot.solvers.stage_problem import StageProblem
from tightspot.solvers.stage_report import StageReport
from tightspot.solvers.stagewise import Stagewise
from tightspot.trajectory import Trajectory
from tightspot.transcription.grid import TimeGrid
from tightspot.transcription.motions import MovingObstacle, ObstacleMotion
from tightspot.transcription.stage_problem import fits_stages, stage_problem
from tightspot.transcription.transcribe import Settings, transcribe
from tightspot.vehicles.base import VehicleModel


@dataclass(frozen=True, eq=False)
class MovingSolution:
    """What :func:`solve_moving` came to; look at :attr:`success` first.

    Attributes:
        report: Of the last solve.
        trajectory: Its motion; ``None`` if it failed.
        motions: The obstacles as the last solve had them.
        final_times: The t_ref of every solve, s.
        settled: Whether the last solve's t_f is its t_ref, to the tolerance.
    """

    report: SolveReport
    trajectory: Trajectory | None
    motions: tuple[ObstacleMotion, ...]
    final_times: tuple[float, ...]
    settled: bool

    @property
    def success(self) -> bool:
        """True if the last solve succeeded among obstacles where they really are."""
        return self.settled and self.report.status.success

    @property
    def sentence(self) -> str:
        """How it ended."""
        if self.trajectory is None:
            return self.report.status.sentence
        if self.settled:
            return f"The final time settled in {len(self.final_times)} solves."
        apart = abs(self.trajectory.duration - self.final_times[-1])
        return f"The final time did not settle in {len(self.final_times)} solves; the last moved it by {apart:.2g} s."


def solve_moving(
    scenario: Scenario,
    vehicle: VehicleModel,
    guess: Trajectory,
    settings: Settings,
    moving: Sequence[MovingObstacle],
    *,
    grid: TimeGrid,
    solver: Solver | None = None,
    active: NDArray[np.bool_] | None = None,
    walls: NDArray[np.bool_] | None = None,
    tolerance: float = 1e-4,
    max_solves: int = 20,
) -> MovingSolution:
    """Solve among obstacles that move as functions of time, whatever t_f turns out to be.

    A program takes the motions' tangents at a reference final time (:class:`ObstacleMotion`), exact where its own t_f
    comes out the same. So solve with t_ref, take t_f for the next t_ref and solve again, warm, until they agree. Where
    they do, tangents and motions have the same poses and the same derivatives with respect to t_f: the point satisfies
    the first-order optimality conditions of the problem with the motions themselves. Where t_f swings to and
    fro by more than half the last step, the next step goes half the way only.

    Separation holds where the formulation says, as for standing obstacles; :func:`tightspot.plan` and its judge do not
    know of obstacles that move, so nothing is certified here.

    Args:
        scenario: Standing obstacles, W, start and goal.
        vehicle: Dynamics, bounds and body.
        guess: Where to start; its duration is the first t_ref, within the bounds of t_f.
        settings: As for :func:`transcribe`; t_f free or fixed.
        moving: What moves.
        grid: Knots.
        solver: ``None``: the stagewise solver where it knows model and formulation, and IPOPT where it does not, or
            comes to nothing; the report's note tells of that.
        active: Pairs to include, (N, parts, obstacle parts), those that move last; all if ``None``.
        walls: Half-planes of W to include, (N, parts, edges of W); all if ``None``.
        tolerance: How far t_f may be from t_ref, s.
        max_solves: Limit; the solver's own limits hold for each solve.

    Returns:
        What it came to, also if a solve failed or t_f did not settle: look at :attr:`MovingSolution.success`.

    Raises:
        InputError: An argument does not fit the others, or a motion gives no finite poses.
    """
    problems = []
    if not (np.isfinite(tolerance) and tolerance > 0):
        problems.append(Problem("tolerance", f"{tolerance} s must be positive and finite"))
    if max_solves < 1:
        problems.append(Problem("max_solves", f"{max_solves} is too few; give at least 1"))
    if problems:
        raise InputError(problems)
    first = solver or (Stagewise() if fits_stages(vehicle, settings.formulation) else Ipopt())
    program = _Program(scenario, vehicle, guess, settings, grid, active, walls, first)
    solution = _settled(program, moving, tolerance, max_solves)
    if solution.success or solver is not None or not isinstance(first, Stagewise):
        return solution
    second = _settled(replace(program, solver=Ipopt()), moving, tolerance, max_solves)
    if not second.success:
        return solution
    note = f"ipopt, since stagewise came to nothing: {solution.sentence}"
    return replace(second, report=replace(second.report, note=note))


def _settled(program: _Program, moving: Sequence[MovingObstacle], tolerance: float, max_solves: int) -> MovingSolution:
    final_time = float(np.clip(program.guess.duration, *program.settings.final_time_bounds))
    times: list[float] = []
    report, off = None, 0.0
    while True:
        motions = tuple(obstacle.on(program.grid, final_time) for obstacle in moving)
        report, trajectory = program.solve(motions, report)
        times.append(final_time)
        step = trajectory.duration - final_time if trajectory else np.inf
        settled = abs(step) <= tolerance
        if settled or trajectory is None or len(times) >= max_solves:
            return MovingSolution(report, trajectory, motions, tuple(times), settled)
        swings = step * off < 0 and abs(step) > abs(off) / 2
        final_time += step / 2 if swings else step
        off = step


@dataclass(frozen=True, eq=False)
class _Program:
    """What stays the same from solve to solve."""

    scenario: Scenario
    vehicle: VehicleModel
    guess: Trajectory
    settings: Settings
    grid: TimeGrid
    active: NDArray[np.bool_] | None
    walls: NDArray[np.bool_] | None
    solver: Solver

    def solve(
        self, motions: tuple[ObstacleMotion, ...], earlier: SolveReport | None
    ) -> tuple[SolveReport, Trajectory | None]:
        """With these motions, from the earlier solution if there is one; no trajectory if it fails."""
        arguments = (self.scenario, self.vehicle, self.guess, self.settings)
        if isinstance(self.solver, Stagewise):
            problem = stage_problem(*arguments, grid=self.grid, motions=motions, active=self.active, walls=self.walls)
            return self._staged(self.solver, problem, earlier)
        program = transcribe(*arguments, grid=self.grid, motions=motions, active=self.active, walls=self.walls)
        warm = None if earlier is None else WarmStart(earlier.x, earlier.lam_x, earlier.lam_g)
        report = self.solver.solve(program.nlp, warm=warm)
        return report, program.trajectory(report.x) if report.status.success else None

    def _staged(
        self, solver: Stagewise, problem: StageProblem, earlier: SolveReport | None
    ) -> tuple[SolveReport, Trajectory | None]:
        warm = None
        if isinstance(earlier, StageReport) and earlier.problem is not None and earlier.point is not None:
            warm = earlier.point
            states, inputs, final_time, lines, penetrations = earlier.problem.unpack(warm.v)
            problem = problem.replaced(
                pair_origins=earlier.problem.pair_origins,
                states=states,
                inputs=inputs,
                final_time=final_time,
                lines=lines,
                penetrations=penetrations,
            )
        report = solver.solve_stages(problem, warm=warm)
        if not report.status.success or report.states is None or report.inputs is None:
            return report, None
        names = self.vehicle.state_names, self.vehicle.input_names
        return report, Trajectory(report.final_time * self.grid.fractions, report.states, report.inputs, *names)
