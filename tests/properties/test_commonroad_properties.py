"""Any scene survives CommonRoad bit for bit; reference points convert there and back."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tightspot.scenarios import Scenario
from tightspot.scenarios.readers.commonroad import (
    decimal,
    read_commonroad,
    to_rear_axle,
    to_reference,
    write_commonroad,
)
from tightspot.scenarios.readers.commonroad.shapes import circle_around
from tightspot.vehicles import CATALOGUE

coordinates = st.floats(-50, 50)
angles = st.floats(-12, 12)
text = st.text(max_size=20)


@st.composite
def rings(draw: Any) -> list[list[float]]:
    """A star-shaped polygon: simple, rarely convex."""
    count = draw(st.integers(3, 9))
    x, y = draw(coordinates), draw(coordinates)
    radii = draw(st.lists(st.floats(0.5, 8), min_size=count, max_size=count))
    turns = 2 * math.pi * np.arange(count) / count + draw(st.floats(0, 1))
    return [[x + r * math.cos(a), y + r * math.sin(a)] for r, a in zip(radii, turns, strict=True)]


@st.composite
def scenes(draw: Any) -> Scenario:
    state = st.fixed_dictionaries(
        {
            "x": coordinates,
            "y": coordinates,
            "theta": angles,
            "v": st.none() | st.floats(-2, 2),
            "delta": st.none() | st.floats(-0.5, 0.5),
        }
    )
    data = {
        "name": draw(st.text(st.characters(categories=["L", "N", "P", "S"]), min_size=1, max_size=20)),
        "description": draw(text),
        "source": draw(text),
        "vehicle": draw(st.sampled_from(sorted(CATALOGUE))),
        "margin": draw(st.floats(0, 1)),
        "obstacles": [{"vertices": ring} for ring in draw(st.lists(rings(), max_size=4))],
        "start": draw(state),
        "goal": draw(state),
        "tolerance": {
            "position": draw(st.floats(1e-3, 10)),
            "heading": draw(st.floats(1e-3, math.pi)),
            "speed": draw(st.floats(1e-3, 10)),
            "steering": draw(st.floats(1e-3, 1.5)),
        },
    }
    return Scenario.from_dict(data)


@given(scene=scenes(), reference=st.sampled_from(["centre", "rear-axle"]))
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_scene_comes_back_bit_for_bit(scene: Scenario, reference: Any, tmp_path: Path) -> None:
    path = tmp_path / "x.xml"
    write_commonroad(scene, path, reference=reference)
    assert read_commonroad(path).to_dict() == scene.to_dict()


@given(
    pose=st.tuples(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6), angles),
    offset=st.tuples(st.floats(-5, 5), st.floats(-5, 5)),
)
def test_reference_points_convert_there_and_back(pose: Any, offset: Any) -> None:
    poses, arm = np.array(pose), np.array(offset)
    there = to_reference(poses, arm)
    assert np.hypot(*(there - poses[:2])) == pytest.approx(np.hypot(*arm), abs=1e-9)
    assert to_rear_axle(there, poses[2], arm) == pytest.approx(poses[:2], abs=1e-9)


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_decimals_are_exact_and_have_no_exponent(value: float) -> None:
    text = decimal(value)
    assert float(text) == value
    assert "e" not in text.lower()


@given(radius=st.floats(1e-3, 500), x=coordinates, y=coordinates)
def test_circles_are_covered(radius: float, x: float, y: float) -> None:
    around = shapely.Polygon(circle_around(np.array([x, y]), radius))
    assert around.exterior.distance(shapely.Point(x, y)) >= radius
