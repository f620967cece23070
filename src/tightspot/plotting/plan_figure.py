"""The main picture: the manoeuvre, its states and inputs against their limits, its clearance over time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from tightspot.plotting import style
from tightspot.plotting.bodies import swept_area
from tightspot.plotting.captions import gear_changes, put_legend, put_title, verdict
from tightspot.plotting.layout import HEIGHT, WIDTH, Layout, arrange
from tightspot.plotting.motion import Leg, dense_motion, sampling_step, travelled
from tightspot.plotting.profiles import draw_clearance, draw_profile, mark_gear_changes
from tightspot.plotting.scene import draw_ends, draw_path, draw_scene, draw_sweep
from tightspot.plotting.view import frame_axes, view_box
from tightspot.trajectory import Trajectory
from tightspot.vehicles import VehicleModel
from tightspot.verification import Certificate, Plan, minimum_clearance

Array = NDArray[np.float64]

_SYMBOLS = {"v": "v", "delta": "δ", "a": "a", "omega": "ω"}
_UNITS = {"rad": ("°", 180 / np.pi), "rad/s": ("°/s", 180 / np.pi), "m/s^2": ("m/s²", 1.0)}


class Curve(NamedTuple):
    """One state or input to be drawn, in the unit of its label."""

    name: str
    label: str
    values: Array
    limits: tuple[float, float]


def figure_plan(plan: Plan) -> Figure:
    """The plan in one picture of 1400 x 900 pixels.

    The scene with the swept area, start, goal and the path by gear; states and inputs against their limits;
    the clearance over time with what was demanded and what is certified; above, the verdict in words.

    Args:
        plan: Its trajectory's inputs are replayed, so the picture shows what the vehicle does.
    """
    motion = dense_motion(plan.vehicle, plan.trajectory)
    area = swept_area(plan.vehicle, motion.states)
    box = view_box(plan.scenario, shapely.get_coordinates(area))
    layout = arrange(box.aspect)
    with style.drawing():
        figure = style.new_figure(WIDTH, HEIGHT)
        axes = figure.add_axes(layout.scene.within(WIDTH, HEIGHT), label="scene")
        draw_scene(axes, plan.scenario)
        draw_sweep(axes, plan.vehicle, motion.states, shape=area)
        draw_ends(axes, plan.scenario, plan.vehicle)
        legs = draw_path(axes, motion, crowded=0.25 * box.width / layout.scene.width)
        frame_axes(axes, box, plan.scenario.offset)
        _draw_curves(figure, layout, plan.vehicle, motion, legs)
        _draw_clearance(figure, layout, plan, motion, legs)
        facts = f"{plan.trajectory.duration:.1f} s   ·   {gear_changes(len(legs) - 1)}   ·   "
        facts += f"{travelled(motion.poses)[-1]:.1f} m driven   ·   vehicle {plan.vehicle.name}"
        words = [verdict(plan.certificate), (f"  ·   {facts}", style.SOFT_INK, False)]
        put_title(figure, layout.scene.left, plan.scenario.name, words)
        put_legend(figure)
    return figure


def curves(vehicle: VehicleModel, motion: Trajectory) -> list[Curve]:
    """The bounded states and the inputs, angles in degrees."""
    found = []
    kinds = [
        (vehicle.state_names, vehicle.state_units, vehicle.state_bounds),
        (vehicle.input_names, vehicle.input_units, vehicle.input_bounds),
    ]
    for names, units, (lows, highs) in kinds:
        for name, unit, low, high in zip(names, units, lows.tolist(), highs.tolist(), strict=True):
            if math.isfinite(low) or math.isfinite(high):
                shown, factor = _UNITS.get(unit, (unit, 1.0))
                label = f"{_SYMBOLS.get(name, name)} ({shown})"
                found.append(Curve(name, label, motion.column(name) * factor, (low * factor, high * factor)))
    return found


def proved_bound(certificate: Certificate) -> tuple[Array, Array] | None:
    """The proof's own lower bound of the clearance over time: the smallest over all pairs, step by step.

    Returns:
        Times (K+1,), s, and the bound between them (K,), m; ``None`` without obstacles.
    """
    proofs = [proof for proof in certificate.pairs if proof.clearance.size]
    if not proofs:
        return None
    edges = np.unique(np.concatenate([proof.t for proof in proofs]))
    middles = (edges[:-1] + edges[1:]) / 2
    bounds = [p.clearance[np.clip(np.searchsorted(p.t, middles) - 1, 0, p.clearance.size - 1)] for p in proofs]
    return edges, np.min(bounds, axis=0)


def _draw_curves(
    figure: Figure, layout: Layout, vehicle: VehicleModel, motion: Trajectory, legs: Sequence[Leg]
) -> None:
    drawn: list[Axes] = []
    for curve, rect in zip(curves(vehicle, motion), layout.profiles, strict=False):
        axes = figure.add_axes(rect.within(WIDTH, HEIGHT), label=curve.name)
        own_legs = legs if curve.name == "v" else None
        draw_profile(axes, motion.t, curve.values, curve.limits, label=curve.label, legs=own_legs)
        mark_gear_changes(axes, motion.t, legs, numbers=len(drawn) < layout.columns)
        _finish_time_axis(axes, labelled=rect.bottom <= layout.clearance.bottom)
        drawn.append(axes)
    for column in range(layout.columns):
        figure.align_ylabels(drawn[column :: layout.columns])


def _draw_clearance(figure: Figure, layout: Layout, plan: Plan, motion: Trajectory, legs: Sequence[Leg]) -> None:
    certificate = plan.certificate
    axes = figure.add_axes(layout.clearance.within(WIDTH, HEIGHT), label="clearance")
    series = minimum_clearance(plan.scenario, plan.vehicle, plan.trajectory, sampling_step(plan.trajectory))
    certified = certificate.clearance if certificate.certified else None
    draw_clearance(
        axes,
        series.t,
        series.clearance,
        margin=certificate.margin,
        certified=certified,
        proved=proved_bound(certificate) if certificate.certified else None,
    )
    mark_gear_changes(axes, motion.t, legs)
    _finish_time_axis(axes, labelled=True)


def _finish_time_axis(axes: Axes, *, labelled: bool) -> None:
    if labelled:
        axes.set_xlabel("time (s)")
    else:
        axes.tick_params(labelbottom=False)
