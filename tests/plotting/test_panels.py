"""Scenes side by side."""

from __future__ import annotations

import numpy as np

from tightspot.plotting import Panel, figure_panels
from tightspot.scenarios.library import builtin
from tightspot.trajectory import Trajectory
from tightspot.vehicles import vehicle

CAR = vehicle("paper")


def straight(scene, bend=0.0):
    """From the scene's start to its goal, not drivable."""
    states = np.linspace(scene.start, scene.goal, 6)
    states[1:-1, 1] += bend
    return Trajectory(np.linspace(0.0, 10.0, 6), states, np.zeros((5, 2)))


def test_equal_names_look_equal_in_all_panels_and_are_explained_once():
    scenes = [builtin(name) for name in ("vertical", "parallel")]
    panels = [
        Panel(scenes[0], CAR, "one", {"simplified": straight(scenes[0]), "hybrid-astar": straight(scenes[0], 1.0)}),
        Panel(scenes[1], CAR, "two", {"hybrid-astar": straight(scenes[1])}),
    ]
    figure = figure_panels(panels)
    assert [axes.get_title() for axes in figure.axes] == ["one", "two"]
    lines = [{line.get_label(): line for line in axes.lines} for axes in figure.axes]
    one, two = lines[0]["hybrid-astar"], lines[1]["hybrid-astar"]
    assert (one.get_color(), one.get_linestyle()) == (two.get_color(), two.get_linestyle())
    assert one.get_color() != lines[0]["simplified"].get_color()
    np.testing.assert_allclose(one.get_xydata(), straight(scenes[0], 1.0).poses[:, :2])
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["simplified", "hybrid-astar"]


def test_a_solution_is_drawn_as_it_is_driven():
    scene = builtin("vertical")
    t = np.array([0.0, 4.0, 8.0])
    motion = Trajectory(
        t, np.array([[0, 0, 0, 0, 0], [4, 0, 0, 2, 0], [8, 0, 0, 0, 0]]), np.array([[0.5, 0], [-0.5, 0]])
    )
    figure = figure_panels([Panel(scene, CAR, "driven", solution=motion)])
    (axes,) = figure.axes
    forward = [line for line in axes.lines if line.get_gid() == "forward"]
    assert len(forward) == 1
    x = np.asarray(forward[0].get_xdata(), dtype=float)
    assert x.size > 50, "not only the knots"
    np.testing.assert_allclose(x[[0, -1]], [0.0, 8.0], atol=1e-6)
    assert not figure.legends
