"""Replay a plan file's inputs in 1 ms steps and look at every frame with shapely.

A second opinion that shares no code with tightspot: it reads ``plan.json``, integrates the kinematic
single-track model with its own RK4, places the vehicle's polygons and asks shapely. Run it as
``python -m benchmarks.replay PLAN.json ...``.
"""

from __future__ import annotations

import json
import math
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely

STEP = 1e-3
GOAL_POSITION = 0.01
GOAL_HEADING = math.radians(1)
KNOTS = 5e-3
LIMITS = 1e-6
WORKSPACE = 1e-5


@dataclass(frozen=True)
class Replay:
    """What the replay saw.

    Attributes:
        frames: Number of poses looked at.
        clearance: Smallest distance of body and obstacles in any frame, m; 0 if they overlap.
        overlaps: Times of the frames that overlap an obstacle, s.
        outside: Largest distance of a frame's corner beyond the workspace, m.
        goal_position: Distance of the last pose from the goal, m.
        goal_heading: Angle between the last pose and the goal, rad.
        knots: Largest distance of a stored knot from the replay, m.
        excess: Largest excess of a speed, steering angle, acceleration or steering rate over its limit.
    """

    frames: int
    clearance: float
    overlaps: tuple[float, ...]
    outside: float
    goal_position: float
    goal_heading: float
    knots: float
    excess: float

    def problems(self, margin: float = 0.0) -> list[str]:
        """One sentence for everything that a certified plan must not show."""
        found = []
        if self.overlaps:
            found.append(f"{len(self.overlaps)} frames overlap an obstacle, the first at {self.overlaps[0]:.3f} s")
        if self.clearance < margin - 1e-6:
            found.append(f"the clearance is {self.clearance:.6f} m, the plan promises {margin:g} m")
        if self.outside > WORKSPACE:
            found.append(f"the body leaves the workspace by {self.outside:.6f} m")
        if self.goal_position > GOAL_POSITION:
            found.append(f"the goal is missed by {self.goal_position:.4f} m")
        if self.goal_heading > GOAL_HEADING:
            found.append(f"the goal's heading is missed by {math.degrees(self.goal_heading):.2f} degrees")
        if self.knots > KNOTS:
            found.append(f"a stored knot is {self.knots:.4f} m from the replay")
        if self.excess > LIMITS:
            found.append(f"a limit is exceeded by {self.excess:g}")
        return found


def replay_file(path: str | Path) -> Replay:
    """Replay the plan in a file."""
    return replay(json.loads(Path(path).read_text(encoding="utf-8")))


def replay(plan: dict[str, Any]) -> Replay:
    """Replay a plan file's object."""
    states = plan["trajectory"]["states"]
    origin = np.array([states["x"][0], states["y"][0]])
    motion, at_knots = integrate(plan, origin)
    frames = body_frames(plan["vehicle"], motion[:, 1:4])
    obstacles = [
        shapely.Polygon(np.array(o["vertices"]) - origin, [np.array(hole) - origin for hole in o.get("holes", [])])
        for o in plan["scenario"]["obstacles"]
    ]
    clearance, hit = math.inf, np.zeros(len(motion), bool)
    for obstacle in obstacles:
        shapely.prepare(obstacle)
        for part in frames:
            clearance = min(clearance, float(shapely.distance(part, obstacle).min()))
            hit |= shapely.intersects(part, obstacle)
    goal, last = plan["scenario"]["goal"], motion[-1]
    knots = np.column_stack([states["x"], states["y"]]) - origin
    return Replay(
        frames=len(motion),
        clearance=clearance,
        overlaps=tuple(motion[hit, 0].tolist()),
        outside=_outside(plan, frames, origin),
        goal_position=math.hypot(last[1] - (goal["x"] - origin[0]), last[2] - (goal["y"] - origin[1])),
        goal_heading=abs(math.remainder(last[3] - goal["theta"], math.tau)),
        knots=float(np.hypot(*(at_knots[:, 1:3] - knots).T).max()),
        excess=_excess(plan, motion),
    )


