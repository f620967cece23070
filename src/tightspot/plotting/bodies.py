"""The vehicle's body as drawable shapes: placed parts, their union, the area they sweep."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from numpy.typing import ArrayLike, NDArray

from tightspot.geometry import transform
from tightspot.plotting import style
from tightspot.vehicles import SingleTrack, VehicleModel

Array = NDArray[np.float64]


def placed_parts(vehicle: VehicleModel, states: ArrayLike) -> list[Array]:
    """Vertices of every body part at many states.

    Args:
        vehicle: Whose parts and frames are used.
        states: Shape (M, n_x) in the model's order; for vehicles with one frame poses (M, 3) are enough.

    Returns:
        One array (M, n, 2) a part, m.
    """
    states = np.atleast_2d(np.asarray(states, dtype=float))
    frames = [
        np.stack([np.broadcast_to(entry, len(states)) for entry in frame], axis=-1)
        for frame in vehicle.frames(list(states.T), np)
    ]
    return [transform(part.polygon.vertices, frames[part.frame]) for part in vehicle.parts]


def body_shape(vehicle: VehicleModel, state: ArrayLike) -> Any:
    """The union of the parts at one state or pose, a shapely geometry."""
    return shapely.union_all([shapely.Polygon(V[0]) for V in placed_parts(vehicle, state)])


def swept_area(vehicle: VehicleModel, states: ArrayLike) -> Any:
    """The area that the body covers along the states, a shapely geometry.

    The union, over parts and pairs of consecutive states, of the convex hull of the part at both: it contains
    the body at every given state, and in between what a body moving straight would cover.

    Args:
        vehicle: Its parts are swept.
        states: Shape (M, n_x) or poses (M, 3), closely spaced.
    """
    states = np.atleast_2d(np.asarray(states, dtype=float))
    if len(states) == 1:
        return body_shape(vehicle, states)
    hulls = [
        shapely.convex_hull(shapely.multipoints(np.concatenate([V[:-1], V[1:]], axis=1)))
        for V in placed_parts(vehicle, states)
    ]
    return shapely.union_all(np.concatenate(hulls))


def shape_path(shape: Any) -> Path:
    """A shapely polygon or collection of polygons as one path whose holes stay empty when it is filled."""
    rings = []
    for polygon in shapely.get_parts(shapely.orient_polygons(shape)):
        if polygon.geom_type == "Polygon" and not polygon.is_empty:
            rings += [
                Path(shapely.get_coordinates(ring), closed=True) for ring in (polygon.exterior, *polygon.interiors)
            ]
    return Path.make_compound_path(*rings) if rings else Path(np.zeros((0, 2)))


def shape_patch(shape: Any, **look: Any) -> PathPatch:
    """:func:`shape_path` as a patch."""
    return PathPatch(shape_path(shape), **look)


def heading_mark(vehicle: VehicleModel, state: ArrayLike) -> Array:
    """A triangle that points forward, near the front of the largest part, shape (3, 2)."""
    largest = max(vehicle.parts, key=lambda part: part.polygon.area)
    low, high = largest.polygon.vertices.min(axis=0), largest.polygon.vertices.max(axis=0)
    width, centre = high[1] - low[1], (low[1] + high[1]) / 2
    tip, back = high[0] - 0.12 * width, high[0] - 0.56 * width
    corners = np.array([[tip, centre], [back, centre + 0.17 * width], [back, centre - 0.17 * width]])
    frame = np.array([float(entry) for entry in vehicle.frames(list(np.ravel(state)), np)[largest.frame]])
    return transform(corners, frame)


def wheels(vehicle: VehicleModel, state: ArrayLike) -> list[Array]:
    """Outlines (4, 2) of the wheels, the front ones steered; none for vehicles that are no single track."""
    if not isinstance(vehicle, SingleTrack):
        return []
    x, y, theta, _, delta = np.ravel(state)
    largest = max(vehicle.parts, key=lambda part: part.polygon.area).polygon.vertices
    width = float(np.ptp(largest[:, 1]))
    length, thickness, half_track = 0.24 * vehicle.wheelbase, 0.11 * width, 0.38 * width
    wheel = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * np.array([length, thickness]) / 2
    outlines = []
    for along, angle in ((0.0, 0.0), (vehicle.wheelbase, float(delta))):
        for side in (half_track, -half_track):
            in_body = transform(wheel, np.array([along, side, angle]))
            outlines.append(transform(in_body, np.array([x, y, theta])))
    return outlines


def draw_body(
    axes: Axes,
    vehicle: VehicleModel,
    state: ArrayLike,
    *,
    mark: bool = True,
    mark_color: str = style.SOFT_INK,
    **look: Any,
) -> PathPatch:
    """The body's outline at one state or pose, with a triangle at its front.

    Args:
        axes: Where to draw.
        vehicle: Whose body.
        state: Shape (n_x,) or a pose (3,).
        mark: Whether the triangle is drawn.
        mark_color: The triangle's colour.
        **look: matplotlib patch properties of the outline.

    Returns:
        The outline's patch.
    """
    patch = shape_patch(body_shape(vehicle, state), **look)
    axes.add_patch(patch)
    if mark:
        axes.fill(*heading_mark(vehicle, state).T, color=mark_color, linewidth=0, zorder=patch.get_zorder() + 0.1)
    return patch
