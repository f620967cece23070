"""From a seed and an index to a scene."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from benchmarks.random_scenes.bays import oblique, parallel, perpendicular
from benchmarks.random_scenes.car import Car, Pose
from benchmarks.random_scenes.clutter import clutter, mixture
from benchmarks.random_scenes.corridors import corridor
from benchmarks.random_scenes.enclosures import enclosure
from benchmarks.random_scenes.layout import ROOM, Layout, NoLayoutError, box
from tightspot import scenarios, vehicles
from tightspot.errors import InputError
from tightspot.scenarios import Scenario

Array = NDArray[np.float64]
Rng = np.random.Generator

FAMILIES: dict[str, tuple[float, Callable[[Rng, Car], Layout]]] = {
    "perpendicular": (0.22, perpendicular),
    "parallel": (0.14, parallel),
    "oblique": (0.14, oblique),
    "enclosure": (0.14, enclosure),
    "clutter": (0.15, clutter),
    "corridor": (0.10, corridor),
    "mixture": (0.11, mixture),
}
"""Share of the scenes and generator, by name."""

CARS = {"paper": 0.3, "tpcap": 0.25, "lincoln-mkz": 0.2, "obca": 0.15, "forklift": 0.1}
"""Share of the scenes by vehicle of the catalogue; the forklift's body has three parts."""

LARGEST_MARGIN = 0.1
MOST_DRAWS = 500


@dataclass(frozen=True, eq=False)
class RandomScene:
    """A scene with what it was drawn as.

    Attributes:
        scenario: Start and goal are free, and joined for a disc that fits into the vehicle.
        family: Key of :data:`FAMILIES`.
        kind: For people.
        ratio: See :class:`benchmarks.random_scenes.layout.Layout`; infinite for a yard.
        seed: The sequence's seed.
        index: Place in the sequence.
    """

    scenario: Scenario
    family: str
    kind: str
    ratio: float
    seed: int
    index: int

    def facts(self) -> dict[str, Any]:
        """What tells the scene apart, as plain data."""
        return {
            "name": self.scenario.name,
            "seed": self.seed,
            "index": self.index,
            "family": self.family,
            "kind": self.kind,
            "ratio": round(self.ratio, 6) if math.isfinite(self.ratio) else None,
            "vehicle": self.scenario.vehicle,
            "margin": self.scenario.margin,
            "obstacles": len(self.scenario.obstacles),
        }


def random_scene(seed: int, index: int) -> RandomScene:
    """Scene number ``index`` of the sequence that ``seed`` names; always the same."""
    rng = np.random.default_rng([seed, index])
    names = list(FAMILIES)
    family = names[rng.choice(len(names), p=[share for share, _ in FAMILIES.values()])]
    car_name = list(CARS)[rng.choice(len(CARS), p=list(CARS.values()))]
    car = Car.of(vehicles.vehicle(car_name))
    for _ in range(MOST_DRAWS):
        try:
            layout = FAMILIES[family][1](rng, car)
        except NoLayoutError:
            continue
        margin = _margin(rng, layout)
        if _possible(car, layout, margin):
            if rng.random() < 0.2:
                layout = dataclasses.replace(
                    layout, start=layout.goal, goal=layout.start, kind=f"{layout.kind}, undone"
                )
            scene = _placed(rng, car, layout, margin, f"{family}-s{seed}-i{index:04d}", seed, index)
            return RandomScene(scene, family, layout.kind, layout.ratio, seed, index)
    raise RuntimeError(f"no scene of family {family} in {MOST_DRAWS} draws; widen its ranges")


def _margin(rng: Rng, layout: Layout) -> float:
    """0 to 0.1 m, at most half of what is left beside the car in the narrowest place; rounded to millimetres."""
    wanted = 0.0 if rng.random() < 0.2 else float(rng.uniform(0.0, LARGEST_MARGIN))
    return math.floor(1000 * min(wanted, 0.5 * layout.gap)) / 1000


def _possible(car: Car, layout: Layout, margin: float) -> bool:
    """Start and goal are free with some room, and a disc that fits into the body could roll from one to the other."""
    W, shapes = shapely.Polygon(box(*layout.workspace)), layout.shapes
    if not 1 <= len(shapes) <= 10:
        return False
    if not all(car.stands(pose, W, shapes, margin + ROOM) for pose in (layout.start, layout.goal)):
        return False
    free = W.buffer(-car.disc).difference(shapely.union_all(shapes).buffer(car.disc + margin))
    ends = [shapely.Point(pose[:2]) for pose in (layout.start, layout.goal)]
    pieces = shapely.get_parts(free)
    return any(all(piece.distance(end) < 1e-3 for end in ends) for piece in pieces)


def _placed(rng: Rng, car: Car, layout: Layout, margin: float, name: str, seed: int, index: int) -> Scenario:
    """The layout mirrored or not, turned and moved; checked by the door."""
    mirror = bool(rng.random() < 0.5)
    angle = 0.0 if rng.random() < 0.2 else float(rng.uniform(-math.pi, math.pi))
    shift = rng.uniform(-50, 50, 2)
    if rng.random() < 0.08:
        shift = rng.uniform([3e5, 4e6], [7e5, 6e6])
    move = _Move(mirror, angle, shift)
    data = {
        "name": name,
        "description": f"{layout.kind}; narrowest place over vehicle: {layout.ratio:.3f}",
        "source": f"benchmarks.random_scenes, seed {seed}, index {index}",
        "vehicle": car.name,
        "margin": margin,
        "workspace": move.points(box(*layout.workspace)).tolist(),
        "obstacles": [{"name": key, "vertices": move.points(ring).tolist()} for key, ring in layout.obstacles.items()],
        "start": move.pose(layout.start),
        "goal": move.pose(layout.goal),
    }
    scene = Scenario.from_dict(data)
    try:
        scenarios.check(scene, scene.vehicle_model(), margin)
    except InputError as error:
        raise RuntimeError(
            f"{name}: the generator takes start and goal for free, tightspot does not: {error}"
        ) from None
    return scene


@dataclass(frozen=True, eq=False)
class _Move:
    """A reflection at the x axis if wanted, then a turn, then a shift; coordinates are rounded to micrometres."""

    mirror: bool
    angle: float
    shift: Array

    def points(self, points: Array) -> Array:
        side = -1.0 if self.mirror else 1.0
        c, s = math.cos(self.angle), math.sin(self.angle)
        x, y = points[:, 0], side * points[:, 1]
        return np.round(np.stack([c * x - s * y, s * x + c * y], axis=1) + self.shift, 6)

    def pose(self, pose: Pose) -> dict[str, float]:
        x, y = self.points(np.array([pose[:2]]))[0]
        theta = self.angle + (-pose[2] if self.mirror else pose[2])
        return {"x": float(x), "y": float(y), "theta": round(math.remainder(theta, math.tau), 9)}
