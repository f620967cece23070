"""A scene to plan in: workspace, obstacles, start, goal, and what counts as reached."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot import vehicles
from tightspot.errors import Problem, SceneError
from tightspot.geometry import ConvexPolygon, PolygonStack
from tightspot.scenarios.assemble import assemble, recentring
from tightspot.scenarios.boundary import Boundary
from tightspot.scenarios.filed import in_file
from tightspot.scenarios.obstacle import Obstacle
from tightspot.scenarios.schema import FORMAT, ToleranceSpec
from tightspot.scenarios.solids import Solid, member_of, solids
from tightspot.scenarios.states import as_state, free_steering, state_problems, to_dict
from tightspot.vehicles import VehicleModel

Array = NDArray[np.float64]


_OF_OBSTACLES = {"solids", "obstacle_parts", "obstacle_polygons", "part_names", "part_labels"}


@dataclass(frozen=True)
class Tolerance:
    """How near the goal counts as reached.

    Attributes:
        position: Distance of the rear-axle midpoint, m.
        heading: Smallest angle between the headings, rad.
        speed: m/s, where the goal's speed is not free.
        steering: rad, where the goal's steering angle is not free.
    """

    position: float = 0.01
    heading: float = math.radians(1)
    speed: float = 0.01
    steering: float = math.radians(1)

    @classmethod
    def from_spec(cls, spec: ToleranceSpec) -> Tolerance:
        """The scene file's tolerance."""
        return cls(spec.position, spec.heading, spec.speed, spec.steering)


