"""What the body keeps clear of between the rows, too: the cover of :mod:`tightspot.verification.cover` over a table.

The table is judged in stretches, each only against what is near it: what is farther than :data:`NEAR` from the
stretch's bounding box is proved to be so by that.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tightspot.geometry import ConvexPolygon
from tightspot.scenarios import Scenario
from tightspot.vehicles import SingleTrack
from tightspot.verification.barriers import ObstaclePairs, WorkspacePairs
from tightspot.verification.certificate import WORKSPACE, Witness
from tightspot.verification.cover import Cover, cover
from tightspot.verification.motion import Motion
from tightspot.verification.tables.motion import RowMotion, sagitta
from tightspot.verification.witnesses import WORKSPACE_SLACK, obstacle_witnesses, workspace_witnesses

Array = NDArray[np.float64]

NEAR = 2.0
"""Obstacles closer than this, m, beyond the demanded clearance, are looked at."""
STRETCH = 400
"""Rows judged together."""
RESOLUTION = 1e-3
"""The proved clearance is raised to within this of the true one, m, if it is small."""
FLOOR = 1e-5
"""Pieces shorter than this part of the way between two rows are given up."""


class Reading(NamedTuple):
    """One reading of the motion between the rows, judged.

    Attributes:
        clearance: Proved lower bound of the clearance of all obstacles at all times, m; infinite without obstacles.
        inside: Proved lower bound of the depth inside the workspace, m; negative outside.
        nearest: The moment with the smallest clearance that was seen, if any obstacle is near; its time is the row.
        moments: The worst moment of each pair without proof, and of each body part that leaves the workspace.
    """

    clearance: float
    inside: float
    nearest: Witness | None
    moments: tuple[Witness, ...]

    @property
    def obstacles(self) -> tuple[Witness, ...]:
        """The moments that are about obstacles."""
        return tuple(moment for moment in self.moments if moment.obstacle != WORKSPACE)

    @property
    def workspace(self) -> tuple[Witness, ...]:
        """The moments at which the body leaves the workspace."""
        return tuple(moment for moment in self.moments if moment.obstacle == WORKSPACE)


class Clearances(NamedTuple):
    """Both readings and how far they are apart.

    Attributes:
        interpolated: Positions run straight between the rows.
        arcs: Positions run on arcs.
        apart: The largest distance of the two, m.
    """

    interpolated: Reading
    arcs: Reading
    apart: float


def clearances(scenario: Scenario, vehicle: SingleTrack, poses: Array, margin: float) -> Clearances:
    """Judge both readings of the motion through the poses.

    Args:
        scenario: In recentred coordinates.
        vehicle: Whose body moves.
        poses: Without jumps in the heading, recentred, m and rad, shape (M, 3).
        margin: Clearance to prove, m.
    """
    judge = _Judge(scenario, vehicle, margin)
    apart = sagitta(poses)
    pairs = [judge.stretch(poses, first, apart) for first in range(0, len(poses) - 1, STRETCH)]
    straight, arcs = (_joined(readings) for readings in zip(*pairs, strict=True))
    return Clearances(straight, arcs, float(apart.max()))


class _Judge:
    """What does not change from stretch to stretch."""

    def __init__(self, scenario: Scenario, vehicle: SingleTrack, margin: float) -> None:
        self.scenario, self.vehicle, self.margin = scenario, vehicle, margin
        self.names = [name for name, _ in scenario.obstacle_parts]
        self.polygons = [polygon for _, polygon in scenario.obstacle_parts]
        self.boxes = np.array([_box(polygon.vertices) for polygon in self.polygons]).reshape(-1, 2, 2)
        self.radius = max(part.polygon.radius for part in vehicle.parts)

    def stretch(self, poses: Array, first: int, apart: Array) -> tuple[Reading, Reading]:
        """Both readings from row ``first`` on."""
        last = min(first + STRETCH, len(poses) - 1)
        rows, bulge = poses[first : last + 1], float(apart[first:last].max())
        straight = self.reading(rows, first, 0.0)
        if bulge < 1e-12:
            return straight, straight
        free = bulge < RESOLUTION and straight.clearance - bulge >= self.margin and straight.inside - bulge >= 0
        if free:
            return straight, straight._replace(clearance=straight.clearance - bulge, inside=straight.inside - bulge)
        return straight, self.reading(rows, first, bulge)

    def reading(self, rows: Array, first: int, bulge: float) -> Reading:
        """The rows' motion, straight if ``bulge`` is zero, else on arcs that bulge so far (m) at most."""
        box = _box(rows[:, :2])
        reach = self.radius + bulge
        gaps = _gaps(box, self.boxes) - reach
        near = np.flatnonzero(gaps < self.margin + NEAR)
        far = float(np.delete(gaps, near).min(initial=np.inf))
        polygons = [self.polygons[i] for i in near]
        motion = RowMotion.of(self.vehicle, rows, extent=_extent([*polygons, self.scenario.workspace]), arcs=bulge > 0)
        pairs = ObstaclePairs(len(self.vehicle.parts), polygons)
        clear = cover(motion, pairs, self.margin, resolution=RESOLUTION, floor=FLOOR)
        moments = obstacle_witnesses(motion, pairs, clear, self.margin, [self.names[i] for i in near])
        nearest = _nearest(motion, pairs, clear, [self.names[i] for i in near])
        inside, crossings = self._inside(motion, box, reach)
        found = [replace(moment, time=first + moment.time) for moment in (*moments, *crossings)]
        nearest = nearest and replace(nearest, time=first + nearest.time)
        return Reading(min(far, clear.clearance), inside, nearest, tuple(found))

    def _inside(self, motion: Motion, box: Array, reach: float) -> tuple[float, Sequence[Witness]]:
        W = self.scenario.workspace
        corners = np.array([(x, y) for x in box[:, 0] for y in box[:, 1]])
        depth = float((W.b - corners @ W.A.T).min()) - reach
        if depth > NEAR:
            return depth, ()
        walls = WorkspacePairs(len(self.vehicle.parts), W)
        held = cover(motion, walls, -WORKSPACE_SLACK, resolution=RESOLUTION, floor=FLOOR)
        return held.clearance, workspace_witnesses(motion, walls, held)


