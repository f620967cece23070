"""A start or goal that the vehicle cannot take: what is in the way, how deep, and what would free it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import Problem
from tightspot.scenarios.clearances import Clearance, body_vertices, clearances, workspace_excess
from tightspot.scenarios.remedies import SLACK, largest_width, overlap_depth, shortest_move, smallest_turn
from tightspot.scenarios.scenario import Scenario
from tightspot.vehicles import VehicleModel, body_width

Array = NDArray[np.float64]

_SIDES = {(1, 0): "right (+x)", (-1, 0): "left (-x)", (0, 1): "upper (+y)", (0, -1): "lower (-y)"}


@dataclass(frozen=True, eq=False)
class Blocked:
    """Why the vehicle cannot stand at the start or the goal. Each remedy cures alone, whatever is in the way.

    Attributes:
        end: Which of the two.
        margin: Demanded clearance, m.
        obstacles: Those that are overlapped or nearer than the margin, worst first. The depth of an overlap is the
            shortest displacement of the whole body out of that obstacle, the part the one that overlaps most.
        outside: How far the body reaches out of the workspace, m; 0 if it does not.
        side: Of the workspace, for people; empty if the body is inside.
        move: Shortest displacement that frees it with the same heading, m, m; ``None`` if there is none.
        turn: Smallest change of heading that frees it in the same place, rad; ``None`` if there is none.
        width: Largest width of the body that fits in this pose, m; ``None`` if narrowing to the half does not help.
        width_now: Width of the body, m.
        margin_that_fits: Largest margin that this pose keeps, in whole mm, m; ``None`` if that is none at all.
    """

    end: Literal["start", "goal"]
    margin: float
    obstacles: tuple[Clearance, ...]
    outside: float
    side: str
    move: tuple[float, float] | None
    turn: float | None
    width: float | None
    width_now: float
    margin_that_fits: float | None

    @property
    def depth(self) -> float:
        """How deep the deepest obstacle is overlapped, m; 0 if none is."""
        return max((-found.value for found in self.obstacles), default=0.0) if self.overlapped else 0.0

    @property
    def overlapped(self) -> tuple[Clearance, ...]:
        """The obstacles that are overlapped, deepest first; the others are too near."""
        return tuple(found for found in self.obstacles if found.value < 0)

    @property
    def problems(self) -> list[Problem]:
        """One for each obstacle and for the workspace, with the remedies."""
        remedy = self.remedy
        return [Problem(self.end, f"{fault}; {remedy}") for fault in self.faults]

    @property
    def faults(self) -> list[str]:
        """What is wrong with each obstacle and with the workspace, in words."""
        found = [self._obstacle_fault(item) for item in self.obstacles]
        if self.outside:
            found.append(f"the body reaches {_length(self.outside)} out of the workspace on its {self.side} side")
        return found

    @property
    def remedy(self) -> str:
        """What would free it, in words."""
        ways = []
        if self.move is not None:
            ways.append(_moved(self.move))
        if self.turn is not None:
            ways.append(f"if turned by {math.degrees(self.turn):+.1f} deg")
        if self.width is not None:
            ways.append(f"with a body {self.width:.3f} m wide (now {self.width_now:.3f} m)")
        if self.margin_that_fits is not None:
            ways.append(f"with a margin of {self.margin_that_fits:g} m")
        if not ways:
            return "it fits nowhere in the workspace with this heading; check the vehicle and the scene's units"
        where = "" if self.move is not None else "; no other place in the workspace would do with this heading"
        return f"it would fit {' or '.join(ways)}{where}"

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "end": self.end,
            "margin": self.margin,
            "obstacles": [
                {"name": found.obstacle, "part": found.part, "clearance": found.value} for found in self.obstacles
            ],
            "outside_workspace": self.outside,
            "workspace_side": self.side or None,
            "move": None if self.move is None else list(self.move),
            "turn": self.turn,
            "width": self.width,
            "width_now": self.width_now,
            "margin_that_fits": self.margin_that_fits,
        }

    def _obstacle_fault(self, found: Clearance) -> str:
        body, obstacle = f"the vehicle's {found.part}", f"obstacle {found.obstacle!r}"
        if found.value < 0:
            return f"{body} overlaps {obstacle} by {_length(-found.value)}"
        return f"{body} is {_length(found.value)} from {obstacle}, nearer than the margin of {self.margin:g} m"


def blocked(scenario: Scenario, vehicle: VehicleModel, margin: float, end: Literal["start", "goal"]) -> Blocked | None:
    """What blocks the start or the goal, or ``None`` if the vehicle can stand there.

    Args:
        scenario: The scene.
        vehicle: The vehicle.
        margin: Demanded clearance, m.
        end: Which of the two.
    """
    state = getattr(scenario, end)
    bodies = body_vertices(vehicle, state)
    near = clearances(scenario, vehicle, state, margin, bodies)
    obstacles = tuple(
        sorted(
            (_whole(scenario, vehicle, state, found) for found in near if found.value < margin - SLACK),
            key=lambda found: found.value,
        )
    )
    excess, normal = workspace_excess(scenario, vehicle, state, bodies)
    is_outside = excess > SLACK
    if not (obstacles or is_outside):
        return None
    spare = -1.0 if is_outside else np.floor(min(found.value for found in obstacles) * 1000) / 1000
    pose = scenario, vehicle, state, margin
    return Blocked(
        end=end,
        margin=margin,
        obstacles=obstacles,
        outside=excess if is_outside else 0.0,
        side=_side(normal) if is_outside else "",
        move=shortest_move(*pose),
        turn=smallest_turn(*pose),
        width=largest_width(*pose),
        width_now=body_width(vehicle),
        margin_that_fits=float(spare) if spare > 0 else None,
    )


def _whole(scenario: Scenario, vehicle: VehicleModel, state: Array, found: Clearance) -> Clearance:
    """With the overlap of the whole body and the whole obstacle rather than of the worst pair of convex parts."""
    if found.value >= 0:
        return found
    return found._replace(value=min(found.value, -overlap_depth(scenario, vehicle, state, found.obstacle)))


def _side(normal: Array) -> str:
    return _SIDES.get((round(normal[0], 6), round(normal[1], 6)), f"({normal[0]:.2f}, {normal[1]:.2f})")


def _length(value: float) -> str:
    """In mm, or as many digits as it takes to be more than nothing."""
    return f"{value:.3f} m" if value >= 5e-4 else f"{value:.1g} m"


def _moved(step: tuple[float, float]) -> str:
    decimals = 3 if all(round(value, 3) == value for value in step) else 6
    return f"if moved by ({step[0]:+.{decimals}f}, {step[1]:+.{decimals}f}) m"
