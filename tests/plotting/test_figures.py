"""Whole pictures."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

from tightspot.plotting import figure_failure, figure_plan, figure_scene, save
from tightspot.plotting.bodies import body_shape
from tightspot.plotting.captions import floor_mm, shortened, verdict
from tightspot.plotting.failure_figure import detail_window
from tightspot.plotting.layout import HEIGHT, WIDTH, arrange, page
from tightspot.plotting.profiles import CERTIFIED_GID, MARGIN_GID
from tightspot.verification import Plan, Witness, verify

from .conftest import BOX, RING, make_plan


def panel(figure: Figure, label: str):
    return next(axes for axes in figure.axes if axes.get_label() == label)


def words(figure: Figure) -> str:
    """All text of the title lines."""
    texts = [text.get_text() for text in figure.texts]
    for artist in figure.artists:
        texts += [area.get_text() for area in artist.get_child().get_children()]
    return " ".join(texts)


def test_plan_figure_has_every_panel_at_the_promised_size(plan: Plan) -> None:
    figure = figure_plan(plan)
    assert {axes.get_label() for axes in figure.axes} == {"scene", "v", "delta", "a", "omega", "clearance"}
    assert tuple(figure.get_size_inches() * figure.dpi) == (1400, 900)
    assert panel(figure, "scene").get_aspect() == 1.0
    lines = {line.get_gid() for line in panel(figure, "clearance").lines}
    assert {MARGIN_GID, CERTIFIED_GID} <= lines


def test_plan_figure_says_what_is_certified(plan: Plan) -> None:
    text = words(figure_plan(plan))
    assert plan.scenario.name in text
    assert f"certified for all times: clearance ≥ {floor_mm(plan.certificate.clearance)} m" in text
    assert "18.0 s" in text
    assert "2 gear changes" in text


def test_plan_figure_does_not_hide_a_failed_judgement(collision: Plan) -> None:
    figure = figure_plan(collision)
    text = words(figure)
    assert "not certified" in text
    assert "wall/0" in text
    assert "for all times" not in text
    assert CERTIFIED_GID not in {line.get_gid() for line in panel(figure, "clearance").lines}


@pytest.mark.parametrize(
    ("car", "workspace"),
    [
        ("tpcap", (-3, 17, -5, 8)),
        ("tpcap", (-3, 17, -6, 9.2)),
        ("tpcap", (-10, 50, -3, 5)),
        ("forklift", (-5, 12, -40, 30)),
        ("forklift", (-4000, 4000, -4000, 4000)),
    ],
)
def test_nothing_stands_outside_the_picture(car: str, workspace: tuple[float, float, float, float]) -> None:
    made = make_plan(car=car, workspace=workspace, obstacles=(BOX,))
    assert made.certificate.certified
    figure = figure_plan(made)
    figure.canvas.draw()
    renderer = figure.canvas.get_renderer()
    for axes in figure.axes:
        tight = axes.get_tightbbox(renderer)
        assert tight.x0 >= 0
        assert tight.y0 >= 0
        assert tight.x1 <= 1400
        assert tight.y1 <= 900


@pytest.mark.parametrize("aspect", [0.05, 0.3, 0.9, 1.0, 1.3, 1.5, 1.75, 2.4, 3.1, 3.3, 6.0, 30.0])
def test_layout_keeps_every_part_large_and_apart(aspect: float) -> None:
    layout = arrange(aspect)
    assert layout.scene.width / layout.scene.height == pytest.approx(aspect)
    places = [layout.scene, layout.clearance, *layout.profiles]
    for place in places:
        assert place.left >= 0.5
        assert place.bottom >= 0.4
        assert place.left + place.width <= WIDTH
        assert place.bottom + place.height <= HEIGHT - 0.9
    for curve in places[1:]:
        assert curve.width >= 2.0
        assert curve.height >= 0.9
    for i, a in enumerate(places):
        for b in places[:i]:
            beside = a.left + a.width < b.left or b.left + b.width < a.left
            below = a.bottom + a.height < b.bottom or b.bottom + b.height < a.bottom
            assert beside or below


@pytest.mark.parametrize("aspect", [0.1, 0.5, 1.0, 2.0, 8.0])
@pytest.mark.parametrize("detail", [False, True])
def test_pages_fit_their_contents(aspect: float, detail: bool) -> None:
    layout = page(aspect, detail=detail, curve=detail)
    assert layout.scene.width / layout.scene.height == pytest.approx(aspect)
    assert layout.width <= WIDTH + 1e-9
    assert layout.height <= HEIGHT + 1e-9
    if layout.detail is not None and layout.curve is not None:
        assert layout.detail.left > layout.scene.left + layout.scene.width
        assert layout.detail.width == layout.detail.height >= 3.0
        assert layout.curve.bottom + layout.curve.height < min(layout.scene.bottom, layout.detail.bottom)


def test_scene_figure_shows_the_whole_workspace(plan: Plan) -> None:
    axes = panel(figure_scene(plan.scenario), "scene")
    (x_min, x_max), (y_min, y_max) = axes.get_xlim(), axes.get_ylim()
    assert x_min < -3 < 17 < x_max
    assert y_min < -5 < 8 < y_max
    assert {"start", "goal"} <= {patch.get_label() for patch in axes.patches}
    assert {"box", "ring"} == {text.get_text() for text in axes.texts}


def test_failure_figure_magnifies_the_overlap(collision: Plan) -> None:
    witness = collision.certificate.witness
    figure = figure_failure(collision.scenario, collision.vehicle, collision.trajectory, witness)
    detail = panel(figure, "detail")
    overlap = next(patch for patch in detail.patches if patch.get_gid() == "overlap")
    (x_min, x_max), (y_min, y_max) = detail.get_xlim(), detail.get_ylim()
    corners = overlap.get_path().vertices
    assert x_min < corners[:, 0].min() < corners[:, 0].max() < x_max
    assert y_min < corners[:, 1].min() < corners[:, 1].max() < y_max
    assert overlap.get_hatch()
    title = detail.get_title(loc="left")
    assert f"t = {witness.time:.2f} s" in title
    assert "body / wall/0" in title
    assert f"{witness.penetration:.3f} m deep" in title
    moment = panel(figure, "clearance").lines[-1]
    assert moment.get_xydata().tolist() == [[witness.time, witness.clearance]]


def test_failure_figure_of_a_missed_margin_joins_the_nearest_points(plan: Plan) -> None:
    certificate = verify(plan.scenario, plan.vehicle, plan.trajectory, margin=3.0)
    witness = certificate.witness
    figure = figure_failure(plan.scenario, plan.vehicle, plan.trajectory, witness)
    detail = panel(figure, "detail")
    assert not [patch for patch in detail.patches if patch.get_gid() == "overlap"]
    (start, end) = detail.lines[0].get_xydata()
    assert np.hypot(*(start - end)) == pytest.approx(witness.clearance, abs=1e-4)
    assert "apart" in detail.get_title(loc="left")


def test_failure_figure_of_a_left_workspace() -> None:
    narrow = make_plan(workspace=(-3.0, 17.0, -3.0, 1.2), obstacles=())
    witness = narrow.certificate.witness
    assert isinstance(witness, Witness)
    figure = figure_failure(narrow.scenario, narrow.vehicle, narrow.trajectory, witness)
    assert panel(figure, "clearance").get_ylabel() == "inside W (m)"
    window = detail_window(narrow.scenario, body_shape(narrow.vehicle, witness.pose))
    assert window.y_min < 1.2 < window.y_max


def test_failure_figure_shows_how_far_the_search_came(plan: Plan) -> None:
    reached = np.random.default_rng(1).uniform(-2, 4, (40, 3))
    figure = figure_failure(plan.scenario, plan.vehicle, reached=reached, reason="No path was found.")
    (points,) = [line for line in panel(figure, "scene").lines if line.get_gid() == "reached"]
    assert np.array_equal(points.get_xydata(), reached[:, :2])
    assert "No path was found." in words(figure)
    assert len(figure.axes) == 1


def test_odd_names_are_written_as_they_are(tmp_path) -> None:
    odd = make_plan(name="$\\frac{ <b> 车 " * 9)
    for figure in (figure_plan(odd), figure_scene(odd.scenario)):
        title = figure.texts[0].get_text()
        assert title.startswith("$\\frac{ <b>")
        assert title.endswith("…")
        save(figure, tmp_path / "odd.png")


def test_no_obstacles_and_one_obstacle_around() -> None:
    free = figure_plan(make_plan(obstacles=()))
    assert "nothing to touch" in words(free)
    assert panel(figure_plan(make_plan(obstacles=(RING,))), "clearance").lines


@pytest.mark.parametrize(
    ("length", "shown"), [(0.0279, "0.027"), (0.03, "0.030"), (0.10999999999, "0.109"), (0.0, "0.000")]
)
def test_bounds_are_rounded_down(length: float, shown: str) -> None:
    assert floor_mm(length) == shown


def test_shortened_keeps_one_line() -> None:
    assert shortened("a\n b   c", 20) == "a b c"
    assert shortened("abcdef", 4) == "abc…"


def test_a_plan_without_certificate_is_not_judged() -> None:
    assert verdict(None)[0] == "not judged"
