"""The kinematic single-track model: eq. (23), its limits, and bounds of its motion."""

import casadi as ca
import numpy as np
import pytest

from tightspot.errors import VehicleError
from tightspot.geometry import ConvexPolygon
from tightspot.vehicles import BodyPart, Limits, SingleTrack, vehicle

LIMITS = Limits(speed=(-1.5, 2.0), acceleration=(-1.0, 0.8), steering=0.6, steering_rate=0.4)


def make(**changes):
    arguments = {
        "wheelbase": 2.8,
        "length": 4.6,
        "width": 2.0,
        "rear_overhang": 0.9,
        "limits": LIMITS,
    } | changes
    return SingleTrack.rectangular("car", **arguments)


def test_dynamics_are_equation_23_worked_out_by_hand():
    car = make(wheelbase=2.0)
    state = [7.0, -3.0, np.pi / 6, 4.0, np.pi / 4]
    expected = [4 * np.sqrt(3) / 2, 2.0, 2.0, 0.25, -0.125]  # v cos, v sin, v tan / L, a, omega
    np.testing.assert_allclose(car.dynamics(state, [0.25, -0.125], np), expected, rtol=1e-15)


def test_reverse_and_left_steering_turn_the_car_right():
    dx, dy, dtheta, _, _ = make().dynamics([0, 0, 0, -1.0, 0.3], [0, 0], np)
    assert dx == -1.0
    assert dy == 0.0
    assert dtheta == pytest.approx(-np.tan(0.3) / 2.8)


def test_numpy_and_casadi_agree_on_dynamics_and_frames():
    car = vehicle("forklift")
    rng = np.random.default_rng(1)
    xi, u = ca.SX.sym("xi", 5), ca.SX.sym("u", 2)
    f = ca.Function("f", [xi, u], [ca.vertcat(*car.dynamics(ca.vertsplit(xi), ca.vertsplit(u), ca))])
    frame = ca.Function("frame", [xi], [ca.vertcat(*car.frames(ca.vertsplit(xi), ca)[0])])
    for state, control in zip(rng.uniform(-1, 1, (20, 5)), rng.uniform(-1, 1, (20, 2)), strict=True):
        np.testing.assert_allclose(np.array(f(state, control)).ravel(), car.dynamics(state, control, np), rtol=1e-15)
        np.testing.assert_array_equal(np.array(frame(state)).ravel(), car.frames(state, np)[0])
        np.testing.assert_array_equal(car.frames(state, np)[0], state[:3])


def test_dynamics_are_batched_over_arrays():
    car = make()
    states, controls = np.random.default_rng(2).uniform(-0.5, 0.5, (5, 4, 3)), np.ones((2, 4, 3))
    batched = car.dynamics(states, controls, np)
    single = car.dynamics(states[:, 2, 1], controls[:, 2, 1], np)
    np.testing.assert_allclose([entry[2, 1] for entry in batched], single, rtol=1e-14)


def test_bounds_and_names_are_in_state_order():
    car = make()
    low, high = car.state_bounds
    np.testing.assert_array_equal(low, [-np.inf, -np.inf, -np.inf, -1.5, -0.6])
    np.testing.assert_array_equal(high, [np.inf, np.inf, np.inf, 2.0, 0.6])
    np.testing.assert_array_equal(car.input_bounds, [[-1.0, -0.4], [0.8, 0.4]])
    assert (car.n_states, car.n_inputs) == (5, 2)
    assert len(car.state_units) == car.n_states
    assert len(car.input_units) == car.n_inputs


def test_the_rectangle_lies_about_the_rear_axle():
    (part,) = make(rear_overhang=0.9, length=4.6, width=2.0).parts
    low, high = part.polygon.vertices.min(axis=0), part.polygon.vertices.max(axis=0)
    np.testing.assert_allclose([low, high], [[-0.9, -1.0], [3.7, 1.0]], rtol=1e-15)


def test_turning_radius_is_that_of_the_driven_circle():
    car = make()
    speed = 0.5
    *_, turning, _, _ = car.dynamics([0, 0, 0, speed, LIMITS.steering], [0, 0], np)
    assert speed / turning == pytest.approx(car.min_turning_radius, rel=1e-14)


