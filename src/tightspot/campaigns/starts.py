"""Multi-start: random guesses that look for better optima than the table's."""

from __future__ import annotations

import numpy as np

from tightspot.trajectory import Trajectory
from tightspot.transcription import TimeGrid, resample

METHOD = "19-single"
"""Formulation (19) with one copy: the fastest of the paper's under IPOPT."""


def random_start(base: Trajectory, steps: int, number: int) -> Trajectory:
    """A path near ``base``, bent by three random sine waves, at rest, in 40 to 140 s; the same for the same number."""
    random = np.random.default_rng(number)
    s = np.linspace(0.0, 1.0, steps + 1)
    states = resample(base, TimeGrid.uniform(steps)).states.copy()
    states[:, 3:] = 0.0
    amplitudes = random.normal(0.0, 1.0, (3, 3)) * np.array([2.0, 2.0, 0.4])
    for wave, amplitude in enumerate(amplitudes, start=1):
        states[:, :3] += np.outer(np.sin(np.pi * wave * s), amplitude / wave)
    duration = float(np.exp(random.uniform(np.log(40.0), np.log(140.0))))
    inputs = np.zeros((steps, len(base.input_names)))
    return Trajectory(duration * s, states, inputs, base.state_names, base.input_names)
