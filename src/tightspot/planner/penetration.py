"""When no trajectory is free of collisions: where a vehicle collides that penetrates as little as it can."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import NDArray

from tightspot.errors import InputError, PlanningError, Problem
from tightspot.formulations import SoftSignedDistance
from tightspot.geometry import transform
from tightspot.guesses import Guess, LinearInterpolation, guess
from tightspot.planner.mesh import steps_for
from tightspot.planner.pairs import Room
from tightspot.planner.request import resolve_solver, resolve_vehicle
from tightspot.planner.rounds import FEASIBLE
from tightspot.scenarios import Scenario, check, load
from tightspot.solvers import Solver, SolveReport
from tightspot.trajectory import Trajectory
from tightspot.transcription import Objective, Settings, TimeGrid, transcribe
from tightspot.vehicles import VehicleModel
from tightspot.verification.replay import replay
from tightspot.verification.sampled import sampled_clearance

Array = NDArray[np.float64]

TOUCH = 1e-4
SAMPLES = 12
REACH = 1.5
"""Pairs that the start comes this near to are penalised from the beginning, m; others once they are penetrated."""
PASSES = 4


@dataclass(frozen=True)
class Contact:
    """A stretch of time in which a part of the body overlaps a part of an obstacle.

    Attributes:
        part: The body part's name.
        obstacle: The obstacle's name.
        start: First sampled time of the overlap, s.
        end: Last sampled time of the overlap, s.
        time: When it is deepest, s.
        depth: How deep it is then, m: the length of the shortest translation that parts the two.
        pose: (x m, y m, theta rad) of the vehicle then, in the scenario's coordinates.
        place: The middle of the overlap, m, in the scenario's coordinates.
    """

    part: str
    obstacle: str
    start: float
    end: float
    time: float
    depth: float
    pose: tuple[float, float, float]
    place: tuple[float, float]

    def __str__(self) -> str:
        return (
            f"{self.part} penetrates {self.obstacle} by {self.depth:.3f} m at {self.time:.2f} s "
            f"(from {self.start:.2f} s to {self.end:.2f} s)"
        )


@dataclass(frozen=True, eq=False)
class Penetration:
    """A trajectory that collides as little as a local search could make it. Not a plan: nothing is certified.

    Attributes:
        trajectory: The replayed motion at the knots.
        contacts: Where it collides, deepest first; empty if it does not at any sample.
        nearest: The sampled moment at which a part comes nearest to an obstacle part, as a contact of no duration whose
            depth is minus the distance if they do not overlap; ``None`` without obstacles.
        solve: The solver's report.
    """

    trajectory: Trajectory
    contacts: tuple[Contact, ...]
    nearest: Contact | None
    solve: SolveReport

    @property
    def depth(self) -> float:
        """The deepest contact's depth, m; 0 without contacts."""
        return max((contact.depth for contact in self.contacts), default=0.0)

    def __str__(self) -> str:
        if not self.contacts:
            return "No collision found: a plan may exist."
        return "; ".join(str(contact) for contact in self.contacts)


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
    pairs, with the soft form of (21). The overlaps reported are measured on the replayed motion, between the knots,
    too. A local minimum near the guess; another guess may find a shallower one.

    Args:
        scenario: A scenario, the name of a built-in one, or a file. Start and goal must be free.
        vehicle: A vehicle, a catalogue name or a file; default: the scenario's.
        objective: Default: the paper's eq. (25), r = 1, P = diag(1, 2).
        guess_: A member or its name; default: ``linear``, since others may find none where none is free.
        solver: A backend or its name; default: IPOPT.
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
    method = guess(guess_) if isinstance(guess_, str) else guess_ or LinearInterpolation()
    found = method.make(scene, car, margin=margin)
    if found.trajectory is None:
        raise PlanningError(found.reason, report={"guess": found.report, "rounds": []})
    return shallowest(
        scene,
        car,
        found.trajectory,
        resolve_solver(solver),
        objective=objective or Objective(),
        steps=steps or steps_for(found.trajectory),
        margin=margin,
        weight=weight,
    )


