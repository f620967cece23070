"""Plans as ROS 2 messages in JSON: ``nav_msgs/msg/Path`` and ``autoware_planning_msgs/msg/Trajectory``.

The objects hold the messages' fields and nothing else, so that ``rosidl_runtime_py.set_message_fields`` fills a message
from them and ``ros2 topic pub`` takes the file's text (JSON is YAML). Poses are of the rear-axle midpoint, coordinates
the scenario's original ones. The messages have no room for a steering rate.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot.files import atomic_write
from tightspot.verification import Plan

Array = NDArray[np.float64]

FRAME = "map"
DT = 0.1
"""Poses are at most this far apart in time, s."""


def ros_path(plan: Plan, *, dt: float = DT, frame_id: str = FRAME) -> dict[str, Any]:
    """The plan's path as a ``nav_msgs/msg/Path``.

    Args:
        plan: The plan.
        dt: Poses are taken at times at most this far apart, s, and at every knot.
        frame_id: The coordinate frame's name in every header.

    Raises:
        InputError: ``dt`` is not a positive time, or the trajectory cannot be integrated.
    """
    times, states = _sampled(plan, dt)
    poses = [
        {"header": _header(frame_id, time), "pose": _pose(state)} for time, state in zip(times, states, strict=True)
    ]
    return {"header": _header(frame_id, times[0]), "poses": poses}


def ros_trajectory(plan: Plan, *, dt: float = DT, frame_id: str = FRAME) -> dict[str, Any]:
    """The plan's motion as an ``autoware_planning_msgs/msg/Trajectory``.

    Speeds are negative in reverse. An acceleration is the one from the point's time on; at the end it is 0. Arguments
    and errors are those of :func:`ros_path`.
    """
    times, states = _sampled(plan, dt)
    names = plan.vehicle.state_names
    rates, accelerations = _rates(plan, times, states)
    points = [
        {
            "time_from_start": _time(time - times[0]),
            "pose": _pose(state),
            "longitudinal_velocity_mps": _entry(state, names, "v"),
            "lateral_velocity_mps": 0.0,
            "acceleration_mps2": acceleration,
            "heading_rate_rps": rate,
            "front_wheel_angle_rad": _entry(state, names, "delta"),
            "rear_wheel_angle_rad": 0.0,
        }
        for time, state, rate, acceleration in zip(times, states, rates, accelerations, strict=True)
    ]
    return {"header": _header(frame_id, times[0]), "points": points}


def write_ros_path(plan: Plan, path: str | Path, *, dt: float = DT, frame_id: str = FRAME) -> None:
    """Write :func:`ros_path` as JSON; ``OSError`` if the file cannot be written."""
    _write(ros_path(plan, dt=dt, frame_id=frame_id), path)


def write_ros_trajectory(plan: Plan, path: str | Path, *, dt: float = DT, frame_id: str = FRAME) -> None:
    """Write :func:`ros_trajectory` as JSON; ``OSError`` if the file cannot be written."""
    _write(ros_trajectory(plan, dt=dt, frame_id=frame_id), path)


def _sampled(plan: Plan, dt: float) -> tuple[Array, Array]:
    times = plan.times(dt)
    return times, plan.sample(times)


def _rates(plan: Plan, times: Array, states: Array) -> tuple[list[float], list[float]]:
    """Heading rates, rad/s, and accelerations, m/s^2, at the times; both are those of the model's equations."""
    inputs = plan.sample_inputs(times)
    slopes = plan.vehicle.dynamics(list(states.T), list(inputs.T), np)
    names = list(plan.vehicle.state_names)
    rate, acceleration = (
        np.broadcast_to(slopes[names.index(name)] if name in names else 0.0, times.shape).astype(float)
        for name in ("theta", "v")
    )
    return rate.tolist(), [*acceleration[:-1].tolist(), 0.0]


def _header(frame_id: str, time: float) -> dict[str, Any]:
    return {"stamp": _time(time), "frame_id": frame_id}


def _time(seconds: float) -> dict[str, int]:
    nanoseconds = round(float(seconds) * 1e9)
    return {"sec": nanoseconds // 1_000_000_000, "nanosec": nanoseconds % 1_000_000_000}


def _pose(state: Array) -> dict[str, Any]:
    x, y, theta = state[:3].tolist()
    return {
        "position": {"x": x, "y": y, "z": 0.0},
        "orientation": {"x": 0.0, "y": 0.0, "z": float(np.sin(theta / 2)), "w": float(np.cos(theta / 2))},
    }


def _entry(state: Array, names: tuple[str, ...], name: str) -> float:
    return float(state[names.index(name)]) if name in names else 0.0


def _write(data: dict[str, Any], path: str | Path) -> None:
    atomic_write(path, json.dumps(data, allow_nan=False, indent=1) + "\n")
