"""The picture of a scene by itself."""

from __future__ import annotations

import numpy as np
import shapely
from matplotlib.figure import Figure

from tightspot.plotting import style
from tightspot.plotting.bodies import body_shape
from tightspot.plotting.captions import put_legend, put_title
from tightspot.plotting.layout import page
from tightspot.plotting.scene import draw_names, draw_scene
from tightspot.plotting.view import Box, frame_axes
from tightspot.scenarios import Scenario
from tightspot.vehicles import VehicleModel


def figure_scene(scenario: Scenario, vehicle: VehicleModel | None = None) -> Figure:
    """The scene by itself: the whole workspace, named obstacles, and the vehicle at start and goal.

    Args:
        scenario: What is drawn.
        vehicle: Whose outline is drawn; by default the scenario's.
    """
    vehicle = scenario.vehicle_model() if vehicle is None else vehicle
    ends = [body_shape(vehicle, np.nan_to_num(state)) for state in (scenario.start, scenario.goal)]
    box = Box.around(np.vstack([scenario.workspace.vertices, *map(shapely.get_coordinates, ends)]))
    box = box.grown(0.02 * max(box.width, box.height))
    places = page(box.aspect)
    with style.drawing():
        figure = style.new_figure(places.width, places.height)
        axes = figure.add_axes(places.scene.within(places.width, places.height), label="scene")
        draw_scene(axes, scenario, vehicle)
        frame_axes(axes, box, scenario.offset)
        draw_names(axes, scenario)
        facts = f"vehicle {vehicle.name}   ·   clearance wanted {scenario.margin:g} m"
        put_title(figure, places.scene.left, scenario.name, [(facts, style.SOFT_INK, False)], path=False)
        put_legend(figure, sweep=False, path=False)
    return figure
