"""ROS messages: exactly the fields of the message definitions, and the motion in them."""

from __future__ import annotations

import json

import numpy as np
import pytest
import yaml

from tightspot.errors import InputError
from tightspot.exports import ros_path, ros_trajectory, write_ros_path, write_ros_trajectory
from tightspot.verification import Plan

TIME = {"sec": int, "nanosec": int}
HEADER = {"stamp": TIME, "frame_id": str}
POSE = {
    "position": {"x": float, "y": float, "z": float},
    "orientation": {"x": float, "y": float, "z": float, "w": float},
}
PATH = {"header": HEADER, "poses": [{"header": HEADER, "pose": POSE}]}
POINT = {
    "time_from_start": TIME,
    "pose": POSE,
    "longitudinal_velocity_mps": float,
    "lateral_velocity_mps": float,
    "acceleration_mps2": float,
    "heading_rate_rps": float,
    "front_wheel_angle_rad": float,
    "rear_wheel_angle_rad": float,
}
TRAJECTORY = {"header": HEADER, "points": [POINT]}


def is_a(message: object, kind: object) -> bool:
    """Whether the object has the message's fields, no others, with values of the right type."""
    if isinstance(kind, dict):
        return (
            isinstance(message, dict)
            and list(message) == list(kind)
            and all(is_a(message[name], kind[name]) for name in kind)
        )
    if isinstance(kind, list):
        return isinstance(message, list) and all(is_a(entry, kind[0]) for entry in message)
    return type(message) is kind


def seconds(time: dict[str, int]) -> float:
    assert 0 <= time["nanosec"] < 1_000_000_000
    return time["sec"] + time["nanosec"] * 1e-9


def yaw(pose: dict[str, dict[str, float]]) -> float:
    q = pose["orientation"]
    assert q["x"] == q["y"] == 0
    assert q["z"] ** 2 + q["w"] ** 2 == pytest.approx(1, abs=1e-15)
    return float(2 * np.arctan2(q["z"], q["w"]))


def test_the_path_is_a_path_message(plan: Plan) -> None:
    message = ros_path(plan, dt=0.2, frame_id="odom")
    assert is_a(message, PATH)
    assert {message["header"]["frame_id"]} == {entry["header"]["frame_id"] for entry in message["poses"]} == {"odom"}
    times = np.array([seconds(entry["header"]["stamp"]) for entry in message["poses"]])
    assert 0 < np.diff(times).max() <= 0.2 + 1e-9
    states = plan.sample(np.minimum(times, plan.trajectory.t[-1]))
    for entry, state in zip(message["poses"], states, strict=True):
        position = entry["pose"]["position"]
        assert [position["x"], position["y"], position["z"]] == pytest.approx([*state[:2], 0.0], abs=1e-8)
        assert np.cos(yaw(entry["pose"]) - state[2]) == pytest.approx(1)


def test_the_trajectory_is_a_trajectory_message(plan: Plan) -> None:
    message = ros_trajectory(plan, dt=0.1)
    assert is_a(message, TRAJECTORY)
    points = message["points"]
    times = np.array([seconds(point["time_from_start"]) for point in points])
    assert (times[0], times[-1]) == (0.0, pytest.approx(plan.trajectory.duration, abs=1e-9))
    for name, column in (("longitudinal_velocity_mps", 3), ("front_wheel_angle_rad", 4)):
        given = [point[name] for point in points]
        assert given == pytest.approx(plan.sample(np.minimum(times, plan.trajectory.t[-1]))[:, column], abs=1e-8)
    assert min(point["longitudinal_velocity_mps"] for point in points) < -0.5, "reverse is negative"
    assert points[-1]["acceleration_mps2"] == 0.0


def test_rates_are_the_derivatives_of_the_motion(plan: Plan) -> None:
    points = ros_trajectory(plan, dt=0.1)["points"]
    h = 1e-5
    for point in points[:-1]:
        t = seconds(point["time_from_start"])
        now, soon = plan.sample([t, t + h])
        assert point["heading_rate_rps"] == pytest.approx((soon[2] - now[2]) / h, abs=1e-4)
        assert point["acceleration_mps2"] == pytest.approx((soon[3] - now[3]) / h, abs=1e-4)


def test_files_are_json_and_yaml_in_original_coordinates(far_plan: Plan, tmp_path) -> None:
    write_ros_path(far_plan, tmp_path / "path.json", dt=0.5)
    write_ros_trajectory(far_plan, tmp_path / "trajectory.json", dt=0.5)
    text = (tmp_path / "path.json").read_text()
    assert json.loads(text) == ros_path(far_plan, dt=0.5)
    assert yaml.safe_load((tmp_path / "trajectory.json").read_text()) == ros_trajectory(far_plan, dt=0.5)
    first = json.loads(text)["poses"][0]["pose"]["position"]
    assert [first["x"], first["y"]] == far_plan.sample(0.0)[:2].tolist()


@pytest.mark.parametrize("dt", [0, -1, float("nan"), 1e-9])
def test_impossible_steps_are_refused(dt: float, plan: Plan, tmp_path) -> None:
    for write in (write_ros_path, write_ros_trajectory):
        with pytest.raises(InputError, match="dt: "):
            write(plan, tmp_path / "x.json", dt=dt)
    assert list(tmp_path.iterdir()) == []
