"""When no trajectory is free of collisions: one that penetrates as little as a local search can make it."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, PlanningError, Problem
from tightspot.formulations import SoftSignedDistance, SoftUnitNormalLine
from tightspot.guesses import Guess, LinearInterpolation, ReedsShepp, guess
from tightspot.planner.mesh import steps_for
from tightspot.planner.pairs import Room
from tightspot.planner.penetration import Penetration, measured
from tightspot.planner.request import resolve_solver, resolve_vehicle
from tightspot.planner.rounds import FEASIBLE
from tightspot.scenarios import Scenario, check, load
from tightspot.solvers import Solver, SolveReport, StageReport, Stagewise
from tightspot.trajectory import Trajectory
from tightspot.transcription import Objective, Settings, TimeGrid, fits_stages, stage_problem, transcribe
from tightspot.vehicles import SingleTrack, VehicleModel

REACH = 1.5
"""Pairs that the start comes this near to are penalised from the beginning, m; others once they are penetrated."""
PASSES = 4


def minimum_penetration(
    scenario: Scenario | str | Path,
    *,
    vehicle: VehicleModel | str | Path | None = None,
    objective: Objective | None = None,
    guess_: Guess | str | None = None,
    solver: Solver | str | None = None,
    steps: int | None = None,
    margin: float | None = None,
    weight: float = 100.0,
) -> Penetration:
    """Drive to the goal with the smallest overlap: what stands in the way when there is no plan.

    Minimises J plus ``weight`` times the integral over time of ``max(0, margin - signed distance)``, summed over the
    pairs: with soft lines (:class:`tightspot.formulations.SoftUnitNormalLine`) by the stagewise solver, with the soft
    form of (21) by others. The overlaps reported are measured on the replayed motion, between the knots, too. A local
    minimum near the guess; another guess may find a shallower one.

    Args:
        scenario: A scenario, the name of a built-in one, or a file. Start and goal must be free.
        vehicle: A vehicle, a catalogue name or a file; default: the scenario's.
        objective: Default: the paper's eq. (25), r = 1, P = diag(1, 2).
        guess_: A member or its name; default: the shallower of ``linear`` and, for a single track, ``reeds-shepp``,
            since others may find none where none is free.
        solver: A backend or its name; default: the stagewise solver where it has the vehicle's model compiled in, IPOPT
            for others and where that fails.
        steps: Number of intervals; default: from the guess's length and gear changes.
        margin: Clearance below which the penalty begins, m; default: the scenario's.
        weight: Cost of 1 m of penetration for 1 s.

    Returns:
        The trajectory and where, when and how deep it collides.

    Raises:
        InputError: If the input makes no sense, for example a start in collision.
        PlanningError: If the solver fails, for example because the goal cannot be reached within the workspace.

    Reference: X. Zhang, A. Liniger, F. Borrelli, Optimization-based collision avoidance, IEEE Transactions on Control
    Systems Technology 29 (2021), section IV.B.
    """
    scene = scenario if isinstance(scenario, Scenario) else load(scenario)
    car = resolve_vehicle(scene, vehicle)
    margin = scene.margin if margin is None else margin
    if not (np.isfinite(weight) and weight > 0):
        raise InputError(Problem("weight", f"{weight} must be positive and finite"))
    check(scene, car, margin)
    solvers = soft_solvers(car) if solver is None else (resolve_solver(solver),)
    found: list[Penetration] = []
    failed: PlanningError | None = None
    for method in _guesses(guess_, car, solvers):
        made = method.make(scene, car, margin=margin)
        try:
            if made.trajectory is None:
                raise PlanningError(made.reason, report={"guess": made.report, "rounds": []})
            found.append(
                shallowest(
                    scene,
                    car,
                    made.trajectory,
                    solvers,
                    objective=objective or Objective(),
                    steps=steps or steps_for(made.trajectory),
                    margin=margin,
                    weight=weight,
                )
            )
        except PlanningError as error:
            failed = failed or error
    if failed is not None and not found:
        raise failed
    return min(found, key=lambda one: (round(one.depth, 3), one.solve.objective))


def _guesses(given: Guess | str | None, vehicle: VehicleModel, solvers: Sequence[Solver]) -> Sequence[Guess]:
    """More than one only if solving is cheap."""
    if given is not None:
        return (guess(given) if isinstance(given, str) else given,)
    if isinstance(vehicle, SingleTrack) and isinstance(solvers[0], Stagewise):
        return LinearInterpolation(), ReedsShepp()
    return (LinearInterpolation(),)


def soft_solvers(vehicle: VehicleModel) -> tuple[Solver, ...]:
    """Those that find a vehicle's least penetration, the fastest first."""
    others = (resolve_solver(None),)
    return (Stagewise(), *others) if fits_stages(vehicle, SoftUnitNormalLine()) else others


