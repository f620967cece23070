"""TPCAP files from scenes, as far as a list of numbers goes."""

from __future__ import annotations

from tightspot.scenarios.scenario import Scenario


def to_tpcap(scenario: Scenario) -> str:
    """Start and goal pose, and the exterior of each obstacle, in one line; what else a scene has is not in it."""
    data = scenario.to_dict()
    rings = [obstacle["vertices"] for obstacle in data["obstacles"]]
    values = [data[end][key] for end in ("start", "goal") for key in ("x", "y", "theta")]
    numbers = [*map(repr, values), str(len(rings)), *(str(len(ring)) for ring in rings)]
    numbers += [repr(value) for ring in rings for point in ring for value in point]
    return ",".join(numbers) + "\n"
