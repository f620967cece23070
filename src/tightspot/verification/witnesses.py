"""Witnesses: when and how badly the pairs fail that have no proof."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tightspot.verification import compiled
from tightspot.verification.barriers import Pairs
from tightspot.verification.certificate import WORKSPACE, Witness
from tightspot.verification.cover import Cover
from tightspot.verification.motion import Motion

Array = NDArray[np.float64]
Index = NDArray[np.intp]

# The body may lie on the workspace's boundary, as a start pose against a wall does.
WORKSPACE_SLACK = 1e-6


def obstacle_witnesses(
    motion: Motion, pairs: Pairs, clear: Cover, margin: float, names: Sequence[str]
) -> list[Witness]:
    failed = np.flatnonzero(~clear.holds)
    if not failed.size:
        return []
    times, clearances = _worst_moments(motion, pairs, failed, clear)
    poses = motion.at(times)[:, :3]
    witnesses = []
    for pair, time, clearance, pose in zip(failed, times, clearances, poses, strict=True):
        pad = motion.pad[pairs.part[pair]]
        kind = "collision" if clearance < -pad else "margin" if clearance < margin - pad else "undecided"
        part, obstacle = motion.names[pairs.part[pair]], names[pairs.barrier[pair]]
        witnesses.append(Witness(float(time), part, obstacle, float(clearance), _pose(pose), kind))
    return witnesses


def workspace_witnesses(motion: Motion, walls: Pairs, inside: Cover) -> list[Witness]:
    """One witness a body part: the edge that it crosses furthest."""
    failed = np.flatnonzero(~inside.holds)
    if not failed.size:
        return []
    times, clearances = _worst_moments(motion, walls, failed, inside)
    poses = motion.at(times)[:, :3]
    witnesses = []
    for part in np.unique(walls.part[failed]):
        of_part = np.flatnonzero(walls.part[failed] == part)
        i = of_part[clearances[of_part].argmin()]
        kind = "collision" if clearances[i] < -motion.pad[part] - WORKSPACE_SLACK else "undecided"
        name = motion.names[part]
        witnesses.append(Witness(float(times[i]), name, WORKSPACE, float(clearances[i]), _pose(poses[i]), kind))
    return witnesses


def _worst_moments(motion: Motion, pairs: Pairs, chosen: Index, found: Cover) -> tuple[Array, Array]:
    """Times and clearances of the chosen pairs' worst moments: the cover's, refined by dense samples."""
    times, clearances = found.seen_at[chosen], found.seen[chosen]
    if motion.body is not None:
        return compiled.worst_moments(motion.body, pairs.core, chosen, times, clearances)
    t = motion.t
    for width in (2e-2, 2.5e-3, 3e-4, 4e-5):
        if not chosen.size:
            break
        samples = np.clip(times[:, None] + np.linspace(-width, width, 17), t[0], t[-1])
        pair = np.repeat(chosen, samples.shape[1])
        vertices = motion.vertices(pairs.part[pair], motion.at(samples.ravel()))
        values = pairs.lines(pair, vertices)[2].reshape(samples.shape)
        best = np.arange(chosen.size), values.argmin(axis=1)
        times = np.where(values[best] < clearances, samples[best], times)
        clearances = np.minimum(clearances, values[best])
    return times, clearances


def _pose(pose: Array) -> tuple[float, float, float]:
    x, y, theta = (float(value) for value in pose)
    return x, y, theta
