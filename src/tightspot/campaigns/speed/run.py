"""Everything measured, one after the other, in one process."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from itertools import zip_longest
from typing import Any

from tightspot.campaigns.report import Machine
from tightspot.campaigns.speed.cases import ENERGY_AND_TIME, MARGIN, SCENES, TIME_OPTIMAL, Start, scenes_about, starts
from tightspot.campaigns.speed.headline import headline
from tightspot.campaigns.speed.infeasible import infeasible, infeasible_summary
from tightspot.campaigns.speed.plans import compare_plans, plan_summary, ratios
from tightspot.campaigns.speed.scaling import over_obstacles, over_steps, over_vertices
from tightspot.campaigns.speed.solves import Case, best_known, compare_all, straight, summary
from tightspot.campaigns.speed.throughput import batch, best_of_many, warm, warm_plans
from tightspot.errors import InputError, Problem
from tightspot.solvers import Stagewise

WEIGHTS = {"energy and time": ENERGY_AND_TIME, "time-optimal": TIME_OPTIMAL}
FORMAT = "tightspot-speed/1"
COUNTS = ("starts", "straight", "plans", "infeasible", "batch", "runs")


@dataclass(frozen=True)
class SpeedPlan:
    """How much is measured.

    Attributes:
        starts: Starts a scene, for solves.
        straight: Of these, from straight-line guesses, too.
        plans: Starts a scene, for whole plans.
        infeasible: Starts of all scenes together whose programs are made infeasible.
        batch: Problems in the batch.
        runs: Seeds a scene for the best of many.
        steps: Numbers of intervals of the scaling table.
        obstacles: Numbers of obstacles.
        vertices: Numbers of vertices an obstacle, multiples of 4.
        ipopt_steps: IPOPT solves meshes of up to so many intervals.
        ipopt_obstacles: IPOPT solves programs of up to so many obstacles.
        seed: Of the starts.
    """

    starts: int = 100
    straight: int = 100
    plans: int = 100
    infeasible: int = 30
    batch: int = 100
    runs: int = 100
    steps: tuple[int, ...] = (20, 40, 80, 160, 320, 640)
    obstacles: tuple[int, ...] = (2, 10, 30, 100, 300, 1000)
    vertices: tuple[int, ...] = (4, 8, 16, 32, 64)
    ipopt_steps: int = 320
    ipopt_obstacles: int = 30
    seed: int = 0

    def __post_init__(self) -> None:
        counts = {name: getattr(self, name) for name in COUNTS}
        problems = [Problem(name, f"{count} must be at least 1") for name, count in counts.items() if count < 1]
        if self.seed < 0:
            problems.append(Problem("seed", f"{self.seed} must not be negative"))
        if problems:
            raise InputError(problems)


FULL = SpeedPlan()
QUICK = SpeedPlan(
    starts=3, straight=1, plans=2, infeasible=1, batch=10, runs=2,
    steps=(20, 80, 320), obstacles=(2, 10, 100, 1000), vertices=(4, 16, 64), ipopt_steps=20, ipopt_obstacles=2,
)  # fmt: skip


def run_speed(plan: SpeedPlan = FULL, *, progress: Callable[[str], None] | None = None) -> dict[str, Any]:
    """Measure, and put the figures together as plain data.

    Args:
        plan: How much.
        progress: Called with what is measured next; what it raises ends the run.

    Returns:
        The headline figures (``solve_ratio``, ``plan_ratio``, ``success``, ``solves_per_second`` and others, see
        docs/speed.md), the machine, and under ``solves``, ``straight_lines``, ``plans``, ``scaling``, ``warm``,
        ``warm_plans``, ``batch`` and ``best_of_many`` what they come from.
    """
    began = time.perf_counter()
    tell = progress or (lambda news: None)
    given = {scene: _told(starts(scene, plan.starts, plan.seed), scene, tell) for scene in SCENES}
    known = {scene: _known(given[scene], scene, tell) for scene in SCENES}
    solves = {
        name: {
            scene: compare_all(given[scene], weight, [best[index] for best in known[scene]], tell) for scene in SCENES
        }
        for index, (name, weight) in enumerate(WEIGHTS.items())
    }
    lines = {}
    for scene in SCENES:
        bests = [case["best"] for case in solves["energy and time"][scene][: plan.straight]]
        guesses = [straight(start) for start in given[scene][: plan.straight]]
        lines[scene] = compare_all(guesses, ENERGY_AND_TIME, bests, tell)
    plans = {scene: compare_plans(scene, plan.plans, plan.seed, tell) for scene in SCENES}
    mixed = [start for same in zip_longest(*given.values()) for start in same if start is not None]
    impossible = infeasible(mixed[: plan.infeasible], tell)
    vertical = (given["vertical"] * -(-plan.batch // len(given["vertical"])))[: plan.batch]
    result: dict[str, Any] = {
        "solves": {name: with_all(cases) for name, cases in solves.items()},
        "straight_lines": with_all(lines),
        "plans": {scene: plan_summary(cases) for scene, cases in plans.items()}
        | {"all": plan_summary([case for cases in plans.values() for case in cases])},
        "infeasible": infeasible_summary(impossible),
        "warm_plans": {
            scene: warm_plans(list(scenes_about(scene, plan.plans, plan.seed, MARGIN)), plan.seed, tell)
            for scene in SCENES
        },
        "warm": {scene: warm(given[scene][: plan.plans], plan.seed, tell) for scene in SCENES},
        "batch": batch(vertical, tell),
        "best_of_many": best_of_many(plan.runs, plan.seed, tell),
        "scaling": {
            "steps": over_steps(plan.steps, plan.ipopt_steps, tell),
            "obstacles": over_obstacles(plan.obstacles, plan.ipopt_obstacles, 3, tell),
            "vertices": over_vertices(plan.vertices, tell),
        },
        "cases": {
            "solves": {name: _distributions(cases) for name, cases in solves.items()},
            "straight_lines": _distributions(lines),
            "plans": {scene: _plan_distributions(cases) for scene, cases in plans.items()},
            "infeasible": impossible,
        },
    }
    machine = Machine.here()
    conditions = {
        "format": FORMAT,
        "machine": {**asdict(machine), "versions": dict(machine.versions)},
        "plan": asdict(plan),
        "solver": Stagewise.name,
        "seconds": time.perf_counter() - began,
    }
    return {name: _plain(value) for name, value in {**headline(result), **conditions, **result}.items()}


def _plain(value: Any) -> Any:
    """The same with ``None`` for numbers that are not finite (a failed solve's J), which JSON does not have."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _known(starts: Sequence[Start], scene: str, tell: Callable[[str], None]) -> list[tuple[float, ...]]:
    """The best J known of each start, for each of :data:`WEIGHTS`."""
    found = []
    for number, start in enumerate(starts):
        tell(f"best J of {scene}, start {number + 1} of {len(starts)}")
        found.append(best_known(start, tuple(WEIGHTS.values())))
    return found


def _told(found: Iterable[Start], scene: str, tell: Callable[[str], None]) -> list[Start]:
    """All of them, each told as it is found."""
    tell(f"starts of {scene}")
    given = []
    for start in found:
        given.append(start)
        tell(f"starts of {scene}, {len(given)} found")
    return given


def with_all(cases: dict[str, list[Case]]) -> dict[str, Any]:
    """The summary of each scene and of all together."""
    everything = [case for some in cases.values() for case in some]
    return {scene: summary(some) for scene, some in cases.items()} | {"all": summary(everything)}


def _distributions(cases: dict[str, list[Case]]) -> dict[str, Any]:
    """Of each scene what the figures draw."""
    names = ("seconds", "ipopt_seconds", "objective", "ipopt_objective", "best", "success", "ipopt_success")
    return {scene: {name: [case[name] for case in some] for name in names} for scene, some in cases.items()}


def _plan_distributions(cases: Sequence[dict[str, Any]]) -> dict[str, list[float]]:
    """Seconds of each plan or failure, and the ratios of those cases that both sides solve."""
    both = [case for case in cases if case["success"] and case["ipopt_success"]]
    return {"seconds": [case["seconds"] for case in cases]} | {
        name: values.tolist() for name, values in ratios(both).items()
    }
