"""The picture of a failure: the worst moment of the last iterate, or how far the search came."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from numpy.typing import ArrayLike, NDArray

from tightspot.plotting import style
from tightspot.plotting.bodies import body_shape, draw_body, shape_patch, swept_area
from tightspot.plotting.captions import put_legend, put_title, shortened
from tightspot.plotting.layout import page
from tightspot.plotting.motion import dense_motion, sampling_step
from tightspot.plotting.profiles import draw_clearance
from tightspot.plotting.scene import draw_names, draw_path, draw_scene
from tightspot.plotting.view import Box, frame_axes, view_box
from tightspot.scenarios import Scenario
from tightspot.trajectory import Trajectory
from tightspot.vehicles import VehicleModel
from tightspot.verification import Witness, minimum_clearance
from tightspot.verification.certificate import WORKSPACE

if TYPE_CHECKING:
    from tightspot.planner import Contact

Array = NDArray[np.float64]

_HANDLE = 1.7  # inches, of a further entry of the legend
_MARKED: dict[str, Any] = {"facecolor": "none", "edgecolor": style.BAD, "linewidth": 1.8, "linestyle": (0, (2, 1))}
_KNOTS = (Line2D([], [], color=style.REACHED, marker=".", label="last iterate, at its knots"),)


def figure_failure(
    scenario: Scenario,
    vehicle: VehicleModel,
    trajectory: Trajectory | None = None,
    witness: Witness | None = None,
    reached: ArrayLike | None = None,
    *,
    reason: str = "",
    contacts: Sequence[Contact] = (),
    replayed: bool = True,
    marked: ArrayLike | None = None,
) -> Figure:
    """Why there is no plan: the worst moment in red and magnified, or the region that the search reached.

    Args:
        scenario: Where it was tried.
        vehicle: With what.
        trajectory: The last iterate; its path and its clearance over time are drawn.
        witness: The worst moment: the body stands at its pose, what overlaps is hatched.
        reached: Positions (n, 2) or poses (n, 3) that the search came to.
        reason: One sentence for the caption; by default the witness's.
        contacts: All collisions of the trajectory; the body is drawn where each is deepest.
        replayed: Whether what the inputs do is drawn. If not, the states at the knots as they are: an iterate need not
            satisfy the dynamics.
        marked: Pose (3,) at which a constraint is violated that is none of clearance.
    """
    ends = [body_shape(vehicle, np.nan_to_num(state)) for state in (scenario.start, scenario.goal)]
    motion = trajectory if trajectory is None or not replayed else dense_motion(vehicle, trajectory)
    moving = [] if motion is None else [swept_area(vehicle, motion.states)]
    box = view_box(scenario, np.vstack([shapely.get_coordinates(shape) for shape in (*ends, *moving)]))
    places = page(
        box.aspect,
        detail=witness is not None,
        curve=witness is not None and motion is not None and replayed,
        narrowest=8.0 if motion is None else 11.0,
    )
    with style.drawing():
        figure = style.new_figure(places.width, places.height)
        axes = figure.add_axes(places.scene.within(places.width, places.height), label="scene")
        draw_scene(axes, scenario, vehicle)
        frame_axes(axes, box, scenario.offset)
        draw_names(axes, scenario)
        if reached is not None:
            _draw_reached(axes, np.asarray(reached, dtype=float))
        if motion is not None:
            if replayed:
                draw_path(axes, motion, crowded=0.25 * box.width / places.scene.width)
            else:
                _draw_knots(axes, vehicle, motion)
        if marked is not None:
            draw_body(axes, vehicle, marked, mark_color=style.BAD, zorder=8, gid="marked", **_MARKED)
        for contact in contacts:
            _draw_contact(axes, scenario, vehicle, contact)
        if witness is not None:
            draw_moment(axes, scenario, vehicle, witness)
        if witness is not None and places.detail is not None:
            detail = figure.add_axes(places.detail.within(places.width, places.height), label="detail")
            window = _draw_detail(detail, scenario, vehicle, witness)
            frame_window(axes, window)
        if witness is not None and trajectory is not None and places.curve is not None:
            curve = figure.add_axes(places.curve.within(places.width, places.height), label="clearance")
            _draw_curve(curve, scenario, vehicle, trajectory, witness)
        sentence = reason or (f"✗ {witness}" if witness is not None else "✗ no plan was found")
        words = [(shortened(sentence, round(9.5 * places.width)), style.BAD, True)]
        path = motion is not None and replayed
        more = [*_handles(witness, reached), *([] if replayed else _KNOTS)]
        if marked is not None:
            more.append(Patch(label="worst constraint", **_MARKED))
        put_title(figure, places.scene.left, scenario.name, words, path=path, more=_HANDLE * len(more))
        put_legend(figure, sweep=False, path=path, more=more)
    return figure


def _draw_knots(axes: Axes, vehicle: VehicleModel, iterate: Trajectory) -> None:
    """The iterate's knots, joined by straight lines, with the body at each."""
    for state in iterate.states:
        look: dict[str, Any] = {"facecolor": "none", "edgecolor": (style.INK, 0.25), "linewidth": 0.8}
        draw_body(axes, vehicle, state, mark=False, zorder=3.5, **look)
    axes.plot(*iterate.poses[:, :2].T, ".-", color=style.REACHED, linewidth=1.6, markersize=5, zorder=7, gid="iterate")


