"""What people call the convex parts that planner and judge see."""

from __future__ import annotations

from tightspot.scenarios.scenario import Scenario


def labels(scenario: Scenario) -> dict[str, str]:
    """For each name in :attr:`Scenario.obstacle_parts` the obstacle that the part is of, or ``a+b`` if of both."""
    return dict(zip(scenario.part_names, scenario.part_labels, strict=True))