def _nearest(motion: Motion, pairs: ObstaclePairs, clear: Cover, names: Sequence[str]) -> Witness | None:
    """The smallest clearance that the cover has seen."""
    if not clear.seen.size:
        return None
    pair = int(clear.seen.argmin())
    x, y, theta = motion.at(clear.seen_at[pair : pair + 1])[0].tolist()
    part, obstacle = motion.names[pairs.part[pair]], names[pairs.barrier[pair]]
    return Witness(float(clear.seen_at[pair]), part, obstacle, float(clear.seen[pair]), (x, y, theta), "nearest")


def _joined(readings: Sequence[Reading]) -> Reading:
    """One reading of all stretches: the worst moment of each pair over all of them."""
    worst: dict[tuple[str, str], Witness] = {}
    for moment in (moment for reading in readings for moment in reading.moments):
        key = moment.part, moment.obstacle
        if key not in worst or moment.clearance < worst[key].clearance:
            worst[key] = moment
    moments = sorted(worst.values(), key=lambda moment: moment.clearance)
    nearest = min(_seen(readings), key=lambda moment: moment.clearance, default=None)
    clearance, inside = min(r.clearance for r in readings), min(r.inside for r in readings)
    return Reading(clearance, inside, nearest, tuple(moments))


def _seen(readings: Sequence[Reading]) -> Iterator[Witness]:
    for reading in readings:
        yield from reading.obstacles
        if reading.nearest is not None:
            yield reading.nearest


def _box(points: Array) -> Array:
    """((x_min, y_min), (x_max, y_max))."""
    return np.array([points.min(axis=0), points.max(axis=0)])


def _gaps(box: Array, boxes: Array) -> Array:
    """Distances of boxes (m, 2, 2) from a box, m, shape (m,)."""
    apart = np.maximum(boxes[:, 0] - box[1], box[0] - boxes[:, 1])
    return np.asarray(np.hypot(*np.maximum(apart, 0.0).T))


def _extent(polygons: Sequence[ConvexPolygon]) -> float:
    return max(float(np.abs(polygon.vertices).max()) for polygon in polygons)
