"""Any honest table is upheld; any text is a table or a TableError; the verdict does not depend on how it is written."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import shapely
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from tests.verification.tables.honest import drive, scene, sideways, text

from tightspot.errors import InputError, TableError
from tightspot.geometry import transform
from tightspot.scenarios import Obstacle
from tightspot.vehicles import Limits, vehicle
from tightspot.verification import Table, judge_table
from tightspot.verification.tables import parse_table
from tightspot.verification.tables.text import decoded

CAR = vehicle("tpcap")
OPTIONAL = ("t", "v", "sigma", "a", "omega")
SECONDS = 3.0


@st.composite
def cars(draw):
    limits = Limits(
        speed=(-draw(st.floats(0.3, 3)), draw(st.floats(0.3, 3))),
        acceleration=(-draw(st.floats(0.2, 3)), draw(st.floats(0.2, 3))),
        steering=draw(st.floats(0.2, 1.2)),
        steering_rate=draw(st.floats(0.05, 2)),
    )
    return replace(CAR, wheelbase=draw(st.floats(0.8, 4)), limits=limits)


@st.composite
def writings(draw):
    """Keyword arguments for writing a table down."""
    columns = ["x", "y", "theta", *(name for name in OPTIONAL if draw(st.booleans()))]
    if "sigma" not in columns:  # omega alone may be a yaw rate
        columns = [name for name in columns if name != "omega"]
    return {
        "columns": tuple(draw(st.permutations(columns))),
        "decimals": draw(st.sampled_from([None, 3, 4, 5, 6])),
        "dt": draw(st.sampled_from([0.01, 0.02, 0.05, 0.1, 0.25])),
        "separator": draw(st.sampled_from([",", "\t", ";"])),
    }


@settings(max_examples=60)
@given(cars(), st.integers(0, 10**6), st.sampled_from([0.25, 0.5, 1.0]), writings(), st.floats(-3, 3))
def test_honest_tables_are_upheld(car, seed, hold, writing, heading):
    motion = drive(car, seed, seconds=SECONDS, hold=hold, heading=heading)
    verdict = judge_table(scene(motion), car, parse_table(text(motion, **writing)))
    assert verdict.upheld, verdict.summary()
    assert verdict.collision == "free"
    json.dumps(verdict.to_dict(), allow_nan=False)


@settings(max_examples=40)
@given(st.integers(0, 10**6), st.floats(0.05, 0.5), st.sampled_from([3, 4, 6]), st.sampled_from([0.02, 0.05, 0.1]))
def test_drifting_tables_are_refuted(seed, speed, decimals, dt):
    motion = drive(CAR, seed, seconds=SECONDS)
    table = parse_table(text(sideways(motion, speed), decimals=decimals, dt=dt))
    finding = judge_table(scene(motion), CAR, table).finding("side slip")
    assert finding.passed is False
    assert finding.value <= 1.3 * speed * max(1.0, finding.span)


@settings(max_examples=40)
@given(
    st.lists(st.tuples(st.floats(-8, 8), st.floats(-8, 8), st.floats(-3, 3)), min_size=2, max_size=6),
    st.lists(st.tuples(st.floats(-9, 9), st.floats(-9, 9), st.floats(0.1, 2)), max_size=4),
)
def test_what_is_proved_is_true_of_every_sample(poses, boxes):
    poses = np.array(poses)
    assume(len(np.unique(poses, axis=0)) > 1)
    obstacles = tuple(
        Obstacle(f"o{i}", [(x, y), (x + size, y), (x + size, y + size), (x, y + size)])
        for i, (x, y, size) in enumerate(boxes)
    )
    scenario = scene(drive(CAR, 0, seconds=0.5)).with_(obstacles=obstacles)
    columns = dict(zip(("x", "y", "theta"), poses.T, strict=True))
    verdict = judge_table(scenario, CAR, Table.from_columns(columns))
    s = np.linspace(0, len(poses) - 1, 800)
    samples = np.stack([np.interp(s, np.arange(len(poses)), column) for column in verdict.poses.T], axis=1)
    bodies = shapely.polygons(transform(CAR.parts[0].polygon.vertices, samples))
    region = shapely.union_all([polygon.to_shapely() for _, polygon in scenario.obstacle_parts])
    overlap = shapely.area(shapely.intersection(bodies, region)).max()
    if verdict.collision == "free":
        assert overlap < 1e-9
        if obstacles:
            assert shapely.distance(bodies, region).min() >= verdict.clearances.interpolated.clearance - 1e-9
    elif verdict.collision == "collides":
        witness = verdict.clearances.interpolated.obstacles[0]
        x, y, theta = witness.pose
        body = CAR.parts[0].polygon.transformed(x, y, theta).to_shapely()
        assert body.intersection(dict(scenario.obstacle_parts)[witness.obstacle].to_shapely()).area > 0
    if overlap > 1e-6:
        assert verdict.collision == "collides"


HONEST = text(drive(CAR, 1, seconds=1), dt=0.1)
PIECES = [
    "nan",
    "1e400",
    "-1e9",
    "1e-320",
    "\t",
    "\n",
    ";",
    ",",
    "theta",
    "#",
    "%",
    '"',
    "[deg]",
    "\ufeff",
    "\0",
    "1_0",
]
CHANGES = st.tuples(st.floats(0, 1), st.integers(0, 9), st.sampled_from(PIECES) | st.text(max_size=4))


@settings(max_examples=200)
@given(st.lists(CHANGES, max_size=3))
def test_any_text_is_a_table_or_a_table_error(changes):
    content = HONEST
    for at, dropped, inserted in changes:
        place = int(at * len(content))
        content = content[:place] + inserted + content[place + dropped :]
    problems = []
    try:
        table = parse_table(decoded(content.encode(errors="surrogatepass"), "table"))
    except TableError as error:
        problems = error.problems
    assert all(0 < len(problem.message) < 400 for problem in problems)
    if problems:
        return
    try:
        verdict = judge_table(scene(drive(CAR, 1, seconds=1)), CAR, table)
    except InputError:
        return
    json.dumps(verdict.to_dict(), allow_nan=False)
    assert verdict.upheld or verdict.failed


NUMBERS = st.floats(allow_nan=True, allow_infinity=True) | st.floats(-10, 10)


@settings(max_examples=150)
@given(
    st.lists(st.sampled_from(["t", "theta", "v", "delta", "a", "steering_rate"]), unique=True),
    st.lists(st.lists(NUMBERS, min_size=8, max_size=8), min_size=2, max_size=5),
)
@example(["t"], [[0, 0, 0, 0, 0, 0, 0, 0], [1e11, -1e11, 1e-300, 0, 0, 0, 0, 0]])
@example(["t", "v"], [[0, 0, 0, 0, 0, 0, 0, 0], [1e11, -1e11, 86400, 1e6, 0, 0, 0, 0]])
def test_any_numbers_are_a_table_or_a_table_error(names, rows):
    columns = dict(zip(("x", "y", *names), np.array(rows).T, strict=False))
    if "t" in columns and np.isfinite(columns["t"]).all():
        columns["t"] = np.sort(columns["t"])
    try:
        table = Table.from_columns(columns)
        verdict = judge_table(scene(drive(CAR, 1, seconds=1)), CAR, table)
    except InputError:
        return
    json.dumps(verdict.to_dict(), allow_nan=False)
