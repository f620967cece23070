"""Honest tables pass, whatever their columns, spacing and digits; slipping and lying ones do not, and are told why."""

from __future__ import annotations

import numpy as np
import pytest
from tests.verification.tables.honest import ISSUE, changed, drive, scene, sideways, text

from tightspot.vehicles import vehicle
from tightspot.verification import Table, judge_table
from tightspot.verification.tables import parse_table

CARS = ("paper", "tpcap", "forklift")
COLUMNS = {
    "issue": ISSUE,
    "without inputs": ("t", "x", "y", "theta", "v", "delta"),
    "without steering": ("t", "x", "y", "theta", "v"),
    "without speed": ("t", "x", "y", "theta", "delta"),
    "poses": ("t", "x", "y", "theta"),
    "path": ("x", "y", "theta"),
    "path with steering": ("x", "y", "theta", "sigma"),
    "points": ("x", "y"),
}
KINEMATICS = (
    "side slip",
    "speed against motion",
    "heading against steering",
    "steering against steering rate",
    "speed against acceleration",
)


def judged(motion, car, **how):
    return judge_table(scene(motion), car, parse_table(text(motion, **how)))


@pytest.mark.parametrize("columns", COLUMNS)
@pytest.mark.parametrize("decimals", [None, 6, 4, 3])
@pytest.mark.parametrize("dt", [0.01, 0.05, 0.2])
def test_honest_tables_are_upheld(columns, decimals, dt):
    for seed, name in enumerate(CARS):
        car = vehicle(name)
        motion = drive(car, 10 * seed + 1, hold=[0.25, 0.5, 1.0][seed])
        if columns == "points" and np.hypot(*np.ptp(motion.states[:, :2], axis=0)) < 1:
            continue
        verdict = judged(motion, car, dt=dt, decimals=decimals, columns=COLUMNS[columns])
        assert verdict.upheld, (name, verdict.summary())


def test_what_a_table_does_not_hold_is_not_judged():
    motion = drive(vehicle("tpcap"), 1)
    absent = {
        "issue": set(),
        "without inputs": {"steering against steering rate", "speed against acceleration"},
        "poses": set(KINEMATICS[1:]),
        "path": set(KINEMATICS[1:]),
        "points": set(KINEMATICS),
    }
    for columns, names in absent.items():
        verdict = judged(motion, vehicle("tpcap"), columns=COLUMNS[columns])
        assert {name for name in KINEMATICS if verdict.finding(name).passed is None} == names
        assert all(verdict.finding(name).value is None for name in names)
        timeless = {f.name for f in verdict.findings if f.passed is None and "there are no times" in f.sentence}
        assert bool(timeless) == ("t" not in COLUMNS[columns])


def test_smooth_inputs_are_honest_too():
    """Rows are samples of smooth accelerations and steering rates here, not the beginnings of constant ones."""
    car, t = vehicle("obca"), np.arange(0, 10 + 1e-9, 1e-3)
    v, a = 0.5 * np.sin(0.6 * t), 0.3 * np.cos(0.6 * t)
    delta, omega = 0.4 * np.sin(0.9 * t), 0.36 * np.cos(0.9 * t)
    rate = v * np.tan(delta) / car.wheelbase
    theta = np.concatenate([[0], np.cumsum(0.5e-3 * (rate[1:] + rate[:-1]))])
    way = [np.concatenate([[0], np.cumsum(0.5e-3 * (w[1:] + w[:-1]))]) for w in (v * np.cos(theta), v * np.sin(theta))]
    columns = {"t": t, "x": way[0], "y": way[1], "theta": theta, "v": v, "delta": delta, "a": a, "omega": omega}
    for every in (10, 100, 400):
        verdict = judge_table(
            scene(drive(car, 0, seconds=1)), car, Table.from_columns({key: w[::every] for key, w in columns.items()})
        )
        assert all(verdict.finding(name).passed for name in KINEMATICS), verdict.summary()


def shifted(motion, metres):
    """The positions are of a point ahead of the rear axle."""
    states = motion.states.copy()
    states[:, :2] += metres * np.column_stack([np.cos(states[:, 2]), np.sin(states[:, 2])])
    return motion._replace(states=states)


def circle_by_euler(car, dt=0.1):
    """Forward on a circle, integrated by Euler's rule: the steps follow the heading of the row before."""
    v, delta = 1.0, 0.5
    theta = dt * v * np.tan(delta) / car.wheelbase * np.arange(60)
    x = np.concatenate([[0], np.cumsum(dt * v * np.cos(theta[:-1]))])
    y = np.concatenate([[0], np.cumsum(dt * v * np.sin(theta[:-1]))])
    constant = {"v": np.full(60, v), "delta": np.full(60, delta)}
    return Table.from_columns({"t": dt * np.arange(60), "x": x, "y": y, "theta": theta, **constant})


