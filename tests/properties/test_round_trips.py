"""Any scene, in any format that can hold it: what is read again is the same bit for bit."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from tightspot.errors import InputError, SceneError
from tightspot.scenarios import Scenario, builtin, load, save

ENDINGS = [".yaml", ".json", ".geojson", ".wkt", ".xml"]
small = st.floats(-50, 50)
angles = st.floats(-4 * np.pi, 4 * np.pi)
offsets = st.sampled_from([(0.0, 0.0), (0.1, -0.3), (12345.6, 1e5 + 0.1), (4.484e9 + 0.3, -3.54e8), (-1e10, 1e-3)])
texts = st.text(max_size=12)
names = st.one_of(
    st.none(),
    st.text(min_size=1, max_size=12).filter(str.isprintable),
    st.sampled_from(["a;b", '"', "#", "=", "start"]),
)
cars = st.sampled_from(["paper", "tpcap", builtin("forklift-pallet").vehicle_model().to_dict()])


@st.composite
def states(draw, offset):
    speed, steering = st.one_of(st.none(), st.floats(-5, 5)), st.one_of(st.none(), st.floats(-1, 1))
    return {
        "x": draw(small) + offset[0],
        "y": draw(small) + offset[1],
        "theta": draw(angles),
        "v": draw(speed),
        "delta": draw(steering),
    }


@st.composite
def rings(draw, offset):
    """Star-shaped about a centre: simple, mostly not convex; open or closed, in either direction."""
    centre = np.array([draw(small), draw(small)]) + offset
    turns = sorted(draw(st.lists(st.floats(0, 6.2), min_size=3, max_size=9, unique=True)))
    radii = draw(st.lists(st.floats(0.2, 5), min_size=len(turns), max_size=len(turns)))
    ring = (centre + np.array([(r * np.cos(t), r * np.sin(t)) for r, t in zip(radii, turns, strict=True)])).tolist()
    return ring[:: draw(st.sampled_from([1, -1]))]


@st.composite
def scenes(draw):
    offset = np.array(draw(offsets))
    x, y = (np.sort(np.array([draw(small), draw(small)])) + o for o in offset)
    assume(np.diff(x) > 0.1 and np.diff(y) > 0.1)
    notch = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1])], [x[0], y[1]]]
    workspaces = [None, {"x": x.tolist(), "y": y.tolist()}, [[float(a), float(b)] for a, b in notch]]
    obstacles = draw(st.lists(rings(offset), max_size=4))
    return {
        "name": draw(names),
        "description": draw(texts),
        "source": draw(texts),
        "vehicle": draw(cars),
        "margin": draw(st.floats(0, 10)),
        "tolerance": {"position": draw(st.floats(1e-6, 10)), "heading": draw(st.floats(1e-6, 3))},
        "workspace": draw(st.sampled_from(workspaces)),
        "obstacles": [{"name": draw(names), "vertices": ring} for ring in obstacles],
        "start": draw(states(offset)),
        "goal": draw(states(offset)),
    }


def made(data):
    try:
        return Scenario.from_dict(data)
    except SceneError:
        assume(False)


@settings(max_examples=60)
@given(scenes(), st.sampled_from(ENDINGS))
def test_what_is_written_is_what_is_read(tmp_path_factory, data, ending):
    scenario = made(data)
    path = tmp_path_factory.getbasetemp() / f"round{ending}"
    if ending == ".xml":  # control characters have no place in XML
        assume((scenario.description + scenario.source).isprintable())
    assert save(scenario, path) == []
    again = load(path)
    assert again.to_dict() == scenario.to_dict()
    given_rings = [obstacle["vertices"] for obstacle in data["obstacles"]]
    assert [obstacle["vertices"] for obstacle in again.to_dict()["obstacles"]] == given_rings
    for (name, part), (name_2, part_2) in zip(scenario.obstacle_parts, again.obstacle_parts, strict=True):
        assert name == name_2
        np.testing.assert_array_equal(part.vertices, part_2.vertices)


@settings(max_examples=40)
@given(scenes())
def test_a_competition_file_keeps_poses_and_polygons_or_is_refused(tmp_path_factory, data):
    scenario = made(data)
    path = tmp_path_factory.getbasetemp() / "round.csv"
    try:
        save(scenario, path, lossy=True)
        again = load(path)
    except InputError:
        return
    assert [o.exterior.tolist() for o in again.obstacles] == [o.exterior.tolist() for o in scenario.obstacles]
    for end in ("start", "goal"):
        ours, theirs = getattr(scenario, end), getattr(again, end)
        assert (ours[:2] + scenario.offset).tolist() == (theirs[:2] + again.offset).tolist()
        assert np.cos(ours[2] - theirs[2]) == pytest.approx(1, abs=1e-12)
