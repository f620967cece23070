"""Motion bounds hold on whole intervals; a vehicle file makes a vehicle or a VehicleError, nothing else."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from tightspot.errors import VehicleError
from tightspot.vehicles import CATALOGUE, Limits, SingleTrack, from_dict, vehicle

CARS = [vehicle(name) for name in CATALOGUE]
unit = st.floats(-1, 1)


@st.composite
def intervals(draw):
    """A car, a state within its limits, a constant input that keeps it there, and a duration."""
    car = draw(st.sampled_from(CARS))
    low, high = (bound[3:] for bound in car.state_bounds)
    before, after = (np.array([draw(st.floats(a, b)) for a, b in zip(low, high, strict=True)]) for _ in "ab")
    input_low, input_high = car.input_bounds
    duration = draw(st.floats(0.05, 3.0))
    control = np.clip((after - before) / duration, input_low, input_high)
    return car, np.r_[draw(unit), draw(unit), 3 * draw(unit), before], control, duration


def sampled_motion(car, before, control, duration, samples=65):
    """Times, states' v and delta, and the exact first and second derivatives of the pose."""
    t = np.linspace(0.0, duration, samples)
    v, delta = before[3] + control[0] * t, before[4] + control[1] * t
    yaw_rate = v * np.tan(delta) / car.wheelbase
    yaw_acceleration = (control[0] * np.tan(delta) + v * control[1] / np.cos(delta) ** 2) / car.wheelbase
    theta = before[2] + np.r_[0.0, np.cumsum((yaw_rate[1:] + yaw_rate[:-1]) / 2 * np.diff(t))]
    heading = np.stack([np.cos(theta), np.sin(theta)])
    left = np.stack([-np.sin(theta), np.cos(theta)])
    return (
        t,
        v,
        delta,
        theta,
        yaw_rate,
        yaw_acceleration,
        v * heading,
        control[0] * heading + v * yaw_rate * left,
    )


@given(intervals(), st.floats(0, 5), st.floats(-np.pi, np.pi))
def test_no_body_point_is_faster_or_accelerates_more_than_the_bounds_say(interval, rho, angle):
    car, before, control, duration = interval
    _, v, delta, theta, yaw_rate, yaw_acceleration, velocity, acceleration = sampled_motion(
        car, before, control, duration
    )
    after = np.array([0, 0, 0, v[-1], delta[-1]])
    (bounds,) = car.motion_bounds(before[None], after[None], control[None])
    slack = 1 + 1e-9
    assert (np.abs(v) <= bounds.speed[0] * slack + 1e-12).all()
    assert (np.abs(yaw_rate) <= bounds.yaw_rate[0] * slack + 1e-12).all()
    assert (np.abs(yaw_acceleration) <= bounds.yaw_acceleration[0] * slack + 1e-12).all()
    assert (np.hypot(*acceleration) <= bounds.acceleration[0] * slack + 1e-12).all()
    arm = rho * np.stack([np.cos(theta + angle), np.sin(theta + angle)])
    across = np.stack([-arm[1], arm[0]])
    point_speed = np.hypot(*(velocity + yaw_rate * across))
    point_acceleration = np.hypot(*(acceleration + yaw_acceleration * across - yaw_rate**2 * arm))
    assert (point_speed <= (bounds.speed[0] + bounds.yaw_rate[0] * rho) * slack + 1e-9).all()
    turning = bounds.yaw_acceleration[0] + bounds.yaw_rate[0] ** 2
    assert (point_acceleration <= (bounds.acceleration[0] + turning * rho) * slack + 1e-9).all()


@given(intervals(), st.floats(0, 5))
def test_the_smooth_acceleration_bound_is_never_below_the_sharp_one(interval, rho):
    car, before, control, duration = interval
    after = before + np.r_[0, 0, 0, control] * duration
    (sharp,) = car.motion_bounds(before[None], after[None], control[None])
    smooth = car.acceleration_bound(0, rho, (before + after) / 2, control, duration / 2, np)
    rotation = sharp.yaw_acceleration[0] + sharp.yaw_rate[0] ** 2
    assert smooth >= sharp.acceleration[0] + rotation * rho - 1e-9


@given(intervals())
def test_bounds_do_not_depend_on_where_the_car_is_and_come_in_batches(interval):
    car, before, control, duration = interval
    after = before + np.r_[0, 0, 0, control] * duration
    moved = before + np.array([10.0, -20.0, 1.0, 0.0, 0.0])
    (bounds,) = car.motion_bounds(np.stack([before, moved]), np.stack([after, after]), np.stack([control] * 2))
    for values in bounds:
        assert values.shape == (2,)
        assert values[0] == values[1]


@given(
    st.floats(0.5, 10),
    st.floats(0.1, 5),
    st.floats(0.1, 5),
    st.floats(0.05, 1.5),
    st.floats(0.01, 5),
    st.floats(0, 2),
)
def test_every_sensible_rectangle_survives_its_file(wheelbase, speed, acceleration, steering, rate, overhang):
    limits = Limits((-speed, speed / 2), (-acceleration, acceleration), steering, rate)
    car = SingleTrack.rectangular(
        "car",
        wheelbase=wheelbase,
        length=wheelbase + overhang + 0.5,
        width=1.0,
        rear_overhang=overhang,
        limits=limits,
    )
    copy = from_dict(car.to_dict())
    assert copy.limits == limits
    assert copy.wheelbase == wheelbase
    assert copy.parts[0].polygon == car.parts[0].polygon


KEYS = [
    "name",
    "model",
    "wheelbase",
    "body",
    "limits",
    "source",
    "length",
    "width",
    "rear_overhang",
    "vertices",
]
KEYS += ["speed", "acceleration", "steering", "steering_rate"]
numbers = st.one_of(st.floats(), st.integers(), st.just(10**400), st.sampled_from([0.5, 1, 3, -1, 40]))
leaves = st.one_of(st.none(), st.booleans(), numbers, st.text(max_size=5), st.just("single_track"))
points = st.lists(st.lists(numbers, min_size=2, max_size=2), max_size=6)
values = st.recursive(
    leaves | points,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from(KEYS), inner, max_size=6),
    max_leaves=15,
)


@settings(max_examples=80)
@given(st.dictionaries(st.sampled_from(KEYS), values, max_size=8) | values)
def test_arbitrary_data_is_a_vehicle_or_a_vehicle_error(data):
    refused_or_drivable(data)


@settings(max_examples=200)
@given(st.sampled_from(["wheelbase", "body", "limits", "name", "model"]), values, st.sampled_from([None, *KEYS]))
def test_a_good_file_with_one_odd_value_is_a_vehicle_or_a_vehicle_error(key, value, inner):
    data = vehicle("forklift").to_dict()
    if inner and isinstance(data[key], dict):
        data[key] = {**data[key], inner: value}
    else:
        data[key] = value
    refused_or_drivable(data)


def refused_or_drivable(data):
    try:
        car = from_dict(data)
    except VehicleError as error:
        car, problems = None, error.problems
    if car is None:
        assert problems
        assert all(problem.message and "\n" not in problem.message for problem in problems)
    else:
        assert np.isfinite(car.dynamics([0, 0, 0, 1.0, car.limits.steering], [0, 0], np)).all()
        assert len({part.name for part in car.parts}) == len(car.parts)
