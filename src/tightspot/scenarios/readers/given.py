"""What the caller says about a scene: it goes before what the file says, and stands in for what it cannot say."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from tightspot import vehicles
from tightspot.errors import Problem, SceneError
from tightspot.problems import shown
from tightspot.scenarios.scenario import Scenario
from tightspot.scenarios.states import STATE
from tightspot.vehicles import VehicleModel

State = str | Sequence[float | None] | Mapping[str, Any]
"""x, y, theta[, v[, delta]] as text or numbers, or an object as in a scene file; metres, radians, file coordinates."""


@dataclass(frozen=True)
class Given:
    """What the caller gave; ``None`` leaves the file's.

    Attributes:
        start, goal, vehicle, margin: Fields of the scene file.
        unknown: What unknown cells of an occupancy map are, ``occupied`` or ``free``.
    """

    start: Mapping[str, Any] | None = None
    goal: Mapping[str, Any] | None = None
    vehicle: str | Mapping[str, Any] | None = None
    margin: float | None = None
    unknown: Literal["occupied", "free"] | None = None

    @classmethod
    def of(
        cls,
        start: State | None = None,
        goal: State | None = None,
        vehicle: VehicleModel | str | Path | Mapping[str, Any] | None = None,
        margin: float | None = None,
        unknown: str | None = None,
    ) -> Given:
        """From the arguments of :func:`tightspot.load`; raises :class:`SceneError` or :class:`VehicleError`."""
        if unknown not in ("occupied", "free", None):
            raise SceneError(Problem("unknown", f"{shown(unknown)} must be occupied or free"))
        policy: Literal["occupied", "free"] | None = unknown  # type: ignore[assignment]
        return cls(_state("start", start), _state("goal", goal), _vehicle(vehicle), margin, policy)

    def over(self, data: Mapping[str, Any]) -> dict[str, Any]:
        """A scene object with what was given in its place."""
        given = {key: getattr(self, key) for key in ("start", "goal", "vehicle", "margin")}
        return {**data, **{key: value for key, value in given.items() if value is not None}}

    def over_scenario(self, scenario: Scenario) -> Scenario:
        """A scenario with what was given in its place; the same one if that is nothing."""
        return scenario if self == Given(unknown=self.unknown) else Scenario.from_dict(self.over(scenario.to_dict()))


def require_ends(data: Mapping[str, Any], where: str) -> None:
    """Refuse a scene object without start or goal, which this format need not hold.

    Args:
        data: The scene object.
        where: How the file itself can say it, with ROLE for the one that is missing: ``a feature with role ROLE``.

    Raises:
        SceneError: One problem for each.
    """
    problems = [
        Problem(
            key, f"is missing; give --{key} x,y,theta ({key}=(x, y, theta) in Python) or {where.replace('ROLE', key)}"
        )
        for key in ("start", "goal")
        if data.get(key) is None
    ]
    if problems:
        raise SceneError(problems)


def _state(key: str, value: State | None) -> Mapping[str, Any] | None:
    if value is None or isinstance(value, Mapping):
        return value
    items: Sequence[Any] = value.split(",") if isinstance(value, str) else _items(value)
    if not 3 <= len(items) <= len(STATE):
        raise SceneError(Problem(key, f"{shown(value)} must be x,y,theta in metres and radians (then v, delta)"))
    return {name: _number(key, name, item) for name, item in zip(STATE, items, strict=False)}


def _items(value: Sequence[float | None]) -> list[Any]:
    try:
        return list(value)
    except TypeError:
        return []


def _number(key: str, name: str, item: Any) -> float | None:
    if item is None or (isinstance(item, str) and item.strip() == "free"):
        return None
    try:
        number = float(item)
    except (TypeError, ValueError, OverflowError):
        sentence = f"{shown(item)} is not a number; give {key} as x,y,theta in metres and radians"
        raise SceneError(Problem(f"{key}.{name}", sentence)) from None
    return None if np.isnan(number) and name in ("v", "delta") else number


def _vehicle(value: VehicleModel | str | Path | Mapping[str, Any] | None) -> str | Mapping[str, Any] | None:
    if value is None or isinstance(value, Mapping) or (isinstance(value, str) and value in vehicles.CATALOGUE):
        return value
    if isinstance(value, VehicleModel):
        return value.to_dict()
    return vehicles.load_vehicle(value).to_dict()
