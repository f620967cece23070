"""What a plan file can say of coordinates far from the origin.

A plan file holds the scenario's original coordinates. Doubles near 4.5e9 m are a micrometre apart, so that
writing and reading moves the trajectory and the obstacles. What is judged must be what the file says: the
judge rounds first.
"""

from __future__ import annotations

import numpy as np

from tightspot.scenarios import Scenario
from tightspot.trajectory import Trajectory


def file_exact(scenario: Scenario, trajectory: Trajectory) -> tuple[Scenario, Trajectory]:
    """Scenario and trajectory as a plan file gives them back, both in recentred coordinates.

    They come back unchanged if the scenario has no offset, and from a second call in any case.
    """
    if not any(scenario.offset.tolist()):
        return scenario, trajectory
    for _ in range(8):
        rounded = trajectory.shifted(scenario.offset).shifted(-scenario.offset)
        if np.array_equal(rounded.states, trajectory.states):
            break
        trajectory = rounded
    return scenario.as_filed, trajectory
