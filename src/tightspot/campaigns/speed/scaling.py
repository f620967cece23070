"""Time and memory against steps, obstacles and vertices, about the scene ``vertical``."""

from __future__ import annotations

import ctypes
import dataclasses
import math
import time
import tracemalloc
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tightspot.campaigns.speed.cases import (
    ENERGY_AND_TIME,
    GAP,
    STEPS,
    Start,
    by_the_paper,
    car,
    median_seconds,
    settings_for,
    slope,
    starts,
)
from tightspot.errors import PlanningError
from tightspot.geometry import ConvexPolygon
from tightspot.planner import plan
from tightspot.scenarios import Obstacle, Scenario
from tightspot.scenarios.library import builtin
from tightspot.solvers import Stagewise
from tightspot.solvers.stage_core import core_solver
from tightspot.solvers.stage_problem import StageProblem
from tightspot.transcription import TimeGrid, stage_problem, transcribe

REPEATS = 5
LATTICE = 32
"""Obstacles in a row, of a thousand; of more the row is longer."""

ROUNDING = 0.3
"""Radius of the corners of obstacles with more than four vertices, m."""

Row = dict[str, Any]


def over_steps(counts: Sequence[int], ipopt_up_to: int, tell: Callable[[str], None]) -> dict[str, Any]:
    """The solve alone, on ever finer meshes."""
    (start,) = starts("vertical", 1, 0)
    rows: list[Row] = []
    for count in counts:
        tell(f"{count} steps")
        rows.append({"steps": count, **_solve(start, count, with_ipopt=count <= ipopt_up_to)})
    return {"rows": rows, "slopes": _slopes(rows, "steps")}


def over_vertices(counts: Sequence[int], tell: Callable[[str], None]) -> dict[str, Any]:
    """The solve alone, with the obstacles' corners rounded by ever more vertices."""
    (start,) = starts("vertical", 1, 0)
    rows: list[Row] = []
    for count in counts:
        tell(f"{count} vertices")
        obstacles = tuple(
            Obstacle(obstacle.name, rounded(np.asarray(obstacle.exterior, float), count))
            for obstacle in start.scenario.obstacles
        )
        scenario = dataclasses.replace(start.scenario, obstacles=obstacles)
        rows.append({"vertices": count, **_solve(Start(scenario, start.guess), STEPS, with_ipopt=True)})
    return {"rows": rows, "slopes": _slopes(rows, "vertices")}


def over_obstacles(
    counts: Sequence[int], ipopt_up_to: int, repeats: int, tell: Callable[[str], None]
) -> dict[str, Any]:
    """The whole plan, and the solve alone with all obstacles in the program."""
    (start,) = starts("vertical", 1, 0)
    rows: list[Row] = []
    for count in counts:
        tell(f"{count} obstacles")
        scenario = crowded(count)
        row = {
            "obstacles": count,
            **_solve(Start(scenario, start.guess), STEPS, with_ipopt=count <= ipopt_up_to),
        }
        times, certified = [], 0
        for _ in range(repeats + 1):
            began = time.process_time()
            try:
                plan(scenario, vehicle=car())
                certified += 1
            except PlanningError:
                pass
            times.append(time.process_time() - began)
        row |= {"plan_seconds": float(np.median(times[1:])), "plan_megabytes": _planning_megabytes(scenario)}
        row |= {"scene_seconds": median_seconds(partial(made_anew, scenario), repeats)}
        rows.append(row | {"certified": certified == repeats + 1})
    few = next((row for row in rows if row["obstacles"] >= 10), rows[0])
    grown = rows[-1]["plan_seconds"] / few["plan_seconds"]
    memory = rows[-1]["plan_megabytes"] / few["plan_megabytes"]
    return {
        "rows": rows,
        "slopes": _slopes([row for row in rows if row["obstacles"] >= 10], "obstacles"),
        "plan_growth": {
            "from": few["obstacles"],
            "to": rows[-1]["obstacles"],
            "times": grown,
            "times_memory": memory,
        },
    }