def _draw_contact(axes: Axes, scenario: Scenario, vehicle: VehicleModel, contact: Contact) -> None:
    """The body where it penetrates deepest, with the overlap."""
    body = body_shape(vehicle, contact.pose)
    axes.add_patch(shape_patch(body, facecolor="none", edgecolor=style.BAD, linewidth=1, zorder=7.5, gid="contact"))
    overlap = forbidden_part(scenario, body)
    if overlap.area > 0:
        axes.add_patch(shape_patch(overlap, facecolor=(style.BAD, 0.6), edgecolor=style.BAD, linewidth=0.8, zorder=8.5))


def draw_moment(axes: Axes, scenario: Scenario, vehicle: VehicleModel, witness: Witness) -> None:
    """The body at the witness's pose in red; what overlaps is hatched, else the nearest points are joined."""
    body = body_shape(vehicle, witness.pose)
    axes.add_patch(shape_patch(body, facecolor=(style.BAD, 0.16), edgecolor=style.BAD, linewidth=2, zorder=8))
    overlap = forbidden_part(scenario, body)
    if overlap.area > 0:
        look: dict[str, Any] = {"facecolor": (style.BAD, 0.35), "edgecolor": style.BAD, "hatch": "////"}
        axes.add_patch(shape_patch(overlap, linewidth=0.8, zorder=8.5, gid="overlap", **look))
    elif scenario.solids and witness.obstacle != WORKSPACE:
        ends = shapely.get_coordinates(shapely.shortest_line(body, all_obstacles(scenario)))
        axes.plot(*ends.T, color=style.BAD, linewidth=1.4, zorder=8.5)


def forbidden_part(scenario: Scenario, body: Any) -> Any:
    """The part of the body that lies in obstacles or outside the workspace, a shapely geometry."""
    outside = shapely.difference(body, shapely.Polygon(scenario.workspace.vertices))
    return shapely.union(shapely.intersection(body, all_obstacles(scenario)), outside)


def detail_window(scenario: Scenario, body: Any) -> Box:
    """A square around the overlap or, if there is none, the body's nearest points, at least 1 m wide."""
    place = forbidden_part(scenario, body)
    if place.area == 0 and scenario.solids:
        place = shapely.shortest_line(body, all_obstacles(scenario))
    bounds = Box.around(shapely.get_coordinates(body if place.is_empty else place))
    half = max(0.5, 0.9 * max(bounds.width, bounds.height))
    x, y = (bounds.x_min + bounds.x_max) / 2, (bounds.y_min + bounds.y_max) / 2
    return Box(x - half, x + half, y - half, y + half)


def all_obstacles(scenario: Scenario) -> Any:
    """The union of the solids: obstacles, and what a nonconvex boundary excludes; a shapely geometry."""
    return shapely.union_all([part.to_shapely() for _, part in scenario.obstacle_parts])


def _draw_reached(axes: Axes, at: Array) -> None:
    look: dict[str, Any] = {
        "alpha": 0.4,
        "markersize": 4,
        "markeredgewidth": 0,
        "zorder": 3,
        "gid": "reached",
    }
    axes.plot(at[:, 0], at[:, 1], ".", color=style.REACHED, **look)


def _draw_detail(axes: Axes, scenario: Scenario, vehicle: VehicleModel, witness: Witness) -> Box:
    """The place of the overlap or of the nearest points, magnified."""
    window = detail_window(scenario, body_shape(vehicle, witness.pose))
    draw_scene(axes, scenario)
    draw_moment(axes, scenario, vehicle, witness)
    frame_axes(axes, window, scenario.offset)
    axes.set(xlabel="", ylabel="")
    depth = f"{-witness.clearance:.3f} m deep" if witness.clearance < 0 else f"{witness.clearance:.3f} m apart"
    text = f"t = {witness.time:.2f} s: {shortened(f'{witness.part} / {witness.obstacle}', 26)}, {depth}"
    look: dict[str, Any] = {"fontsize": 10, "fontweight": "bold", "color": style.BAD, "parse_math": False}
    axes.set_title(shortened(text, 60), loc="left", **look)
    return window


def frame_window(axes: Axes, window: Box) -> None:
    """Where in the scene the magnified square lies."""
    corner = (window.x_min, window.y_min)
    look: dict[str, Any] = {"fill": False, "edgecolor": style.INK, "linewidth": 1, "zorder": 9}
    axes.add_patch(Rectangle(corner, window.width, window.height, **look))


def _draw_curve(
    axes: Axes, scenario: Scenario, vehicle: VehicleModel, trajectory: Trajectory, witness: Witness
) -> None:
    """Clearance of obstacles over time, or of the workspace's boundary if that was crossed."""
    series = minimum_clearance(scenario, vehicle, trajectory, sampling_step(trajectory))
    values = series.workspace if witness.obstacle == WORKSPACE else series.clearance
    draw_clearance(axes, series.t, values, margin=None)
    axes.plot([witness.time], [witness.clearance], "o", color=style.BAD, markersize=6, zorder=7)
    axes.set_xlabel("time (s)")
    if witness.obstacle == WORKSPACE:
        axes.set_ylabel("inside W (m)")


def _handles(witness: Witness | None, reached: ArrayLike | None) -> Sequence[Line2D | Patch]:
    handles: list[Line2D | Patch] = []
    if witness is not None:
        handles.append(Patch(facecolor=(style.BAD, 0.2), edgecolor=style.BAD, label="worst moment"))
    if reached is not None:
        handles.append(Line2D([], [], linestyle="", marker=".", color=style.REACHED, label="reached by the search"))
    return handles
