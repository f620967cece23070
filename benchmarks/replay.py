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
PIECE = 0.1
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
        room: Smallest distance of a frame inside the workspace from its boundary, m; minus ``outside`` if it leaves.
        goal_position: Distance of the last pose from the goal, m.
        goal_heading: Angle between the last pose and the goal, rad.
        knots: Largest distance of a stored knot from the replay, m.
        excess: Largest excess of a speed, steering angle, acceleration or steering rate over its limit.
    """

    frames: int
    clearance: float
    overlaps: tuple[float, ...]
    outside: float
    room: float
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
    clearance, hit = _clearance(frames, obstacles)
    room = _room(shapely.Polygon(np.array(plan["scenario"]["workspace"]) - origin), frames)
    goal, last = plan["scenario"]["goal"], motion[-1]
    knots = np.column_stack([states["x"], states["y"]]) - origin
    return Replay(
        frames=len(motion),
        clearance=clearance,
        overlaps=tuple(motion[hit, 0].tolist()),
        outside=max(0.0, -room),
        room=room,
        goal_position=math.hypot(last[1] - (goal["x"] - origin[0]), last[2] - (goal["y"] - origin[1])),
        goal_heading=abs(math.remainder(last[3] - goal["theta"], math.tau)),
        knots=float(np.hypot(*(at_knots[:, 1:3] - knots).T).max()),
        excess=_excess(plan, motion),
    )


def integrate(plan: dict[str, Any], origin: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows (t, x, y, theta, v, delta) at every millisecond, and at the knots; relative to ``origin``.

    Pieces of at most ``PIECE`` seconds are integrated all at once, each from its own rear axle, and then put end
    to end.
    """
    t, inputs, first = (plan["trajectory"][key] for key in ("t", "inputs", "states"))
    t, u = np.array(t, float), np.array([inputs["a"], inputs["omega"]], float)
    pieces = np.maximum(1, np.ceil(np.diff(t) / PIECE).astype(int))
    u = np.repeat(u, pieces, axis=1)
    lengths = np.repeat(np.diff(t) / pieces, pieces)
    starts = np.concatenate([a + (b - a) / n * np.arange(n) for a, b, n in zip(t, t[1:], pieces, strict=False)])
    steps = np.maximum(1, np.ceil(lengths / STEP).astype(int))
    h = lengths / steps
    begin = np.array([first["v"][0], first["delta"][0]])[:, None] + np.cumsum(u * lengths, axis=1) - u * lengths
    state = np.vstack([np.zeros((3, lengths.size)), begin])
    moved = np.empty((steps.max(), *state.shape))
    for i in range(steps.max()):
        state = moved[i] = _step(state, u, plan["vehicle"]["wheelbase"], h)
    x, y, theta = first["x"][0] - origin[0], first["y"][0] - origin[1], first["theta"][0]
    rows = [np.array([[t[0], x, y, theta, *begin[:, 0]]])]
    for k, n in enumerate(steps):
        _, x, y, theta, _, _ = rows[-1][-1]
        c, s = math.cos(theta), math.sin(theta)
        dx, dy, turn, v, delta = moved[:n, :, k].T
        times = starts[k] + h[k] * np.arange(1, n + 1)
        rows.append(np.column_stack([times, x + c * dx - s * dy, y + s * dx + c * dy, theta + turn, v, delta]))
    at_knots = [0, *np.cumsum(pieces)]
    return np.concatenate(rows), np.stack([rows[place][-1] for place in at_knots])


def _step(state: np.ndarray, u: np.ndarray, wheelbase: float, h: np.ndarray) -> np.ndarray:
    """One step of the classical Runge-Kutta method for states (5, N) and inputs (2, N)."""

    def rate(s: np.ndarray) -> np.ndarray:
        _, _, theta, v, delta = s
        return np.stack([v * np.cos(theta), v * np.sin(theta), v * np.tan(delta) / wheelbase, *u])

    k1 = rate(state)
    k2 = rate(state + h / 2 * k1)
    k3 = rate(state + h / 2 * k2)
    k4 = rate(state + h * k3)
    return state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


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


def _clearance(frames: list[np.ndarray], obstacles: list[shapely.Polygon]) -> tuple[float, np.ndarray]:
    """Smallest distance of any frame from any obstacle, m, and which frames overlap one.

    A frame is passed over only if a point of it, the middle of its box, is farther from the obstacle than the
    frame's box reaches plus the smallest distance known.
    """
    best, hit = math.inf, np.zeros(len(frames[0]), bool)
    for part in frames:
        low_x, low_y, high_x, high_y = shapely.bounds(part).T
        middles = shapely.points((low_x + high_x) / 2, (low_y + high_y) / 2)
        reach = np.hypot(high_x - low_x, high_y - low_y) / 2
        for obstacle in obstacles:
            far = shapely.distance(middles, obstacle) - reach
            best = min(best, float(shapely.distance(part[far.argmin()], obstacle)))
            near = np.flatnonzero(far <= best)
            distance = shapely.distance(part[near], obstacle)
            best = min(best, float(distance.min(initial=math.inf)))
            hit[near] |= distance == 0
    return best, hit


def _room(workspace: shapely.Polygon, frames: list[np.ndarray]) -> float:
    """Smallest distance of the frames inside the workspace from its boundary, m, negative if one leaves it."""
    shapely.prepare(workspace)
    room, boundary = math.inf, workspace.exterior
    for part in frames:
        out = ~shapely.covers(workspace, part)
        if out.any():
            corners = shapely.points(shapely.get_coordinates(part[out]))
            room = min(room, -float(shapely.distance(corners, workspace).max()))
        elif room > 0:
            room = min(room, float(shapely.distance(part, boundary).min()))
    return room


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