def shallowest(
    scenario: Scenario,
    vehicle: VehicleModel,
    start: Trajectory,
    solvers: Sequence[Solver],
    *,
    objective: Objective,
    steps: int,
    margin: float,
    weight: float = 100.0,
    deadline: float = np.inf,
) -> Penetration:
    """:func:`minimum_penetration` from a trajectory, by the first solver that succeeds.

    After ``deadline``, by the clock of :func:`time.perf_counter`, s, the solver stops, and no pair is added any more.
    """
    grid = TimeGrid.uniform(steps)
    settings = Settings(objective, SoftSignedDistance(), margin=margin, penalty_weight=weight)
    found: list[tuple[SolveReport, Trajectory]] = []
    for solver in solvers:
        found.append(_solved(scenario, vehicle, start, settings, grid, solver, deadline))
        if found[-1][0].status.success or time.perf_counter() > deadline:
            break
    report, trajectory = min(found, key=lambda one: (not one[0].status.success, not one[0].violation <= FEASIBLE))
    if not report.violation <= FEASIBLE:
        reason = f"The solver found no trajectory, with collisions or without: {report.status.sentence}"
        raise PlanningError(reason, trajectory=trajectory, report={"solve": report.to_dict(), "rounds": []})
    return measured(scenario, vehicle, trajectory, report)


def _solved(
    scenario: Scenario,
    vehicle: VehicleModel,
    start: Trajectory,
    settings: Settings,
    grid: TimeGrid,
    solver: Solver,
    deadline: float,
) -> tuple[SolveReport, Trajectory]:
    """By one solver; solved again with the pairs that the solution comes too near to."""
    active = Room.of_guess(start, grid, scenario, vehicle).obstacles < REACH
    for _ in range(PASSES):
        limited = solver.with_time_limit(deadline - time.perf_counter())
        report, trajectory = _once(scenario, vehicle, start, settings, grid, limited, active)
        if not report.violation <= FEASIBLE:
            break
        near = Room.of_guess(trajectory, grid, scenario, vehicle).obstacles
        if not ((near < settings.margin) & ~active).any() or time.perf_counter() > deadline:
            break
        active, start = active | (near < REACH), trajectory
    return report, trajectory


def _once(
    scenario: Scenario,
    vehicle: VehicleModel,
    start: Trajectory,
    settings: Settings,
    grid: TimeGrid,
    solver: Solver,
    active: NDArray[np.bool_],
) -> tuple[SolveReport, Trajectory]:
    """From arrays by the stagewise solver, from the nonlinear program by others."""
    if not isinstance(solver, Stagewise):
        program = transcribe(scenario, vehicle, start, settings, grid=grid, active=active)
        solved = solver.solve(program.nlp)
        return solved, program.trajectory(np.nan_to_num(solved.x))
    lines = replace(settings, formulation=SoftUnitNormalLine())
    report = solver.solve_stages(stage_problem(scenario, vehicle, start, lines, grid=grid, active=active))
    return report, _trajectory(report, grid, vehicle)


def _trajectory(report: StageReport, grid: TimeGrid, vehicle: VehicleModel) -> Trajectory:
    assert report.states is not None
    assert report.inputs is not None
    t = np.nan_to_num(report.final_time, nan=1.0) * grid.fractions
    states, inputs = np.nan_to_num(report.states), np.nan_to_num(report.inputs)
    return Trajectory(t, states, inputs, vehicle.state_names, vehicle.input_names)