@dataclass(frozen=True, eq=False, kw_only=True)
class Scenario:
    """Where a vehicle may be (W), what it must not touch, where it starts and where it shall stand.

    Attributes:
        name: For people and file names.
        workspace: W, the convex region that the body must not leave.
        obstacles: With different names; they may overlap each other and reach outside W. For planning those that
            touch are made one, see :attr:`solids`.
        start: (x, y, theta, v, delta) at the beginning, m, rad, m/s, shape (5,). NaN in v or delta: free. A pose
            (x, y, theta) may be given for a vehicle at rest with straight wheels.
        goal: The same at the end. Any multiple of 2 pi added to its heading is the same goal.
        tolerance: How near the goal counts as reached.
        vehicle: Name in the catalogue, or the vehicle's object as in a vehicle file.
        margin: Recommended demanded clearance, m.
        offset: What was subtracted from the file's coordinates, m, shape (2,): ``file = scenario + offset``.
        description: For people.
        source: Where the geometry comes from.
        boundary: The region that the body must not leave if that is not convex: then W contains it, and what lies
            between is a solid. ``None`` if W is the region itself.
        originals: ``start``, ``goal`` and ``workspace`` as the file has them if the coordinates differ, so that
            they can be written back bit for bit.

    Raises:
        SceneError: With all problems. Whether a vehicle fits there is for :func:`tightspot.scenarios.check`.
    """

    name: str
    workspace: ConvexPolygon
    obstacles: tuple[Obstacle, ...]
    start: Array
    goal: Array
    tolerance: Tolerance = Tolerance()
    vehicle: str | Mapping[str, Any] = "paper"
    margin: float = 0.05
    offset: Array = field(default_factory=lambda: np.zeros(2))
    description: str = ""
    source: str = ""
    boundary: Boundary | None = None
    originals: Mapping[str, Array] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        for key in ("start", "goal"):
            object.__setattr__(self, key, as_state(getattr(self, key), key))
        offset = np.array(self.offset, dtype=float)
        offset.setflags(write=False)
        object.__setattr__(self, "offset", offset)
        object.__setattr__(self, "obstacles", tuple(self.obstacles))
        problems = _problems(self)
        if problems:
            raise SceneError(problems)

    @cached_property
    def solids(self) -> tuple[Solid, ...]:
        """What planner and judge see: obstacles that touch each other, and what the boundary excludes, made one."""
        outside = self.boundary.outside() if self.boundary else None
        return solids([*map(member_of, self.obstacles), *([outside] if outside else [])])

    @cached_property
    def obstacle_parts(self) -> list[tuple[str, ConvexPolygon]]:
        """All solids' convex parts with unique names: solid ``wall`` has ``wall/0``, ``wall/1``, ..."""
        return [(f"{solid.name}/{index}", part) for solid in self.solids for index, part in enumerate(solid.parts)]

    @cached_property
    def obstacle_polygons(self) -> PolygonStack:
        """The polygons of :attr:`obstacle_parts`."""
        return PolygonStack(part for _, part in self.obstacle_parts)

    @cached_property
    def part_names(self) -> tuple[str, ...]:
        """The names of :attr:`obstacle_parts`."""
        return tuple(name for name, _ in self.obstacle_parts)

    @cached_property
    def part_labels(self) -> tuple[str, ...]:
        """Of each of the :attr:`obstacle_parts` the name of its obstacle, or ``a+b`` if it is of both."""
        return tuple(label for solid in self.solids for label in solid.labels)

    @cached_property
    def as_filed(self) -> Scenario:
        """The scenario as it comes back from its scene file: far from the origin, coordinates are rounded there."""
        return Scenario.from_dict(self.to_dict())

    def vehicle_model(self) -> VehicleModel:
        """The recommended vehicle; raises :class:`tightspot.errors.VehicleError` if there is none such."""
        if isinstance(self.vehicle, str):
            return vehicles.vehicle(self.vehicle)
        return vehicles.from_dict(self.vehicle)

    def with_(self, **changes: Any) -> Scenario:
        """A copy with some attributes changed, checked again."""
        if changes.keys() <= _ENDS:
            return self._with_ends(changes)
        copy = dataclasses.replace(self, **changes)
        if copy.obstacles == self.obstacles and copy.boundary is self.boundary:
            for key in _OF_OBSTACLES & self.__dict__.keys():  # computed on demand, then kept
                copy.__dict__[key] = self.__dict__[key]
        return copy

    def _with_ends(self, changes: dict[str, Any]) -> Scenario:
        """The same where nothing but the ends is other: the rest need not be looked at again."""
        kept = {name: value for name, value in self.__dict__.items() if name in _FIELDS or name in _OF_OBSTACLES}
        ends = {key: as_state(changes[key], key) for key in ("start", "goal") if key in changes}
        problems = [problem for key, state in ends.items() for problem in state_problems(key, state)]
        if problems:
            raise SceneError(problems)
        copy = object.__new__(type(self))
        copy.__dict__.update(kept, **(changes | ends))
        return copy

    def with_free_steering(self) -> Scenario:
        """A copy whose steering angle is free at the start and at the goal: the plan says how the wheels stand."""
        originals = {
            key: free_steering(value) if key in ("start", "goal") else value for key, value in self.originals.items()
        }
        return self.with_(start=free_steering(self.start), goal=free_steering(self.goal), originals=originals)

    def recentred(self) -> Scenario:
        """The same scene with the start near the origin if it was more than 10 km away, else itself."""
        step = recentring(self.start)
        if not step.any():
            return self
        state_step = np.array([*step, 0.0, 0.0, 0.0])
        return self.with_(
            workspace=self.workspace.transformed(-step[0], -step[1], 0.0),
            obstacles=tuple(obstacle.shifted(-step) for obstacle in self.obstacles),
            start=self.start - state_step,
            goal=self.goal - state_step,
            offset=self.offset + step,
            boundary=self.boundary and self.boundary.shifted(-step),
        )

    def to_dict(self) -> dict[str, Any]:
        """The scene file's object, plain data in the file's coordinates; :meth:`from_dict` reads it back."""
        corners = in_file(self.workspace.vertices, self.offset, self.originals.get("workspace"))
        return {
            "format": FORMAT,
            "name": self.name,
            "description": self.description,
            "source": self.source,
            "vehicle": self.vehicle if isinstance(self.vehicle, str) else dict(self.vehicle),
            "margin": self.margin,
            "workspace": self.boundary.to_data(self.offset) if self.boundary else corners.tolist(),
            "obstacles": [obstacle.to_dict(self.offset) for obstacle in self.obstacles],
            "start": to_dict(self.start, self.offset, self.originals.get("start")),
            "goal": to_dict(self.goal, self.offset, self.originals.get("goal")),
            "tolerance": dataclasses.asdict(self.tolerance),
        }

    @classmethod
    def from_dict(cls, data: Any, *, name: str = "scene") -> Scenario:
        """The scenario that a scene file's object describes.

        Args:
            data: Plain data, see :mod:`tightspot.scenarios.schema`.
            name: Its name if the data holds none.

        Raises:
            SceneError: With all problems, each with its path in the file.
        """
        fields = assemble(data, name)
        fields["tolerance"] = Tolerance.from_spec(fields["tolerance"])
        return cls(**fields)


_FIELDS = {field.name for field in dataclasses.fields(Scenario)}
_ENDS = {"start", "goal", "originals"}


def _problems(scenario: Scenario) -> list[Problem]:
    problems = state_problems("start", scenario.start) + state_problems("goal", scenario.goal)
    if not (math.isfinite(scenario.margin) and scenario.margin >= 0):
        problems.append(Problem("margin", f"{scenario.margin} m must be a finite clearance of 0 m or more"))
    if scenario.offset.shape != (2,) or not np.isfinite(scenario.offset).all():
        problems.append(Problem("offset", "must be two finite numbers [x, y], m"))
    for key, value in dataclasses.asdict(scenario.tolerance).items():
        if not (math.isfinite(value) and value > 0):
            problems.append(Problem(f"tolerance.{key}", f"{value} must be a finite number above 0"))
    return problems + _repeated_names(scenario.obstacles)


def _repeated_names(obstacles: Sequence[Obstacle]) -> list[Problem]:
    first: dict[str, int] = {}
    problems = []
    for index, obstacle in enumerate(obstacles):
        if obstacle.name in first:
            other = f"obstacles[{first[obstacle.name]}]"
            sentence = f"{obstacle.name!r} is already the name of {other}; names must differ"
            problems.append(Problem(f"obstacles[{index}].name", sentence))
        first.setdefault(obstacle.name, index)
    return problems
