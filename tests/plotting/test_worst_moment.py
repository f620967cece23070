"""The picture of the worst moment shows what the verdict says, for tables and plans."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.patches import Polygon

from tightspot.plotting import figure_judged_plan, figure_judged_table, save
from tightspot.scenarios import Obstacle, Scenario
from tightspot.verification import Plan, Table, judge_table


def words(figure):
    """All text in the figure."""
    found = [artist.get_text() for artist in figure.findobj(lambda artist: hasattr(artist, "get_text"))]
    return " | ".join(text for text in found if text)


def fronts(axes):
    """How many triangles mark a body's front."""
    return sum(isinstance(patch, Polygon) and len(patch.get_xy()) == 4 for patch in axes.patches)


def gids(axes):
    return {artist.get_gid() for artist in axes.get_children() if artist.get_gid()}


def axes_of(figure, label):
    return next(axes for axes in figure.axes if axes.get_label() == label)


def table_of(plan: Plan, dy: float = 0.0, names=("t", "x", "y", "theta", "v", "delta")) -> Table:
    times = plan.times(0.1)
    states = plan.sample(times)
    columns = {"t": times, **dict(zip(("x", "y", "theta", "v", "delta"), states.T, strict=True))}
    columns["y"] = columns["y"] + dy
    return Table.from_columns({name: columns[name] for name in names})


def through(plan: Plan) -> Scenario:
    """The plan's scene with an obstacle in the way."""
    wall = Obstacle("wall", [(8.0, 0.5), (9.0, 0.5), (9.0, 3.0), (8.0, 3.0)])
    return plan.scenario.with_(obstacles=(*plan.scenario.obstacles, wall))


def test_a_collision(plan):
    verdict = judge_table(through(plan), plan.vehicle, table_of(plan))
    assert verdict.collision == "collides"
    figure = figure_judged_table(verdict)
    scene, detail = axes_of(figure, "scene"), axes_of(figure, "detail")
    assert {"moment", "overlap"} <= gids(scene) & gids(detail)
    assert fronts(scene) - fronts(detail) == 3, "no triangle hides what is magnified"
    assert verdict.sentence(verdict.witnesses[0]) in words(figure)
    x, y = verdict.witnesses[0].pose[:2]
    assert scene.get_xlim()[0] < x < scene.get_xlim()[1]
    assert scene.get_ylim()[0] < y < scene.get_ylim()[1]
    assert np.diff(detail.get_xlim()) < np.diff(scene.get_xlim()) / 2


def test_the_nearest_approach(plan):
    half = max(part.polygon.vertices[:, 1].max() for part in plan.vehicle.parts)
    beside = Obstacle("beside", [(0.0, half + 0.1), (1.0, half + 0.1), (1.0, half + 1.0), (0.0, half + 1.0)])
    verdict = judge_table(plan.scenario.with_(obstacles=(beside,)), plan.vehicle, table_of(plan))
    assert verdict.upheld, verdict.summary()
    figure = figure_judged_table(verdict)
    assert "gap" in gids(axes_of(figure, "detail"))
    assert "overlap" not in gids(axes_of(figure, "scene"))
    assert "nearest approach" in words(figure)
    curve = axes_of(figure, "clearance")
    values = np.concatenate([line.get_ydata() for line in curve.lines if len(line.get_ydata()) > 100])
    assert values.min() == pytest.approx(verdict.clearances.interpolated.clearance, abs=2e-3)
    assert curve.get_xlabel() == "time (s)"


def test_a_fault_that_is_no_collision(plan):
    table = table_of(plan)
    theta = Table.from_columns({**table.columns, "theta": table.columns["theta"] + 0.1})
    verdict = judge_table(plan.scenario.with_(obstacles=()), plan.vehicle, theta)
    figure = figure_judged_table(verdict)
    assert "side slip" in words(figure)
    assert "direction of motion" in words(figure)
    assert "rows" in gids(axes_of(figure, "detail"))


def test_a_path(plan):
    verdict = judge_table(plan.scenario, plan.vehicle, table_of(plan, names=("x", "y", "theta")))
    figure = figure_judged_table(verdict)
    assert axes_of(figure, "clearance").get_xlabel() == "length driven (m)"


def test_leaving_the_workspace(plan):
    verdict = judge_table(plan.scenario, plan.vehicle, table_of(plan, dy=-4.5))
    assert verdict.clearances.interpolated.workspace
    only = plan.scenario.with_(obstacles=())
    figure = figure_judged_table(judge_table(only, plan.vehicle, table_of(plan, dy=-4.5)))
    assert "leaves the workspace" in words(figure)
    assert axes_of(figure, "clearance").get_ylabel() == "inside W (m)"


def test_nothing_to_touch(plan, tmp_path):
    verdict = judge_table(plan.scenario.with_(obstacles=()), plan.vehicle, table_of(plan))
    figure = figure_judged_table(verdict)
    assert "nothing to touch" in words(figure)
    save(figure, tmp_path / "free.png")
    first = (tmp_path / "free.png").read_bytes()
    save(figure_judged_table(verdict), tmp_path / "free.png")
    assert (tmp_path / "free.png").read_bytes() == first


def test_standing_still(plan):
    """Rows at one place: nothing moves, and nothing breaks."""
    still = Table.from_columns({"x": [0.0, 0.0, 0.0], "y": [0.0, 0.0, 0.0], "theta": [0.0, 0.0, 0.0]})
    figure = figure_judged_table(judge_table(plan.scenario, plan.vehicle, still))
    assert "goal position" in words(figure)


def test_plans(plan, collision):
    good = figure_judged_plan(plan, plan.certificate)
    assert "certified for all times" in words(good)
    bad = figure_judged_plan(collision, collision.certificate)
    assert str(collision.certificate.witness) in words(bad)
    assert "overlap" in gids(axes_of(bad, "detail"))
