"""Whatever is put into a scene file: a scenario, or a SceneError that can be printed. Never anything else."""

from __future__ import annotations

import contextlib
import copy
import json
from collections.abc import Callable
from datetime import date
from typing import Any

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from tightspot.errors import SceneError
from tightspot.geometry import clearance as signed_distance
from tightspot.safe_yaml import UnreadableError, load_json, load_yaml
from tightspot.scenarios import Scenario, check, clearance, load

KEYS = [
    "x",
    "y",
    "theta",
    "v",
    "delta",
    "start",
    "goal",
    "obstacles",
    "vertices",
    "holes",
    "name",
    "workspace",
]
numbers = st.one_of(
    st.floats(),
    st.integers(),
    st.integers(-20, 20),
    st.floats(-20, 20),
    st.sampled_from([10**400, 1e308, 1e-320, 4.5e9, -0.0, True]),
)
scalars = st.one_of(st.none(), numbers, st.text(max_size=5), st.binary(max_size=3), st.dates())
junk = st.recursive(
    scalars,
    lambda inner: st.one_of(
        st.lists(inner, max_size=4),
        st.tuples(inner, inner),
        st.dictionaries(st.one_of(st.sampled_from(KEYS), scalars), inner, max_size=4),
    ),
    max_leaves=12,
)
points = st.lists(st.tuples(numbers, numbers).map(list), max_size=8)
SCENE: dict[str, Any] = {
    "workspace": {"x": [-30, 30], "y": [-30, 30]},
    "obstacles": [{"name": "L", "vertices": [[10, 5], [14, 5], [14, 6], [11, 6], [11, 9], [10, 9]], "holes": []}],
    "start": {"x": 0, "y": 0, "theta": 0, "v": 0, "delta": 0},
    "goal": {"x": 8, "y": -3, "theta": 0.5, "v": None, "delta": None},
    "tolerance": {"position": 0.01, "heading": 0.02},
    "margin": 0.05,
    "vehicle": {
        "name": "cart",
        "wheelbase": 1.0,
        "body": {"length": 1.5, "width": 0.8, "rear_overhang": 0.2},
        "limits": {"speed": [-1, 1], "acceleration": [-1, 1], "steering": 0.6, "steering_rate": 0.5},
    },
}


def _places(data: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    children = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    return [path, *(place for key, value in children for place in _places(value, (*path, key)))]


PLACES = _places(SCENE)[1:]


def outcome(call: Callable[[], Scenario]) -> Scenario | SceneError:
    try:
        return call()
    except SceneError as error:
        return error


def is_scene_or_refusal(data: Any) -> None:
    result = outcome(lambda: Scenario.from_dict(data))
    if isinstance(result, SceneError):
        is_refusal(result)
    else:
        again = Scenario.from_dict(json.loads(json.dumps(result.to_dict(), allow_nan=False)))
        assert again.to_dict() == result.to_dict()


def is_refusal(error: SceneError) -> None:
    assert error.problems
    for problem in error.problems:
        assert problem.message
        assert len(str(problem)) < 500
        str(problem).encode()


@given(junk)
def test_junk_is_refused_with_a_sentence(data):
    is_scene_or_refusal(data)


@settings(max_examples=150)
@given(st.sampled_from(PLACES), st.one_of(junk, points))
def test_junk_anywhere_in_a_good_scene_is_refused_or_read(place, value):
    data = copy.deepcopy(SCENE)
    target: Any = data
    for key in place[:-1]:
        target = target[key]
    target[place[-1]] = value
    is_scene_or_refusal(data)


@settings(max_examples=100)
@given(points, st.lists(points, max_size=2))
def test_any_list_of_points_is_an_obstacle_or_refused(ring, holes):
    is_scene_or_refusal({**SCENE, "obstacles": [{"vertices": ring, "holes": holes}]})


@given(
    st.one_of(
        st.text(),
        st.text(alphabet="[]{}:,-&*!?|>'\"%@ \nab1"),
        st.binary().map(lambda b: b.decode("latin-1")),
    )
)
def test_any_text_is_data_or_refused(text):
    for parse in (load_yaml, load_json):
        with contextlib.suppress(UnreadableError):
            data = parse(text)
            assert data is None or isinstance(data, str | int | float | list | dict | set | date | bytes)


@given(
    st.lists(st.one_of(numbers, st.sampled_from([0, 1, 2, 3, 4])), max_size=30),
    st.sampled_from([",", "\n", ";"]),
)
def test_any_numbers_in_a_csv_are_a_scene_or_refused(tmp_path_factory, values, separator):
    path = tmp_path_factory.getbasetemp() / "numbers.csv"
    path.write_text(separator.join(map(repr, values)))
    result = outcome(lambda: load(path))
    if isinstance(result, SceneError):
        is_refusal(result)
    else:
        assert len(result.obstacles) == values[6]


@given(
    st.floats(-25, 25),
    st.floats(-25, 25),
    st.floats(-10, 10),
    st.floats(0, 0.5),
    st.floats(-3, 3),
    st.floats(-3, 3),
)
def test_what_the_check_lets_pass_keeps_the_margin(x, y, theta, margin, v, delta):
    scenario = Scenario.from_dict({**SCENE, "start": {"x": x, "y": y, "theta": theta}})
    if abs(delta) < 1.5:
        scenario = scenario.with_(start=[x, y, theta, v, delta])
    model = scenario.vehicle_model()
    body = model.parts[0].polygon.transformed(x, y, theta)
    gap = min(float(signed_distance(body.vertices, part.vertices)) for _, part in scenario.obstacle_parts)
    excess = float((body.vertices @ scenario.workspace.A.T - scenario.workspace.b).max())
    within = abs(scenario.start[3]) <= 1 and abs(scenario.start[4]) <= 0.6
    assert np.isclose(clearance(scenario, model, scenario.start).value, gap)
    try:
        check(scenario, model, margin)
    except SceneError:
        assert gap < margin or excess > 0 or not within
    else:
        assert gap >= margin - 1e-9
        assert excess <= 1e-9
        assert within