def crowded(count: int) -> Scenario:
    """The scene ``vertical`` in a wide workspace (150 m for up to a thousand obstacles), with its two obstacles, a wall
    where its own workspace ends, and further obstacles on a lattice beyond."""
    base = builtin("vertical")
    side = max(LATTICE, math.isqrt(max(count - 1, 0)) + 1)
    width = 4.0 * side + 4.0
    extra = []
    for index in range(count - 2):
        x, y = 20.0 + 4.0 * (index % side), -8.0 + 4.0 * (index // side)
        corners = np.array([(x, y), (x + 2.0, y), (x + 2.0, y + 2.0), (x, y + 2.0)])
        extra.append(Obstacle(f"far {index}", corners))
    workspace = ConvexPolygon.rectangle(-2.0, 20.0 + width, -8.0, 8.0 + width)
    wall = Obstacle("wall", np.array([(15.0, -8.0), (16.0, -8.0), (16.0, 8.0), (15.0, 8.0)]))
    obstacles = (*base.obstacles[:2], *([wall] if count > 2 else []), *extra)[:count]
    return dataclasses.replace(base, name=f"vertical with {count}", workspace=workspace, obstacles=obstacles)


def made_anew(scenario: Scenario) -> Scenario:
    """The same scene from its corners, with all that a planner wants to know of the obstacles."""
    obstacles = tuple(Obstacle(obstacle.name, obstacle.exterior) for obstacle in scenario.obstacles)
    scene = dataclasses.replace(scenario, obstacles=obstacles)
    scene.obstacle_polygons.box_distances(scene.start[None, :2])
    return scene


def _planning_megabytes(scenario: Scenario) -> float:
    """Largest memory that Python and NumPy have in use while a plan is made beyond what they had before, 10^6 bytes."""
    tracemalloc.start()
    try:
        plan(scenario, vehicle=car())
        return tracemalloc.get_traced_memory()[1] / 1e6
    except PlanningError:
        return float("nan")
    finally:
        tracemalloc.stop()


def rounded(corners: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """A rectangle with ``count`` vertices: its corners are arcs of ``count / 4`` each."""
    if count == 4:
        return corners
    low, high = corners.min(axis=0), corners.max(axis=0)
    centres = [(high[0], high[1], 0.0), (low[0], high[1], 0.25), (low[0], low[1], 0.5), (high[0], low[1], 0.75)]
    points = []
    for x, y, turn in centres:
        angles = 2 * np.pi * (turn + 0.25 * np.linspace(0.0, 1.0, count // 4 + 2)[1:-1])
        inward = np.sign(np.array([(low[0] + high[0]) / 2 - x, (low[1] + high[1]) / 2 - y])) * ROUNDING
        points.append(np.array([x, y]) + inward + ROUNDING * np.column_stack([np.cos(angles), np.sin(angles)]))
    return np.vstack(points)


def _solve(start: Start, steps: int, *, with_ipopt: bool) -> Row:
    settings, grid, vehicle = settings_for(ENERGY_AND_TIME), TimeGrid.uniform(steps), car()
    problem = stage_problem(start.scenario, vehicle, start.guess, settings, grid=grid)
    core, options = core_solver(problem), Stagewise().options()

    def once() -> None:
        core.set(problem.starting_point())
        core.solve(options)

    seconds = median_seconds(once, REPEATS)
    report = Stagewise().solve_stages(problem)
    row: Row = {
        "seconds": seconds,
        "iterations": report.iterations,
        "seconds_per_iteration": seconds / max(report.iterations, 1),
        "success": report.status.success,
        "megabytes": _megabytes(problem),
    }
    if with_ipopt:
        theirs = by_the_paper(transcribe(start.scenario, vehicle, start.guess, settings, grid=grid).nlp)
        row |= {"ipopt_seconds": theirs.seconds, "ipopt_iterations": theirs.report.iterations}
        row |= {"ipopt_success": theirs.report.status.success, "ratio": theirs.seconds / seconds}
    return row


def _slopes(rows: Sequence[Row], what: str) -> dict[str, float | None]:
    """Of time an iteration and of memory, on logarithmic scales; 1 is linear."""
    found: dict[str, float | None] = {}
    for name in ("seconds_per_iteration", "seconds", "megabytes"):
        usable = [(row[what], row[name]) for row in rows if row[name]]
        found[name] = slope(*zip(*usable, strict=True)) if len(usable) > 1 else None
    return found


def _megabytes(problem: StageProblem) -> float | None:
    """Memory of one solver of the problem, 10^6 bytes; ``None`` where the system does not tell."""
    before = _allocated()
    core = core_solver(problem)
    core.set(problem.starting_point())
    after = _allocated()
    return None if before is None or after is None else max(0, after - before) / 1e6


class _Mallinfo(ctypes.Structure):
    """``struct mallinfo2`` of the GNU C library."""

    _names = "arena ordblks smblks hblks hblkhd usmblks fsmblks uordblks fordblks keepcost"
    _fields_ = tuple((name, ctypes.c_size_t) for name in _names.split())


def _allocated() -> int | None:
    """Bytes that compiled code has in use, where the C library tells (glibc 2.33 and later)."""
    try:
        mallinfo = ctypes.CDLL(None).mallinfo2
    except (AttributeError, OSError, TypeError):
        return None
    mallinfo.restype = _Mallinfo
    found = mallinfo()
    return int(found.uordblks + found.hblkhd)


__all__ = ["GAP", "crowded", "over_obstacles", "over_steps", "over_vertices", "rounded"]
