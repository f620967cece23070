"""Scenes without a plan, and shapely's word on poses in them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import shapely
from shapely import affinity

from tightspot.scenarios import Scenario
from tightspot.vehicles import VehicleModel, vehicle

PAPER = vehicle("paper")
WIDTH = 2.097
MARGIN = 0.05


def box(name: str, x_min: float, x_max: float, y_min: float, y_max: float) -> dict[str, Any]:
    return {"name": name, "vertices": [[x_min, y_min], [x_max, y_min], [x_max, y_max], [x_min, y_max]]}


def gap(width: float, *more: dict[str, Any], x: float = 0.0, y: float = 0.0, angle: float = 0.0) -> Scenario:
    """A corridor with a gap between ``left`` and ``right`` at x = 6 to 9, turned about the origin, then shifted."""
    R = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])

    def at(points: Any) -> Any:
        return (np.asarray(points, float) @ R.T + [x, y]).tolist()

    def state(given: tuple[float, float]) -> dict[str, float]:
        place = at(given)
        return {"x": place[0], "y": place[1], "theta": angle}

    obstacles = [box("left", 6, 9, width / 2, 4), box("right", 6, 9, -4, -width / 2), *more]
    return Scenario.from_dict(
        {
            "name": "gap",
            "workspace": at([[-3, -4], [20, -4], [20, 4], [-3, 4]]),
            "obstacles": [{"name": o["name"], "vertices": at(o["vertices"])} for o in obstacles],
            "start": state((0, 0)),
            "goal": state((13, 0)),
        }
    )


def alley(width: float) -> Scenario:
    """A bay across a narrow alley, wide enough for the car's discs and too narrow to turn into."""
    return Scenario.from_dict(
        {
            "name": "alley",
            "workspace": {"x": [-3, 20], "y": [-8, width]},
            "obstacles": [box("sidewalk", -4, 8, -9, 0), box("shop", 10.4, 21, -9, 0)],
            "start": {"x": 0, "y": width / 2, "theta": 0},
            "goal": {"x": 9.2, "y": -5.5, "theta": math.pi / 2},
        }
    )


def footprint(pose: Any, car: VehicleModel = PAPER) -> Any:
    body = shapely.union_all([shapely.Polygon(part.polygon.vertices) for part in car.parts])
    return affinity.translate(affinity.rotate(body, pose[2], origin=(0, 0), use_radians=True), *pose[:2])


def clearance(scenario: Scenario, pose: Any, car: VehicleModel = PAPER) -> float:
    """Distance of the standing car from the nearest obstacle, 0 if they overlap, m."""
    shapes = [shapely.Polygon(obstacle.exterior) for obstacle in scenario.obstacles]
    return float(footprint(pose, car).distance(shapely.union_all(shapes)))