def shallowest(
    scenario: Scenario,
    vehicle: VehicleModel,
    start: Trajectory,
    solver: Solver,
    *,
    objective: Objective,
    steps: int,
    margin: float,
    weight: float = 100.0,
    deadline: float = np.inf,
) -> Penetration:
    """:func:`minimum_penetration` from a trajectory.

    After ``deadline``, by the clock of :func:`time.perf_counter`, s, the solver stops, and no pair is added any more.
    """
    grid = TimeGrid.uniform(steps)
    active = Room.of_guess(start, grid, scenario, vehicle).obstacles < REACH
    settings = Settings(objective, SoftSignedDistance(), margin=margin, penalty_weight=weight)
    for _ in range(PASSES):
        problem = transcribe(scenario, vehicle, start, settings, grid=grid, active=active)
        limited = solver.with_time_limit(deadline - time.perf_counter())
        report = limited.solve(problem.nlp)
        trajectory = problem.trajectory(np.nan_to_num(report.x))
        if not report.violation <= FEASIBLE:
            reason = f"The solver found no trajectory, with collisions or without: {report.status.sentence}"
            raise PlanningError(reason, trajectory=trajectory, report={"solve": report.to_dict(), "rounds": []})
        near = Room.of_guess(trajectory, grid, scenario, vehicle).obstacles
        if not ((near < margin) & ~active).any() or time.perf_counter() > deadline:
            break
        active, start = active | (near < REACH), trajectory
    motion = replay(vehicle, trajectory)
    times = np.unique(np.linspace(trajectory.t[:-1], trajectory.t[1:], SAMPLES + 1))
    states = motion.at(times)
    clear = sampled_clearance(states, scenario, vehicle)
    contacts = contacts_of(times, states, clear, scenario, vehicle)
    nearest = None
    if clear.size:
        k, i, j = np.unravel_index(int(clear.argmin()), clear.shape)
        nearest = _contact(times, states, clear, scenario, vehicle, np.array([k]), int(i), int(j))
    return Penetration(replace(trajectory, states=motion.knots), contacts, nearest, report)


def contacts_of(
    times: Array, states: Array, clear: Array, scenario: Scenario, vehicle: VehicleModel
) -> tuple[Contact, ...]:
    """Contacts of a motion, deepest first.

    Args:
        times: Of the samples, s, (M,).
        states: At these times, (M, n_x).
        clear: Signed distances, m, (M, parts, obstacle parts).
        scenario: Whose obstacles.
        vehicle: Whose parts.
    """
    contacts = []
    for i in range(len(vehicle.parts)):
        for j in range(len(scenario.obstacle_parts)):
            overlaps = np.flatnonzero(clear[:, i, j] < -TOUCH)
            for run in np.split(overlaps, np.flatnonzero(np.diff(overlaps) > 1) + 1) if overlaps.size else ():
                contacts.append(_contact(times, states, clear, scenario, vehicle, run, i, j))
    return tuple(sorted(contacts, key=lambda contact: -contact.depth))


def _contact(
    times: Array,
    states: Array,
    clear: Array,
    scenario: Scenario,
    vehicle: VehicleModel,
    run: NDArray[np.intp],
    i: int,
    j: int,
) -> Contact:
    """The contact of part i and obstacle part j during consecutive samples."""
    deepest = run[np.argmin(clear[run, i, j])]
    part, (obstacle, polygon) = vehicle.parts[i], scenario.obstacle_parts[j]
    frame = np.array(vehicle.frames(list(states[deepest]), np)[part.frame], float)
    body, other = shapely.Polygon(transform(part.polygon.vertices, frame)), polygon.to_shapely()
    overlap = shapely.intersection(body, other)
    middle = shapely.centroid(shapely.shortest_line(body, other) if overlap.is_empty else overlap)
    x, y, theta = (float(value) for value in states[deepest, :3])
    return Contact(
        part=part.name,
        obstacle=obstacle,
        start=float(times[run[0]]),
        end=float(times[run[-1]]),
        time=float(times[deepest]),
        depth=float(-clear[deepest, i, j]),
        pose=(x, y, theta),
        place=(float(middle.x), float(middle.y)),
    )
