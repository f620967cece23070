"""Obstacles that move: their poses as functions of time, and the same at the knots of a horizon.

A program knows knots, not times: knot k is at ``t_k = s_k t_f`` with a fixed fraction s_k. So the pose of an obstacle
at a knot is a function of t_f, and the program takes its tangent at a reference final time ``t_ref``::

    o_k(t_f) = poses_k + rates_k s_k (t_f - t_ref)

which is exact at ``t_f = t_ref`` with its first derivative; :func:`tightspot.transcription.solve_moving` moves t_ref to
where t_f settles.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import InputError, Problem
from tightspot.geometry.polygon import ConvexPolygon
from tightspot.geometry.transforms import wrap_angle
from tightspot.transcription.grid import TimeGrid

Array = NDArray[np.float64]

MotionOfTime = Callable[[Array], Array]
"""Poses (x m, y m, theta rad), (m, 3), at times t, s, (m,). The heading may jump by 2 pi."""

LARGEST = 1e12
"""Of poses and rates: what is beyond that is a mistake."""
STEP = 1e-5
"""Of the differences that rates come from, relative to t_f."""


@dataclass(frozen=True, eq=False)
class ObstacleMotion:
    """A convex obstacle part that moves, as a program with given knots takes it.

    Between the knots it follows the cubics that have its poses and rates at both ends.

    Attributes:
        polygon: In the obstacle's own frame.
        poses: (x m, y m, theta rad) of that frame at the knots, (N + 1, 3), at ``final_time``.
        rates: Their derivatives with respect to time, m/s and rad/s, (N + 1, 3).
        final_time: t_ref, s: the t_f for which poses and rates are.
        name: For messages.

    Raises:
        InputError: Not finite, of other shapes, or no positive final time.
    """

    polygon: ConvexPolygon
    poses: Array
    rates: Array
    final_time: float
    name: str = "moving"

    def __post_init__(self) -> None:
        problems = []
        if not isinstance(self.polygon, ConvexPolygon):
            sentence = (
                f"of {self.name} is a {type(self.polygon).__name__}; give a ConvexPolygon, one for each convex part"
            )
            problems.append(Problem("motions.polygon", sentence))
        for key in ("poses", "rates"):
            try:
                table = np.array(getattr(self, key), float)
            except (TypeError, ValueError):
                table = np.zeros(0)
            table.setflags(write=False)
            object.__setattr__(self, key, table)
            if table.ndim != 2 or table.shape[1:] != (3,) or len(table) < 2:
                sentence = f"has shape {table.shape}; give one row (x, y, theta) a knot, (N + 1, 3)"
                problems.append(Problem(f"motions.{key}", sentence))
            elif not (usable := _usable(table)).all():
                knot = int(np.flatnonzero(~usable)[0])
                sentence = f"{table[knot]} of {self.name} at knot {knot} is not finite, or beyond {LARGEST:g}"
                problems.append(Problem(f"motions.{key}", sentence))
        if not problems and self.poses.shape != self.rates.shape:
            sentence = f"has shape {self.rates.shape}, but the poses have {self.poses.shape}; give a rate for each"
            problems.append(Problem("motions.rates", sentence))
        if not (np.isfinite(self.final_time) and self.final_time > 0):
            problems.append(Problem("motions.final_time", f"{self.final_time} s must be positive and finite"))
        if problems:
            raise InputError(problems)


@dataclass(frozen=True, eq=False)
class MovingObstacle:
    """A convex obstacle part and its motion as a function of time, from which :class:`ObstacleMotion` is made.

    Attributes:
        polygon: In the obstacle's own frame.
        motion: Poses of that frame, (m, 3), at times (m,): any function, or :class:`TimedPoses`.
        name: For messages.
    """

    polygon: ConvexPolygon
    motion: MotionOfTime
    name: str = "moving"

    def at(self, t: Array) -> Array:
        """Poses at times t, (len(t), 3).

        Raises:
            InputError: The function gives something else.
        """
        t = np.atleast_1d(np.asarray(t, float))
        answer = self.motion(t)
        try:
            poses = np.asarray(answer, float)
        except (TypeError, ValueError):
            raise InputError(
                Problem("motion", f"of {self.name} gives no table of numbers; it must give (m, 3)")
            ) from None
        if poses.shape != (t.size, 3):
            sentence = f"of {self.name} gives shape {poses.shape} for {t.size} times; it must give ({t.size}, 3)"
            raise InputError(Problem("motion", sentence))
        if not (usable := _usable(poses)).all():
            bad = int(np.flatnonzero(~usable)[0])
            raise InputError(Problem("motion", f"of {self.name} gives {poses[bad]} at {t[bad]:g} s; give finite poses"))
        return poses

    def on(self, grid: TimeGrid, final_time: float) -> ObstacleMotion:
        """The motion at the knots of a horizon of ``final_time`` seconds; rates by differences of second order.

        Raises:
            InputError: The function gives something else than finite poses, or ``final_time`` is not positive.
        """
        if not (np.isfinite(final_time) and final_time > 0):
            raise InputError(Problem("final_time", f"{final_time} s must be positive and finite"))
        t, h = final_time * grid.fractions, STEP * final_time
        here = self.at(t)
        # In the middle of knots on both sides; at t = 0 only ahead, where the function must be defined.
        before = np.where(t < h, t, t - h)
        one, two = self.at(np.where(t < h, t + h, before)), self.at(np.where(t < h, t + 2 * h, t + h))
        ahead, further = _difference(one, here), _difference(two, here)
        first = (t < h)[:, None]
        rates = np.where(first, (4 * ahead - further) / (2 * h), (further - ahead) / (2 * h))
        return ObstacleMotion(self.polygon, here, rates, float(final_time), self.name)


def _usable(table: Array) -> NDArray[np.bool_]:
    """Of each row, whether it is made of numbers of a sensible size."""
    return np.asarray((np.abs(table) <= LARGEST).all(axis=1))


def _difference(there: Array, here: Array) -> Array:
    step = there - here
    step[:, 2] = wrap_angle(step[:, 2])
    return step


def _monotone_rates(t: Array, poses: Array) -> Array:
    h = np.diff(t)[:, None]
    slopes = np.diff(poses, axis=0) / h
    before, after, nearer, farther = slopes[:-1], slopes[1:], 2 * h[1:] + h[:-1], h[1:] + 2 * h[:-1]
    alike = before * after > 0
    mixed = nearer * np.where(alike, after, 1.0) + farther * np.where(alike, before, 1.0)
    inner = np.where(alike, (nearer + farther) * before * after / mixed, 0.0)
    return np.concatenate([slopes[:1], inner, slopes[-1:]])


class TimedPoses:
    """A motion from a table of poses: cubics through them that swing nowhere beyond them, so what stands in the table
    stands. Before the first time and after the last the obstacle stands, too.

    The rate of x, y or heading at a pose is the harmonic mean of those before and after, weighted by nearness, and 0
    where the two differ in sign.

    Reference: F. N. Fritsch, J. Butland, A method for constructing local monotone piecewise cubic interpolants, SIAM
    Journal on Scientific and Statistical Computing 5 (1984).

    >>> TimedPoses([0.0, 2.0], [(0, 0, 0), (4, 0, 0)])(np.array([1.0, 9.0]))[:, 0].tolist()
    [2.0, 4.0]
    """

    def __init__(self, t: Array | list[float], poses: Array | list[tuple[float, float, float]]) -> None:
        """
        Args:
            t: Times, s, increasing, (m,), two or more.
            poses: (x m, y m, theta rad), (m, 3); from one to the next the heading takes the short way.

        Raises:
            InputError: Other shapes, not finite, or times that do not increase.
        """
        t, poses = np.array(t, float), np.array(poses, float)
        if t.ndim != 1 or t.size < 2 or poses.shape != (t.size, 3):
            sentence = f"has shapes {t.shape} and {poses.shape}; give two or more times (m,) and poses (m, 3)"
            raise InputError(Problem("timed_poses", sentence))
        if not (np.isfinite(t).all() and np.isfinite(poses).all()):
            raise InputError(Problem("timed_poses", "has numbers that are not finite"))
        if not (np.diff(t) > 0).all():
            raise InputError(Problem("timed_poses.t", "must increase"))
        poses[:, 2] = np.unwrap(poses[:, 2])
        self.t, self.poses = t, poses
        self._rates = _monotone_rates(t, poses)

    def __call__(self, t: Array) -> Array:
        """Poses at times t, (len(t), 3)."""
        t = np.clip(t, self.t[0], self.t[-1])
        k = np.clip(np.searchsorted(self.t, t, side="right") - 1, 0, self.t.size - 2)
        T = (self.t[k + 1] - self.t[k])[:, None]
        s = (t - self.t[k])[:, None] / T
        step, rest = self.poses[k + 1] - self.poses[k], 1 - s
        bend = s * rest * T * (rest * self._rates[k] - s * self._rates[k + 1])
        return np.asarray(self.poses[k] + s**2 * (3 - 2 * s) * step + bend)