def integrate(plan: dict[str, Any], origin: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows (t, x, y, theta, v, delta) at every millisecond, and at the knots; relative to ``origin``."""
    trajectory = plan["trajectory"]
    wheelbase = plan["vehicle"]["wheelbase"]
    times, inputs = trajectory["t"], trajectory["inputs"]
    names = ("x", "y", "theta", "v", "delta")
    state = [trajectory["states"][name][0] for name in names]
    state = [state[0] - origin[0], state[1] - origin[1], *state[2:]]
    rows, knots = [[times[0], *state]], [[times[0], *state]]
    for k, (a, omega) in enumerate(zip(inputs["a"], inputs["omega"], strict=True)):
        steps = max(1, math.ceil((times[k + 1] - times[k]) / STEP))
        h = (times[k + 1] - times[k]) / steps
        for i in range(steps):
            state = _step(state, a, omega, wheelbase, h)
            rows.append([times[k] + (i + 1) * h, *state])
        knots.append(rows[-1])
    return np.array(rows), np.array(knots)


def _step(state: list[float], a: float, omega: float, wheelbase: float, h: float) -> list[float]:
    """One step of the classical Runge-Kutta method."""

    def rate(s: list[float]) -> list[float]:
        _, _, theta, v, delta = s
        return [v * math.cos(theta), v * math.sin(theta), v * math.tan(delta) / wheelbase, a, omega]

    def ahead(slope: list[float], by: float) -> list[float]:
        return [s + by * r for s, r in zip(state, slope, strict=True)]

    k1 = rate(state)
    k2 = rate(ahead(k1, h / 2))
    k3 = rate(ahead(k2, h / 2))
    k4 = rate(ahead(k3, h))
    return [s + h / 6 * (p + 2 * q + 2 * r + w) for s, p, q, r, w in zip(state, k1, k2, k3, k4, strict=True)]


def body_frames(vehicle: dict[str, Any], poses: np.ndarray) -> list[np.ndarray]:
    """For each part of the body an array of its polygons at the poses (M, 3)."""
    c, s = np.cos(poses[:, 2])[:, None], np.sin(poses[:, 2])[:, None]
    frames = []
    for part in vehicle["body"]:
        corners = np.array(part["vertices"], float)
        closed = np.vstack([corners, corners[:1]])
        x = poses[:, :1] + c * closed[:, 0] - s * closed[:, 1]
        y = poses[:, 1:2] + s * closed[:, 0] + c * closed[:, 1]
        frames.append(shapely.polygons(np.stack([x, y], axis=-1)))
    return frames


def _outside(plan: dict[str, Any], frames: list[np.ndarray], origin: np.ndarray) -> float:
    workspace = shapely.Polygon(np.array(plan["scenario"]["workspace"]) - origin)
    corners = np.concatenate([shapely.get_coordinates(part) for part in frames])
    return float(shapely.distance(shapely.points(corners), workspace).max())


def _excess(plan: dict[str, Any], motion: np.ndarray) -> float:
    limits, inputs = plan["vehicle"]["limits"], plan["trajectory"]["inputs"]
    stored = plan["trajectory"]["states"]
    ranges = [
        (np.append(motion[:, 4], stored["v"]), *limits["speed"]),
        (np.append(motion[:, 5], stored["delta"]), -limits["steering"], limits["steering"]),
        (np.array(inputs["a"]), *limits["acceleration"]),
        (np.array(inputs["omega"]), -limits["steering_rate"], limits["steering_rate"]),
    ]
    return max(float(np.maximum(low - values, values - high).max()) for values, low, high in ranges)


def main() -> int:
    """Replay the plan files named on the command line; 1 if any shows a problem."""
    bad = 0
    for path in sys.argv[1:]:
        plan = json.loads(Path(path).read_text(encoding="utf-8"))
        seen = replay(plan)
        problems = seen.problems(plan["certificate"]["margin"])
        bad += bool(problems)
        sys.stdout.write(f"{path}: {seen.frames} frames, clearance {seen.clearance:.4f} m: ")
        sys.stdout.write(("; ".join(problems) or "no problem") + "\n")
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