def lie(name, motion):
    middle = motion.t[motion.t.size // 2]
    changes = {
        "drift of 2 cm/s": lambda: sideways(motion, 0.02),
        "heading off by 0.03 rad": lambda: changed(motion, 2, lambda theta: theta + 0.03),
        "point 1.4 m ahead": lambda: shifted(motion, 1.4),
        "jump of 3 cm": lambda: changed(motion, 0, lambda x: x + 0.03, since=middle),
        "heading jumps": lambda: changed(motion, 2, lambda theta: theta + 0.05, since=middle),
        "speed 5 % too large": lambda: changed(motion, 3, lambda v: 1.05 * v),
        "speed without sign": lambda: changed(motion, 3, np.abs),
        "speed in km/h": lambda: changed(motion, 3, lambda v: 3.6 * v),
        "speed of the wrong sign": lambda: changed(motion, 3, lambda v: -v),
        "steering to the right": lambda: changed(motion, 4, lambda delta: -delta),
        "steering jumps": lambda: changed(motion, 4, lambda delta: delta + 0.2, since=middle),
        "steering rate 20 % too large": lambda: motion._replace(inputs=motion.inputs * [1, 1.2]),
        "acceleration 20 % too large": lambda: motion._replace(inputs=motion.inputs * [1.2, 1]),
        "time 10 % too short": lambda: motion._replace(t=0.9 * motion.t),
    }
    return changes[name]()


LIES = {
    "drift of 2 cm/s": ("side slip", ""),
    "heading off by 0.03 rad": ("side slip", "heading is off"),
    "point 1.4 m ahead": ("side slip", "1.4"),
    "jump of 3 cm": ("side slip", ""),
    "heading jumps": ("heading against steering", ""),
    "speed 5 % too large": ("speed against motion", ""),
    "speed without sign": ("speed against motion", "negative in reverse"),
    "speed in km/h": ("speed against motion", "km/h"),
    "speed of the wrong sign": ("speed against motion", "wrong sign"),
    "steering to the right": ("heading against steering", "positive to the left"),
    "steering jumps": ("steering against steering rate", ""),
    "steering rate 20 % too large": ("steering against steering rate", ""),
    "acceleration 20 % too large": ("speed against acceleration", ""),
    "time 10 % too short": ("speed against motion", ""),
}


@pytest.mark.parametrize("name", LIES)
@pytest.mark.parametrize("car_name", CARS)
def test_lies_are_found_and_explained(name, car_name):
    car = vehicle(car_name)
    motion = drive(car, 3)
    check, words = LIES[name]
    for how in ({"dt": 0.05, "decimals": 4}, {"dt": 0.1, "decimals": 6}, {"dt": 0.02, "decimals": None}):
        verdict = judge_table(scene(motion), car, parse_table(text(lie(name, motion), **how)))
        finding = verdict.finding(check)
        assert finding.passed is False, verdict.summary()
        assert not verdict.upheld
        assert finding.value > finding.limit
    assert words in finding.sentence


def test_a_single_row_out_of_line_is_found_where_it_is():
    car = vehicle("tpcap")
    motion = drive(car, 4)
    rows = text(motion).splitlines()
    cells = rows[60].split("\t")
    cells[2] = f"{float(cells[2]) + 0.02:.4f}"
    rows[60] = "\t".join(cells)
    verdict = judge_table(scene(motion), car, parse_table("\n".join(rows)))
    worst = next(f for f in verdict.failed if f.group == "kinematics")
    assert worst.row == pytest.approx(59, abs=1)  # the names are line 1, row 0 is line 2
    assert "(line 60)" in worst.sentence or "(line 61)" in worst.sentence


def test_slip_is_measured():
    """2 cm sideways within a second."""
    car = vehicle("tpcap")
    motion = drive(car, 1)
    verdict = judge_table(scene(motion), car, parse_table(text(sideways(motion, 0.02), dt=0.02, decimals=6)))
    finding = verdict.finding("side slip")
    assert finding.value == pytest.approx(0.02 * min(finding.span, 1.0), rel=0.15)
    assert 4.0 < verdict.place.time(finding.row) < 5.0


def test_euler_is_recognised():
    car = vehicle("tpcap")
    finding = judge_table(scene(drive(car, 2, seconds=1)), car, circle_by_euler(car)).finding("side slip")
    assert not finding.passed
    assert "Euler" in finding.sentence


def test_another_wheelbase_is_recognised():
    motion = drive(vehicle("tpcap"), 2)
    verdict = judge_table(scene(motion), vehicle("forklift"), parse_table(text(motion)))
    finding = verdict.finding("heading against steering")
    assert not finding.passed
    assert "they fit a wheelbase of 2.80 m" in finding.sentence
