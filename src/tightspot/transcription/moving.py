"""Moving obstacles as the arrays that both forms of the program take: poses at every sample, and what must be added to
the clearances of formulations that hold on the interval."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem
from tightspot.geometry.stack import PolygonStack
from tightspot.geometry.transforms import nearest_angle
from tightspot.transcription.grid import TimeGrid
from tightspot.transcription.motions import ObstacleMotion
from tightspot.vehicles.base import VehicleModel

if TYPE_CHECKING:
    from tightspot.transcription.transcribe import Settings

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class MotionArrays:
    """The motions of M moving obstacle parts at the S samples of all intervals: the ends of their pieces.

    Attributes:
        obstacles: Their indices among all obstacle parts, the standing ones first, (M,).
        times: t_ref, s, (M,).
        poses: At t_ref, (M, S, 3).
        slopes: Derivatives of the poses with respect to t_f, (M, S, 3).
        extras: What is added to the demanded clearance, m, (N, parts, obstacle parts); see :func:`bulges`. Empty if
            nothing moves.
    """

    obstacles: NDArray[np.int64]
    times: Array
    poses: Array
    slopes: Array
    extras: Array

    @classmethod
    def of(
        cls, motions: Sequence[ObstacleMotion], standing: int, vehicle: VehicleModel, settings: Settings, grid: TimeGrid
    ) -> MotionArrays:
        """The arrays beside ``standing`` obstacle parts that do not move.

        Raises:
            InputError: A motion has another number of knots than the grid.
        """
        if not motions:
            return _NOTHING
        pieces, whole = settings.samples(grid.steps)
        tables = [sampled(motion, grid, pieces) for motion in motions]
        samples = int(pieces.sum()) + grid.steps
        extras = np.zeros((grid.steps, len(vehicle.parts), standing + len(motions)))
        for index, motion in enumerate(motions):
            extra = bulges(vehicle, motion, settings.margin, grid, pieces)
            extras[:, :, standing + index] = np.where(whole[:, None], extra, 0.0)
        return cls(
            np.arange(standing, standing + len(motions), dtype=np.int64),
            np.array([motion.final_time for motion in motions], float),
            np.array([table.poses for table in tables]).reshape(-1, samples, 3),
            np.array([table.slopes for table in tables]).reshape(-1, samples, 3),
            extras,
        )

    def frames(self, final_time: float) -> Array:
        """Poses at all samples, (M, S, 3)."""
        return np.ascontiguousarray(self.poses + (final_time - self.times)[:, None, None] * self.slopes)

    def numbers(self) -> list[Array]:
        """The parameters of a symbolic program: of each motion poses, slopes, t_ref and extras, column by column."""
        flat: list[Array] = []
        for index, obstacle in enumerate(self.obstacles):
            flat += [self.poses[index].ravel("F"), self.slopes[index].ravel("F"), self.times[index : index + 1]]
            flat.append(self.extras[:, :, obstacle].ravel("F"))
        return flat


_NOTHING = MotionArrays(
    np.zeros(0, np.int64), np.zeros(0), np.zeros((0, 0, 3)), np.zeros((0, 0, 3)), np.zeros((0, 0, 0))
)


def with_moving(standing: PolygonStack, motions: Sequence[ObstacleMotion]) -> PolygonStack:
    """All obstacle parts, those that move last."""
    return PolygonStack([*standing, *(motion.polygon for motion in motions)]) if motions else standing


def sampled(motion: ObstacleMotion, grid: TimeGrid, pieces: NDArray[np.int64]) -> SampledMotion:
    """The motion at the ends of each interval's pieces.

    Raises:
        InputError: The grid has another number of knots.
    """
    if len(motion.poses) != grid.steps + 1:
        sentence = f"{motion.name} has {len(motion.poses)} rows, but the grid has {grid.steps + 1} knots"
        raise InputError(Problem("motions.poses", sentence))
    duration = grid.widths * motion.final_time
    ends, rates = motion.poses.copy(), motion.rates
    for k, seconds in enumerate(duration):  # whole turns that the rates tell of, not those of the angles' writing
        expected = ends[k, 2] + seconds * (rates[k, 2] + rates[k + 1, 2]) / 2
        ends[k + 1, 2] = nearest_angle(ends[k + 1, 2], expected)
    interval = np.repeat(np.arange(grid.steps), pieces + 1)
    share = np.concatenate([np.linspace(0.0, 1.0, count + 1) for count in pieces])[:, None]
    T, before, after = duration[interval, None], ends[:-1][interval], ends[1:][interval]
    first, last = rates[:-1][interval], rates[1:][interval]
    rest = 1 - share
    poses = before + share**2 * (3 - 2 * share) * (after - before) + share * rest * T * (rest * first - share * last)
    velocity = 6 * share * rest * (after - before) / T
    velocity += rest * (1 - 3 * share) * first + share * (3 * share - 2) * last
    fraction = grid.fractions[:-1][interval] + share[:, 0] * grid.widths[interval]
    begins = 6 * (ends[1:] - ends[:-1]) / duration[:, None] ** 2
    at_start = begins - (4 * rates[:-1] + 2 * rates[1:]) / duration[:, None]
    at_end = (2 * rates[:-1] + 4 * rates[1:]) / duration[:, None] - begins
    return SampledMotion(poses, fraction[:, None] * velocity, _most(rates, at_start, at_end, duration))


class Fastest(NamedTuple):
    """Bounds of a motion on each interval, (N,): m/s, rad/s, m/s^2, rad/s^2."""

    speed: Array
    turn: Array
    acceleration: Array
    turn_acceleration: Array


class SampledMotion(NamedTuple):
    """A motion at samples: poses (S, 3) at t_ref, their derivatives with respect to t_f (S, 3), and its bounds."""

    poses: Array
    slopes: Array
    fastest: Fastest


def bulges(
    vehicle: VehicleModel, motion: ObstacleMotion, margin: float, grid: TimeGrid, pieces: NDArray[np.int64]
) -> Array:
    """How much further a body point can leave its chord between samples, seen from the obstacle, m, (N, parts).

    With the obstacle's speed, turning rate and accelerations v, w, a, alpha, and V the body point's largest speed, the
    point's acceleration in the obstacle's frame exceeds that in the world by at most::

        a + 2 w (V + v) + (w^2 + |alpha|) D

    at a distance D from the frame's origin. Only a part that comes nearer than the margin need be kept off; then all
    its points are within the obstacle's radius, the margin and its own diameter, and stay so but for what V + v makes
    of it during the piece. Times h^2 / 8 for a piece of h seconds, at t_ref.
    """
    fastest = sampled(motion, grid, pieces).fastest
    h = grid.widths * motion.final_time / pieces
    result = np.empty((grid.steps, len(vehicle.parts)))
    for index, part in enumerate(vehicle.parts):
        bounds, radius = vehicle.fastest()[part.frame], part.polygon.radius
        relative = float(bounds.speed[0] + bounds.yaw_rate[0] * radius) + fastest.speed
        distance = motion.polygon.radius + margin + 2 * radius + relative * h
        turning = (fastest.turn**2 + fastest.turn_acceleration) * distance
        result[:, index] = (fastest.acceleration + 2 * fastest.turn * relative + turning) * h**2 / 8
    return result


def _most(rates: Array, at_start: Array, at_end: Array, duration: Array) -> Fastest:
    """A rate, from the nearer end, changes for half the interval at most; accelerations are largest at the ends."""

    def largest(first: Array, last: Array, columns: slice) -> Array:
        return np.asarray(np.maximum(*(np.linalg.norm(table[:, columns], axis=1) for table in (first, last))))

    (acceleration, turn_acceleration), (speed, turn) = (
        [largest(*ends, columns) for columns in (slice(0, 2), slice(2, 3))]
        for ends in ((at_start, at_end), (rates[:-1], rates[1:]))
    )
    half = duration / 2
    return Fastest(speed + half * acceleration, turn + half * turn_acceleration, acceleration, turn_acceleration)
