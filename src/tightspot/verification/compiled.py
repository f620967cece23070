"""The compiled judge: replay, cover and worst moments for the vehicle models that it knows, in ``tightspot._core``.

It does what :mod:`~tightspot.verification.replay`, :mod:`~tightspot.verification.cover` and
:mod:`~tightspot.verification.witnesses` do in NumPy, by the same steps, and finds the same up to rounding; they remain
for vehicle models of one's own. The code is at ``cpp/include/tightspot/judge``. It writes the models down anew, so that
the judge has no dynamics in common with the stagewise solver.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from tightspot.geometry import ConvexPolygon, PolygonStack
from tightspot.trajectory import Trajectory
from tightspot.vehicles import SingleTrack, VehicleModel

if TYPE_CHECKING:
    from tightspot._core import CoverAnswer, JudgeObstacles, JudgeSingleTrackBody, JudgeSingleTrackMotion, JudgeWalls

    Motion = JudgeSingleTrackMotion
    Body = JudgeSingleTrackBody
    Barriers = JudgeObstacles | JudgeWalls

Array = NDArray[np.float64]


@cache
def core() -> Any:
    """The compiled module, loaded when it is first needed; ``None`` if it was not built: NumPy does, more slowly."""
    try:
        from tightspot import _core
    except ImportError:
        return None
    return _core


def is_there() -> bool:
    """Whether the core was built."""
    return core() is not None


def is_compiled(vehicle: VehicleModel) -> bool:
    """Whether the core knows the model. Of a subclass it does not: its methods may mean something else."""
    return type(vehicle) is SingleTrack and is_there()


def integrated(vehicle: SingleTrack, trajectory: Trajectory, **accuracy: float) -> Motion | None:
    """The motion of the trajectory's inputs; ``None`` if it leaves the finite numbers or needs too many steps.

    Args:
        vehicle: One that :func:`is_compiled`.
        trajectory: Its times, its first state and its inputs are used.
        accuracy: What ``JudgeAccuracy`` has.
    """
    parameters = np.array([vehicle.wheelbase])
    motion = core().JudgeSingleTrackMotion(trajectory.t, trajectory.states[0], trajectory.inputs, parameters)
    return motion if motion.integrate(_filled(core().JudgeAccuracy(), accuracy)) else None


def body_on(motion: Motion, vehicle: SingleTrack, radii: Array, pads: Array, reserve: float) -> Body:
    """The body parts on the motion.

    Args:
        motion: Of the vehicle.
        vehicle: Whose parts they are; one that :func:`is_compiled`.
        radii: Largest distance of each part's vertices from its frame's origin, m.
        pads: What each part's clearances lose to integration error and rounding, m.
        reserve: For rounding in the bounds of the motion, relative.
    """
    stack = vehicle.part_stack
    parts = stack.vertices, stack.first, _frames(stack)
    result: Body = core().JudgeSingleTrackBody(motion, *parts, radii, pads, reserve)
    return result


_known: WeakKeyDictionary[PolygonStack, JudgeObstacles] = WeakKeyDictionary()


def obstacles(polygons: Sequence[ConvexPolygon]) -> JudgeObstacles:
    """Convex obstacle parts as barriers; of a stack they are made once."""
    stack = PolygonStack.of(polygons)
    result: JudgeObstacles | None = _known.get(stack)
    if result is None:
        result = _known[stack] = core().JudgeObstacles(stack.vertices, stack.first)
    return result


_enclosing: WeakKeyDictionary[ConvexPolygon, JudgeWalls] = WeakKeyDictionary()


def walls(workspace: ConvexPolygon) -> JudgeWalls:
    """The edges of the workspace as barriers; of a workspace they are made once."""
    result: JudgeWalls | None = _enclosing.get(workspace)
    if result is None:
        result = _enclosing[workspace] = core().JudgeWalls(-workspace.A, -workspace.b)
    return result


def covered(body: Body, barriers: Barriers, **task: float) -> CoverAnswer:
    """The fields of a :class:`~tightspot.verification.cover.Cover` of all pairs; ``task``: what ``JudgeTask`` has."""
    result: CoverAnswer = core().judge_cover(body, barriers, _filled(core().JudgeTask(), task))
    return result


def worst_moments(
    body: Body, barriers: Barriers, pairs: NDArray[np.intp], times: Array, clearances: Array
) -> tuple[Array, Array]:
    """Times and clearances of the pairs' worst moments near the given ones."""
    result: tuple[Array, Array] = core().judge_worst_moments(body, barriers, pairs.astype(np.int64), times, clearances)
    return result


def clearances(part: ConvexPolygon, poses: Array, barriers: JudgeObstacles, far: float) -> Array:
    """See :func:`tightspot.verification.sampled.sampled_clearance`: of one part at the poses (M, 3), all in a row."""
    result: Array = core().sampled_clearances(part.vertices, np.ascontiguousarray(poses, float), barriers, far)
    return result


def depths(part: ConvexPolygon, poses: Array, barriers: JudgeWalls) -> Array:
    """See :func:`tightspot.verification.sampled.sampled_room`: of one part at the poses (M, 3), all in a row."""
    result: Array = core().sampled_depths(part.vertices, np.ascontiguousarray(poses, float), barriers)
    return result


def nearness(
    parts: PolygonStack, poses: Array, per_interval: int, barriers: JudgeObstacles, edges: JudgeWalls, far: float
) -> tuple[NDArray[np.int64], Array, Array, Array]:
    """See :func:`tightspot.verification.sampled.nearness`: of parts at the poses (parts, M, 3), each in a row."""
    result: tuple[NDArray[np.int64], Array, Array, Array] = core().sampled_nearness(
        parts.vertices, parts.first, poses, per_interval, barriers, edges, far
    )
    return result


def nearness_along(
    motion: Motion, vehicle: SingleTrack, barriers: JudgeObstacles, edges: JudgeWalls, far: float
) -> tuple[NDArray[np.int64], Array, Array, Array]:
    """:func:`nearness` of the vehicle's parts on its motion, at the nodes of its integration."""
    stack = vehicle.part_stack
    result: tuple[NDArray[np.int64], Array, Array, Array] = motion.nearness(
        stack.vertices, stack.first, _frames(stack), barriers, edges, far
    )
    return result


def _frames(parts: PolygonStack) -> NDArray[np.int64]:
    """Of the single-track model's parts: it has one frame."""
    return np.zeros(len(parts), np.int64)


def _filled(options: Any, values: dict[str, float]) -> Any:
    for name, value in values.items():
        setattr(options, name, value)
    return options
