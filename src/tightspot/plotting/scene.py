"""The plan view: ground, obstacles, start and goal, the swept area, the path coloured by gear."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from matplotlib import patheffects
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.markers import MarkerStyle
from matplotlib.path import Path
from matplotlib.transforms import Affine2D
from numpy.typing import ArrayLike, NDArray

from tightspot.plotting import style
from tightspot.plotting.bodies import body_shape, draw_body, shape_patch, shape_path, swept_area
from tightspot.plotting.motion import Leg, drive_legs, spaced, travelled
from tightspot.scenarios import Obstacle, Scenario
from tightspot.trajectory import Trajectory
from tightspot.vehicles import VehicleModel

Array = NDArray[np.float64]

_HALO: list[patheffects.AbstractPathEffect] = [patheffects.withStroke(linewidth=3, foreground="white", alpha=0.9)]
_NAME_SIZE = 8.5
_ARROW = Path([(-0.5, 0.55), (0.7, 0.0), (-0.5, -0.55), (-0.2, 0.0), (-0.5, 0.55)], closed=True)


def obstacle_shape(obstacle: Obstacle) -> Any:
    """The obstacle as given, with its holes: a shapely polygon, or several if it touches itself."""
    return shapely.union_all(obstacle.polygons)


def obstacle_path(obstacle: Obstacle) -> Path:
    """The obstacle as given, for drawing: its holes stay empty when it is filled."""
    if obstacle.is_plain:
        corners = obstacle.parts[0].vertices
        return Path(np.concatenate([corners, corners[:1]]), closed=True)
    return shape_path(obstacle_shape(obstacle))


def draw_scene(axes: Axes, scenario: Scenario, vehicle: VehicleModel | None = None) -> None:
    """The workspace as ground, the obstacles as given, the vehicle at start (dashed) and goal (solid).

    Args:
        axes: Where to draw, in the scenario's recentred coordinates, m. Limits are left alone.
        scenario: What is drawn.
        vehicle: Whose outline stands at start and goal; without one neither is drawn.
    """
    ground = scenario.boundary.polygon if scenario.boundary else scenario.workspace.to_shapely()
    axes.add_patch(shape_patch(ground, facecolor=style.GROUND, edgecolor=style.INK, linewidth=1.1, zorder=1))
    axes.add_collection(
        PathCollection(
            [obstacle_path(obstacle) for obstacle in scenario.obstacles],
            facecolors=style.OBSTACLE,
            edgecolors=style.OBSTACLE_EDGE,
            linewidths=1.0,
            joinstyle="round",
            zorder=2,
            gid="obstacles",
        ),
        autolim=False,
    )
    if vehicle is not None:
        draw_ends(axes, scenario, vehicle)


def draw_ends(axes: Axes, scenario: Scenario, vehicle: VehicleModel, *, mark: bool = True) -> None:
    """The vehicle's outline at the start, dashed, and at the goal, solid."""
    looks: dict[str, dict[str, Any]] = {
        "start": {"linestyle": (0, (4, 2.2)), "linewidth": 1.6, "facecolor": "#ffffff99"},
        "goal": {"linestyle": "-", "linewidth": 2.0, "facecolor": "#ffffffcc"},
    }
    for end, look in looks.items():
        state = np.nan_to_num(getattr(scenario, end))  # a free speed or steering angle turns no part
        draw_body(axes, vehicle, state, mark=mark, edgecolor=style.INK, zorder=5, label=end, **look)


def draw_sweep(
    axes: Axes, vehicle: VehicleModel, states: ArrayLike, *, spacing: float | None = None, shape: Any = None
) -> None:
    """The area that the body sweeps, translucent, with outlines of the body at regular spacing.

    Args:
        axes: Where to draw.
        vehicle: Its parts are swept.
        states: Closely spaced states (M, n_x) or poses (M, 3).
        spacing: Distance between outlines, m; by default a third of the body's length.
        shape: The swept area if the caller has it already, see :func:`tightspot.plotting.swept_area`.
    """
    states = np.asarray(states, dtype=float)
    area = swept_area(vehicle, states) if shape is None else shape
    axes.add_patch(
        shape_patch(
            area,
            facecolor=(style.SWEEP, 0.3),
            edgecolor=(style.SWEEP, 0.9),
            linewidth=0.8,
            zorder=3,
            label="swept area",
        )
    )
    if spacing is None:
        reach = np.concatenate([part.polygon.vertices[:, 0] for part in vehicle.parts])
        spacing = float(np.ptp(reach)) / 3
    outlines = [shape_path(body_shape(vehicle, states[i])) for i in spaced(states, spacing)]
    axes.add_collection(
        PathCollection(outlines, facecolors="none", edgecolors="#1f293330", linewidths=0.7, zorder=3.5),
        autolim=False,
    )


