"""Times for a path, by the core."""

from __future__ import annotations

import numpy as np

from tightspot.search.core import compiled_core
from tightspot.search.path import Array, Path


def rolled(path: Path, first: float, last: float, **limits: float) -> tuple[Array, Array, Array]:
    """Knot times (K,), states (x, y, theta, v, delta) there, (K, 5), and inputs (a, omega), (K - 1, 2), along a path.

    See :func:`tightspot.guesses.lift_rolling`. Poses that do not move on are left out.

    Args:
        path: Of some length.
        first: Steering angle at its start, rad; NaN: as the path has it.
        last: The same at its end.
        limits: What ``RollingLimits`` of the core has: ``wheelbase``, m; ``steering``, rad; ``steering_rate``, rad/s;
            largest speeds ``forwards`` and ``backwards``, m/s, both positive; bounds ``slowest`` and ``fastest`` of the
            acceleration, m/s^2; ``half_window`` of the path over which steering is averaged, m.

    Raises:
        BuildError: The compiled core is missing.
    """
    core = compiled_core()
    table = np.empty((len(path.poses), 5))
    table[:, :3], table[:, 3], table[:, 4] = path.poses, path.curvature, path.gear
    found: tuple[Array, Array, Array] = core.rolling(table, first, last, core.RollingLimits(**limits))
    return found
