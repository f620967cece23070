"""Curves against their limits, clearance against its bounds."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tightspot.plotting import draw_clearance, draw_profile
from tightspot.plotting.motion import dense_motion
from tightspot.plotting.plan_figure import curves, proved_bound
from tightspot.plotting.profiles import CERTIFIED_GID, LIMIT_GID, MARGIN_GID
from tightspot.verification import Plan, minimum_clearance


def levels(axes: Axes, gid: str) -> list[float]:
    """Heights of the horizontal lines with that gid."""
    return sorted(float(line.get_ydata()[0]) for line in axes.lines if line.get_gid() == gid)


def test_limits_are_drawn_at_the_vehicles_bounds(plan: Plan, blank: Callable[[], Figure]) -> None:
    motion = dense_motion(plan.vehicle, plan.trajectory)
    found = {curve.name: curve for curve in curves(plan.vehicle, motion)}
    limits = plan.vehicle.limits
    expected = {
        "v": limits.speed,
        "delta": (-np.degrees(limits.steering), np.degrees(limits.steering)),
        "a": limits.acceleration,
        "omega": (-np.degrees(limits.steering_rate), np.degrees(limits.steering_rate)),
    }
    assert list(found) == list(expected)
    for name, curve in found.items():
        axes = blank().axes[0]
        draw_profile(axes, motion.t, curve.values, curve.limits, label=curve.label)
        assert levels(axes, LIMIT_GID) == pytest.approx(sorted(expected[name]))
        low, high = axes.get_ylim()
        assert low < expected[name][0]
        assert high > expected[name][1]


def test_angles_are_in_degrees_and_say_so(plan: Plan) -> None:
    found = {curve.name: curve for curve in curves(plan.vehicle, plan.trajectory)}
    assert found["delta"].values == pytest.approx(np.degrees(plan.trajectory.column("delta")))
    assert found["delta"].label == "δ (°)"
    assert found["v"].label == "v (m/s)"


def test_inputs_are_steps_and_states_are_lines(plan: Plan, blank: Callable[[], Figure]) -> None:
    t = plan.trajectory.t
    axes = blank().axes[0]
    draw_profile(axes, t, plan.trajectory.column("a"), (-1, 1), label="a")
    (steps,) = axes.patches
    assert np.array_equal(steps.get_data().values, plan.trajectory.column("a"))
    assert np.array_equal(steps.get_data().edges, t)
    axes = blank().axes[0]
    draw_profile(axes, t, plan.trajectory.column("v"), (-np.inf, 2.0), label="v")
    assert np.array_equal(axes.lines[0].get_ydata(), plan.trajectory.column("v"))
    assert levels(axes, LIMIT_GID) == [2.0]


def test_values_beyond_a_limit_stay_visible(blank: Callable[[], Figure]) -> None:
    axes = blank().axes[0]
    draw_profile(axes, [0, 1, 2], [0.0, 5.0, 0.0], (-1.0, 1.0), label="v")
    assert axes.get_ylim()[1] > 5.0


def test_clearance_shows_margin_and_certified_bound(plan: Plan, blank: Callable[[], Figure]) -> None:
    series = minimum_clearance(plan.scenario, plan.vehicle, plan.trajectory, 0.05)
    axes = blank().axes[0]
    draw_clearance(
        axes, series.t, series.clearance, margin=plan.certificate.margin, certified=plan.certificate.clearance
    )
    assert levels(axes, MARGIN_GID) == [plan.certificate.margin]
    assert levels(axes, CERTIFIED_GID) == [plan.certificate.clearance]
    low, high = axes.get_ylim()
    assert low <= 0 < plan.certificate.clearance <= series.minimum < high
    texts = [text.get_text() for text in axes.get_legend().get_texts()]
    assert texts == [
        "demanded 0.050 m",
        f"certified {np.floor(plan.certificate.clearance * 1000) / 1000:.3f} m",
    ]


@pytest.mark.parametrize("depth", [1e-3, 0.06, 2.0])
def test_penetration_is_in_the_picture(depth: float, blank: Callable[[], Figure]) -> None:
    t = np.linspace(0, 10, 101)
    axes = blank().axes[0]
    draw_clearance(axes, t, np.abs(t - 5) - depth, margin=None)
    assert axes.get_ylim()[0] < -depth
    assert axes.get_ylim()[1] > 0.4
    assert axes.get_legend() is None


def test_a_clearance_that_is_always_large_is_in_the_picture(blank: Callable[[], Figure]) -> None:
    axes = blank().axes[0]
    draw_clearance(axes, [0, 1, 2], [7.0, 6.0, 9.0], margin=0.05)
    assert axes.get_ylim()[1] > 6.0


def test_no_obstacles_is_said(blank: Callable[[], Figure]) -> None:
    axes = blank().axes[0]
    draw_clearance(axes, [0, 1], [np.inf, np.inf], margin=0.05, certified=np.inf)
    assert [text.get_text() for text in axes.texts] == ["no obstacles"]
    assert np.isfinite(axes.get_ylim()).all()
    assert levels(axes, CERTIFIED_GID) == []


def test_proved_bound_lies_between_the_certificate_and_the_truth(plan: Plan) -> None:
    edges, bound = proved_bound(plan.certificate)
    assert edges[0] == 0
    assert edges[-1] == pytest.approx(plan.trajectory.duration)
    assert bound.min() == pytest.approx(plan.certificate.clearance)
    series = minimum_clearance(plan.scenario, plan.vehicle, plan.trajectory, 0.01)
    piece = np.clip(np.searchsorted(edges, series.t, side="right") - 1, 0, bound.size - 1)
    assert (bound[piece] <= series.clearance + 1e-9).all()