def draw_path(axes: Axes, trajectory: Trajectory, *, arrows: bool = True, crowded: float = 0.4) -> list[Leg]:
    """The path of the rear-axle midpoint, one line a leg, coloured by gear.

    Arrows point where the vehicle moves (backwards in reverse); numbered dots mark the gear changes in order.

    Args:
        axes: Where to draw.
        trajectory: Densely sampled.
        arrows: Whether arrows are drawn.
        crowded: Gear changes nearer to each other than this share a label, m.

    Returns:
        The legs, in the order of the lines added to the axes; each line's gid is ``forward`` or ``reverse``.
    """
    poses = trajectory.poses
    legs = drive_legs(trajectory)
    for leg in legs:
        part = poses[leg.first : leg.last + 1]
        line = axes.plot(*part[:, :2].T, color=style.GEAR[leg.gear], linewidth=2.6, solid_capstyle="round", zorder=7)[0]
        line.set_gid(style.GEAR_NAME[leg.gear])
        line.set_path_effects([patheffects.withStroke(linewidth=4.4, foreground="white", alpha=0.85)])
        if arrows:
            _draw_arrows(axes, part, leg.gear)
    changes = poses[[leg.first for leg in legs[1:]]]
    onward = np.where([leg.gear > 0 for leg in legs[:-1]], 0.0, np.pi) + changes[:, 2]
    for numbers in _crowds(changes[:, :2], crowded):
        at, angle = changes[numbers, :2], onward[numbers]
        direction = np.array([np.cos(angle).sum(), np.sin(angle).sum()])
        _draw_gear_changes(axes, at, [number + 1 for number in numbers], direction)
    return legs


def _crowds(points: Array, distance: float) -> list[list[int]]:
    """Indices of the points in groups: each is within the distance of another of its group or alone."""
    crowds: list[list[int]] = []
    for i, point in enumerate(points):
        near = [crowd for crowd in crowds if np.hypot(*(points[crowd] - point).T).min() < distance]
        crowds = [crowd for crowd in crowds if crowd not in near] + [sorted(sum(near, [i]))]
    return sorted(crowds)


def _draw_gear_changes(axes: Axes, at: Array, numbers: Sequence[int], direction: Array) -> None:
    """A dot with its number, or several dots that share a label beyond them in the direction."""
    alone = len(numbers) == 1
    dots = axes.plot(
        *at.T,
        "o",
        markersize=13 if alone else 5,
        markerfacecolor="white",
        markeredgecolor=style.INK,
        markeredgewidth=1.3,
        zorder=9,
    )
    dots[0].set_gid("gear change")
    shift = np.zeros(2) if alone else 20 * direction / max(float(np.hypot(*direction)), 1e-9)
    axes.annotate(
        ", ".join(str(number) for number in numbers),
        at.mean(axis=0).tolist(),
        xytext=tuple(shift.tolist()),
        textcoords="offset points",
        ha="center",
        va="center_baseline",
        fontsize=8,
        fontweight="bold",
        color=style.INK,
        zorder=9.1,
        bbox=None
        if alone
        else {"boxstyle": "round,pad=0.3", "facecolor": "white", "edgecolor": style.INK, "linewidth": 1.1},
    )


def _draw_arrows(axes: Axes, poses: Array, gear: int) -> None:
    along = travelled(poses)
    count = max(1, round(along[-1] / 3.5))
    if along[-1] < 0.8:
        return
    for k in np.searchsorted(along, along[-1] * (np.arange(count) + 0.5) / count):
        angle = poses[k, 2] + (np.pi if gear < 0 else 0.0)
        marker = MarkerStyle(_ARROW, transform=Affine2D().rotate(float(angle)))
        axes.plot(
            *poses[k, :2],
            marker=marker,
            markersize=12,
            markerfacecolor=style.GEAR[gear],
            markeredgecolor="white",
            markeredgewidth=1.0,
            gid="arrow",
            zorder=8,
        )


def _middle(polygon: Any) -> Any:
    """The centroid if it lies inside, else the centre of the largest circle inside."""
    if polygon.contains(polygon.centroid):
        return polygon.centroid
    return shapely.maximum_inscribed_circle(polygon, tolerance=0.1)


def draw_names(axes: Axes, scenario: Scenario) -> None:
    """The obstacles' names on their visible parts, larger obstacles first, where there is room.

    Args:
        axes: With its final limits and scale, since the room depends on them.
        scenario: Whose obstacles are named.
    """
    (x_min, x_max), (y_min, y_max) = axes.get_xlim(), axes.get_ylim()
    view = shapely.box(x_min, y_min, x_max, y_max)
    metres = (x_max - x_min) / axes.bbox.width * axes.figure.get_dpi() / 72  # a point
    visible = [(shapely.intersection(obstacle_shape(obstacle), view), obstacle.name) for obstacle in scenario.obstacles]
    taken: list[Any] = []
    for shape, name in sorted(visible, key=lambda item: -float(item[0].area)):
        if shape.area == 0:
            continue
        largest = max(shapely.get_parts(shape), key=lambda part: float(part.area))
        x, y = shapely.get_coordinates(_middle(largest))[0]
        half_width, half_height = 0.33 * _NAME_SIZE * len(name) * metres, 0.7 * _NAME_SIZE * metres
        room = shapely.box(x - half_width, y - half_height, x + half_width, y + half_height)
        if not view.covers(room) or any(room.intersects(other) for other in taken):
            continue
        taken.append(room)
        look: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": _NAME_SIZE, "parse_math": False}
        axes.text(x, y, name, zorder=6, path_effects=_HALO, **look)
