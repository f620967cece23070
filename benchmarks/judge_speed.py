"""How long the judge takes, compiled and in NumPy, on the paper's scenes and among many obstacles.

Run as ``python -m benchmarks.judge_speed``. Both judge the same motions in the same process, turn by turn; times are
processor time of the thread, the smallest of several. The table is in docs/certification.md.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from unittest.mock import patch

import numpy as np

import tightspot
from benchmarks.report import machine
from tightspot.geometry import ConvexPolygon
from tightspot.scenarios import Obstacle, Scenario
from tightspot.trajectory import Trajectory
from tightspot.vehicles import SingleTrack
from tightspot.verification import Certificate, compiled, replay, verify

SCENES = ("vertical", "parallel", "oblique")
CROWDS = (10, 100, 1_000, 10_000)
ROOM = (100.0, 40.0)
FREE = 5.0
INTERVALS, SECONDS = 120, 60.0


def seconds_of(judge: Callable[[], Certificate], repeats: int) -> tuple[float, Certificate]:
    """Smallest time of the repeats, s, and the certificate."""
    best = np.inf
    for _ in range(repeats):
        started = time.thread_time()
        certificate = judge()
        best = min(best, time.thread_time() - started)
    return best, certificate


def drive(car: SingleTrack) -> Trajectory:
    """Along the room in a gentle wriggle, a minute long."""
    t = np.linspace(0, SECONDS, INTERVALS + 1)
    steering = 0.06 * np.diff(np.sin(2 * np.pi * t / SECONDS * 3)) / np.diff(t)
    inputs = np.column_stack([np.where(t[:-1] < 2, 0.6, 0.0), steering])
    states = np.zeros((t.size, car.n_states))
    states[0, :2] = 5.0, 0.5 * ROOM[1]
    return Trajectory(t, replay(car, Trajectory(t, states, inputs)).knots, inputs)


def crowd(count: int, trajectory: Trajectory, rng: np.random.Generator) -> Scenario:
    """So many polygons of 3 to 6 corners in the room, their centres ``FREE`` metres from the path or farther."""
    size, path = 0.6 * min(1.0, (1000 / count) ** 0.5), trajectory.states[:, :2]
    obstacles: list[Obstacle] = []
    while len(obstacles) < count:
        centre = rng.uniform((0, 0), ROOM)
        if np.hypot(*(path - centre).T).min() < FREE:
            continue
        angles = rng.uniform(0, 6) + np.linspace(0, 2 * np.pi, int(rng.integers(3, 7)), endpoint=False)
        ring = centre + 0.3 * size * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        obstacles.append(Obstacle(f"o{len(obstacles)}", ring))
    around = ConvexPolygon.rectangle(-20, ROOM[0] + 20, -20, ROOM[1] + 20)
    ends = {"start": trajectory.states[0], "goal": trajectory.states[-1]}
    return Scenario(name=f"{count} obstacles", workspace=around, obstacles=tuple(obstacles), **ends)


def cases() -> Iterator[tuple[str, Scenario, SingleTrack, Trajectory]]:
    """What is judged."""
    for name in SCENES:
        plan = tightspot.plan(name)
        assert isinstance(plan.vehicle, SingleTrack)
        yield name, plan.scenario, plan.vehicle, plan.trajectory
    car = tightspot.vehicle("paper")
    trajectory, rng = drive(car), np.random.default_rng(1)
    for count in CROWDS:
        scenario = crowd(count, trajectory, rng)
        yield scenario.name, scenario, car, trajectory


def main() -> None:
    """Print the table."""
    where = machine()
    lines = ["| scene | pairs | lines | compiled, ms | NumPy, ms | ratio |", "|---|---|---|---|---|---|"]
    for name, scenario, car, trajectory in cases():

        def judge(arguments: tuple[Scenario, SingleTrack, Trajectory] = (scenario, car, trajectory)) -> Certificate:
            return verify(*arguments, margin=0.05)

        repeats = 30 if len(scenario.obstacle_parts) < 1000 else 5
        quick, certificate = seconds_of(judge, repeats)
        with patch.object(compiled, "is_compiled", lambda vehicle: False):
            slow, other = seconds_of(judge, max(2, repeats // 5))
        if (certificate.certified, certificate.intervals) != (other.certified, other.intervals):
            raise SystemExit(f"{name}: the two judges disagree")
        pairs = len(scenario.obstacle_parts) * len(car.parts)
        ratio = f"{1e3 * quick:.2f} | {1e3 * slow:.1f} | {slow / quick:.0f}"
        lines.append(f"| {name} | {pairs} | {certificate.intervals} | {ratio} |")
    sys.stdout.write("\n".join([*lines, "", str(where), ""]))


if __name__ == "__main__":
    main()
