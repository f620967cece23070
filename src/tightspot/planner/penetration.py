"""Where, when and how deep a motion collides."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from tightspot.geometry import transform
from tightspot.scenarios import Scenario
from tightspot.solvers import SolveReport
from tightspot.trajectory import Trajectory
from tightspot.vehicles import VehicleModel
from tightspot.verification.replay import replay
from tightspot.verification.sampled import sampled_clearance

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


def measured(scenario: Scenario, vehicle: VehicleModel, trajectory: Trajectory, solve: SolveReport) -> Penetration:
    """Where the trajectory's inputs, integrated from its start, lead into obstacles."""
    motion = replay(vehicle, trajectory)
    times = np.unique(np.linspace(trajectory.t[:-1], trajectory.t[1:], SAMPLES + 1))
    states = motion.at(times)
    clear = sampled_clearance(states, scenario, vehicle)
    contacts = contacts_of(times, states, clear, scenario, vehicle)
    nearest = None
    if clear.size:
        k, i, j = np.unravel_index(int(clear.argmin()), clear.shape)
        nearest = _contact(times, states, clear, scenario, vehicle, np.array([k]), int(i), int(j))
    return Penetration(replace(trajectory, states=motion.knots), contacts, nearest, solve)


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