@pytest.mark.parametrize(
    ("changes", "path", "words"),
    [
        ({"length": 0.0}, "length", "positive"),
        ({"width": np.nan}, "width", "nan"),
        ({"rear_overhang": -0.1}, "rear_overhang", "-0.1"),
        ({"wheelbase": -2.8}, "wheelbase", "positive"),
        ({"wheelbase": np.inf}, "wheelbase", "finite"),
        ({"limits": Limits((0.0, 1.0), (-1, 1), 0.6, 0.4)}, "limits.speed", "below 0"),
        ({"limits": Limits((-1.0, 1e3), (-1, 1), 0.6, 0.4)}, "limits.speed", "100 m/s"),
        ({"limits": Limits((-1, 1), (1, -1), 0.6, 0.4)}, "limits.acceleration", "[1, -1]"),
        ({"limits": Limits((-1, 1), (-1, np.nan), 0.6, 0.4)}, "limits.acceleration", "nan"),
        ({"limits": Limits((-1, 1), (-1, 1), 40.0, 0.4)}, "limits.steering", "40 deg = 0.6981 rad"),
        ({"limits": Limits((-1, 1), (-1, 1), np.pi / 2, 0.4)}, "limits.steering", "90 deg"),
        ({"limits": Limits((-1, 1), (-1, 1), np.nan, 0.4)}, "limits.steering", "nan"),
        ({"limits": Limits((-1, 1), (-1, 1), 0.6, 30.0)}, "limits.steering_rate", "30 deg = 0.5236 rad"),
        ({"limits": Limits((-1, 1), (-1, 1), 0.6, 0.0)}, "limits.steering_rate", "positive"),
    ],
)
def test_senseless_numbers_are_refused_by_name(changes, path, words):
    with pytest.raises(VehicleError) as error:
        make(**changes)
    (problem,) = error.value.problems
    assert problem.path == path
    assert words in problem.message


def test_all_problems_come_at_once():
    with pytest.raises(VehicleError) as error:
        SingleTrack("car", 0.0, (), Limits((1, 1), (1, 1), 2.0, -1.0))
    paths = [
        "body",
        "wheelbase",
        "limits.speed",
        "limits.acceleration",
        "limits.steering",
        "limits.steering_rate",
    ]
    assert [problem.path for problem in error.value.problems] == paths


def test_parts_need_different_names_and_the_frame_there_is():
    square = ConvexPolygon.rectangle(0, 1, 0, 1)
    with pytest.raises(VehicleError, match=r"body\[1\].name: 'a' is already the name of body\[0\]"):
        SingleTrack("car", 2.0, (BodyPart("a", square), BodyPart("a", square)), LIMITS)
    with pytest.raises(VehicleError, match=r"body\[0\].frame: 1 must be 0"):
        SingleTrack("car", 2.0, (BodyPart("a", square, frame=1),), LIMITS)


def test_motion_beyond_ninety_degrees_is_unbounded_not_wrong():
    car = make()
    state = np.array([[0, 0, 0, 1.0, 1.6]])
    (bounds,) = car.motion_bounds(state, state, np.array([[0.1, 0.1]]))
    assert bounds.speed[0] == 1.0
    assert np.isinf([bounds.yaw_rate[0], bounds.acceleration[0], bounds.yaw_acceleration[0]]).all()


def test_acceleration_bound_is_smooth_and_the_same_in_both_namespaces():
    car = make()
    middle, control, half = ca.SX.sym("m", 5), ca.SX.sym("u", 2), ca.SX.sym("h")
    expression = car.acceleration_bound(0, 3.8, ca.vertsplit(middle), ca.vertsplit(control), half, ca)
    arguments = ca.vertcat(middle, control, half)
    hessian = ca.Function("H", [middle, control, half], [expression, ca.hessian(expression, arguments)[0]])
    rng = np.random.default_rng(3)
    at_rest = [(np.zeros(5), np.zeros(2), 0.0)]
    for point in [*at_rest, *((rng.uniform(-1, 1, 5), rng.uniform(-0.5, 0.5, 2), 0.7) for _ in range(10))]:
        value, curvature = hessian(*point)
        assert float(value) == pytest.approx(car.acceleration_bound(0, 3.8, *point, np), rel=1e-14)
        assert np.isfinite(np.array(curvature)).all()
