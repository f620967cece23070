"""When no trajectory is free of collisions: where a vehicle collides that penetrates as little as it can."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, PlanningError, Problem
from tightspot.formulations import SoftSignedDistance
from tightspot.guesses import Guess, LinearInterpolation, guess
from tightspot.planner.mesh import steps_for
from tightspot.planner.pairs import sampled_clearance
from tightspot.planner.request import resolve_solver, resolve_vehicle
from tightspot.planner.rounds import FEASIBLE
from tightspot.scenarios import Scenario, check, load
from tightspot.solvers import Solver, SolveReport
from tightspot.trajectory import Trajectory
from tightspot.transcription import Objective, Settings, TimeGrid, transcribe
from tightspot.vehicles import VehicleModel
from tightspot.verification.replay import replay

Array = NDArray[np.float64]

TOUCH = 1e-4
SAMPLES = 12


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
    """

    part: str
    obstacle: str
    start: float
    end: float
    time: float
    depth: float

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
        solve: The solver's report.
    """

    trajectory: Trajectory
    contacts: tuple[Contact, ...]
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
    settings = Settings(objective or Objective(), SoftSignedDistance(), margin=margin, penalty_weight=weight)
    grid = TimeGrid.uniform(steps or steps_for(found.trajectory))
    problem = transcribe(scene, car, found.trajectory, settings, grid=grid)
    report = resolve_solver(solver).solve(problem.nlp)
    trajectory = problem.trajectory(np.nan_to_num(report.x))
    if not report.violation <= FEASIBLE:
        reason = f"The solver found no trajectory, with collisions or without: {report.status.sentence}"
        raise PlanningError(reason, trajectory=trajectory, report={"solve": report.to_dict(), "rounds": []})
    motion = replay(car, trajectory)
    times = np.unique(np.linspace(trajectory.t[:-1], trajectory.t[1:], SAMPLES + 1))
    clear = sampled_clearance(motion.at(times), scene, car)
    return Penetration(replace(trajectory, states=motion.knots), contacts_of(times, clear, scene, car), report)


def contacts_of(times: Array, clear: Array, scenario: Scenario, vehicle: VehicleModel) -> tuple[Contact, ...]:
    """Contacts of a motion sampled at times (M,) with signed distances (M, parts, obstacle parts), deepest first."""
    contacts = []
    for i, part in enumerate(vehicle.parts):
        for j, (name, _) in enumerate(scenario.obstacle_parts):
            overlaps = np.flatnonzero(clear[:, i, j] < -TOUCH)
            for run in np.split(overlaps, np.flatnonzero(np.diff(overlaps) > 1) + 1) if overlaps.size else ():
                deepest = run[np.argmin(clear[run, i, j])]
                ends = float(times[run[0]]), float(times[run[-1]])
                contacts.append(Contact(part.name, name, *ends, float(times[deepest]), float(-clear[deepest, i, j])))
    return tuple(sorted(contacts, key=lambda contact: -contact.depth))
