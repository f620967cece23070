"""Programs that no trajectory satisfies: how soon the stagewise solver says so, and how soon IPOPT does."""

from __future__ import annotations

import dataclasses
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from tightspot.campaigns.speed.cases import (
    ENERGY_AND_TIME,
    STEPS,
    Start,
    by_the_paper,
    car,
    quantiles,
    settings_for,
)
from tightspot.geometry import transform
from tightspot.scenarios import Obstacle, Scenario
from tightspot.solvers import Stagewise
from tightspot.transcription import Settings, TimeGrid, stage_problem, transcribe

BLOCK = 0.6
"""Side of the block in the slot, m."""

TOO_NARROW = 0.1
"""By how much the gap about the goal is narrower than the vehicle, m."""

FREE, THICK = 0.3, 1.0
"""Distance and thickness of the walls around the start, m."""

SHORTEST = 0.1
"""t_f, s."""

SOON = 30.0
"""Longest t_f of the boxed-in, s: so short that no interval is long enough to jump over a wall."""

HURRY = 0.8
"""t_f over the time that the distance takes at full speed."""


class Impossible(NamedTuple):
    """A scene and settings with no solution, with the guess of the scene that has one."""

    start: Start
    settings: Settings


def infeasible(starts: Sequence[Start], tell: Callable[[str], None]) -> list[dict[str, Any]]:
    """One case a start and kind: seconds and status of both."""
    cases = []
    for number, start in enumerate(starts):
        for kind, given in impossible(start):
            tell(f"{start.scenario.name}, {kind}, start {number + 1} of {len(starts)}")
            cases.append({"scene": start.scenario.name, "kind": kind, **_compare(given)})
    return cases


def impossible(start: Start) -> Iterator[tuple[str, Impossible]]:
    """The start's program spoiled in each way."""
    scenario, vehicle, settings = start.scenario, car(), settings_for(ENERGY_AND_TIME)
    low, high = (bound(vehicle.parts[0].polygon.vertices, axis=0) for bound in (np.min, np.max))
    middle = (low + high) / 2
    block = (*(middle - BLOCK / 2), *(middle + BLOCK / 2))
    yield "block in the slot", Impossible(_with(start, scenario.goal, [block]), settings)
    into = TOO_NARROW / 2
    sides = [(low[0], low[1] - THICK, high[0], low[1] + into), (low[0], high[1] - into, high[0], high[1] + THICK)]
    yield "goal in too narrow a gap", Impossible(_with(start, scenario.goal, sides), settings)
    inner, outer = (low - FREE, high + FREE), (low - FREE - THICK, high + FREE + THICK)
    walls = [
        (*outer[0], inner[0][0], outer[1][1]),
        (inner[1][0], outer[0][1], *outer[1]),
        (inner[0][0], outer[0][1], inner[1][0], inner[0][1]),
        (inner[0][0], inner[1][1], inner[1][0], outer[1][1]),
    ]
    boxed = dataclasses.replace(settings, final_time=(SHORTEST, SOON))
    yield "walls around the start", Impossible(_with(start, scenario.start, walls), boxed)
    fastest = max(abs(bound) for bound in vehicle.limits.speed)
    seconds = HURRY * float(np.hypot(*(scenario.goal - scenario.start)[:2])) / fastest
    hurried = dataclasses.replace(settings, final_time=(SHORTEST, seconds))
    yield "too little time", Impossible(start, hurried)


def _with(start: Start, state: ArrayLike, boxes: Sequence[Sequence[float]]) -> Start:
    """The start's scene with more obstacles: rectangles (x, y, x, y) in the frame of the vehicle in that state."""
    more = []
    for index, (left, bottom, right, top) in enumerate(boxes):
        corners = np.array([(left, bottom), (right, bottom), (right, top), (left, top)], float)
        more.append(Obstacle(f"more {index}", transform(corners, np.asarray(state, float)[:3])))
    scenario: Scenario = dataclasses.replace(start.scenario, obstacles=(*start.scenario.obstacles, *more))
    return start._replace(scenario=scenario)


def _compare(given: Impossible) -> dict[str, Any]:
    (scenario, guess), settings = given
    grid, vehicle = TimeGrid.uniform(STEPS), car()
    problem = stage_problem(scenario, vehicle, guess, settings, grid=grid)
    began = time.thread_time()
    ours = Stagewise().solve_stages(problem)
    seconds = time.thread_time() - began
    began = time.thread_time()
    Stagewise(robust=False).solve_stages(problem)
    first = time.thread_time() - began
    theirs, ipopt_seconds = by_the_paper(transcribe(scenario, vehicle, guess, settings, grid=grid).nlp)
    return {
        "seconds": seconds,
        "first_seconds": first,
        "status": ours.status.name,
        "iterations": ours.iterations,
        "starts_tried": len(ours.attempts),
        "ipopt_seconds": ipopt_seconds,
        "ipopt_status": theirs.status.name,
        "ipopt_iterations": theirs.iterations,
    }


def infeasible_summary(cases: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """By kind and of all: times, their ratio, statuses and how often each."""
    kinds = {kind: [case for case in cases if case["kind"] == kind] for kind in dict.fromkeys(c["kind"] for c in cases)}
    return {kind: _summary(some) for kind, some in {**kinds, "all": list(cases)}.items()}


def _summary(cases: Sequence[dict[str, Any]]) -> dict[str, Any]:
    seconds, theirs = (np.array([case[name] for case in cases]) for name in ("seconds", "ipopt_seconds"))
    return {
        "cases": len(cases),
        "ratio": quantiles(theirs / seconds),
        "milliseconds": quantiles(1e3 * seconds),
        "first_milliseconds": quantiles([1e3 * case["first_seconds"] for case in cases]),
        "ipopt_milliseconds": quantiles(1e3 * theirs),
        "iterations": float(np.median([case["iterations"] for case in cases])),
        "ipopt_iterations": float(np.median([case["ipopt_iterations"] for case in cases])),
        "statuses": dict(Counter(case["status"] for case in cases).most_common()),
        "ipopt_statuses": dict(Counter(case["ipopt_status"] for case in cases).most_common()),
    }
