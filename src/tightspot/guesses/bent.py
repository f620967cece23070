"""A trajectory bent a little: the same way with another shape and another pace."""

from __future__ import annotations

import numpy as np

from tightspot.errors import InputError, Problem
from tightspot.geometry.transforms import Array
from tightspot.guesses.perturbed import generator
from tightspot.trajectory import Trajectory

WAVES = 3
PACE = 1.4


def bent(trajectory: Trajectory, amount: float, seed: int, *, length: float) -> Trajectory:
    """The trajectory with smooth random changes of its poses and of its pace; both ends stay where they are.

    With ``s`` in [0, 1] the share of the time, the poses become ::

        (x, y, theta) + sum_{w = 1..3} (z_wx amount, z_wy amount, z_wt amount / length) sin(pi w s) / w

    with standard normal numbers ``z``, and all times are multiplied by a factor between 1 / 1.4 and 1.4; speeds and
    rates are divided by it. The result is a guess: it neither satisfies the dynamics nor the bounds between its ends.

    Args:
        trajectory: Of a vehicle whose states have columns ``x``, ``y`` and ``theta``, and perhaps ``v``.
        amount: How far positions move, m (standard deviation of the longest wave); 0: only the pace changes.
        seed: The same for the same seed; a whole number, 0 or more.
        length: Over which a move by ``amount`` turns the heading, m; a wheelbase is natural.

    Raises:
        InputError: A number is out of its range, or the trajectory has no pose.
    """
    _check(trajectory, amount, length)
    rng = generator(seed)
    s = (trajectory.t - trajectory.t[0]) / trajectory.duration
    waves = np.arange(1, WAVES + 1)
    moved = rng.normal(0.0, 1.0, (WAVES, 3)) * np.array([amount, amount, amount / length]) / waves[:, None]
    factor = float(np.exp(rng.uniform(-np.log(PACE), np.log(PACE))))
    shapes: Array = np.sin(np.pi * s[:, None] * waves)
    shapes[-1] = 0.0
    states = trajectory.states.copy()
    columns = [trajectory.state_names.index(name) for name in ("x", "y", "theta")]
    states[:, columns] += shapes @ moved
    if "v" in trajectory.state_names:
        states[:, trajectory.state_names.index("v")] /= factor
    t = trajectory.t[0] + factor * (trajectory.t - trajectory.t[0])
    return Trajectory(t, states, trajectory.inputs / factor, trajectory.state_names, trajectory.input_names)


def _check(trajectory: Trajectory, amount: float, length: float) -> None:
    problems = []
    if not (np.isfinite(amount) and amount >= 0):
        problems.append(Problem("amount", f"{amount} m must be a finite distance of 0 or more"))
    if not (np.isfinite(length) and length > 0):
        problems.append(Problem("length", f"{length} m must be a positive, finite distance"))
    missing = [name for name in ("x", "y", "theta") if name not in trajectory.state_names]
    if missing:
        problems.append(Problem("trajectory", f"has no state {', '.join(missing)}; only poses can be bent"))
    if problems:
        raise InputError(problems)
