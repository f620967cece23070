"""Planning again and again in a scene that changes little: from the last plan, if that leads to a certified one."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from tightspot.errors import BlockedError, InputError, Problem
from tightspot.formulations import Formulation
from tightspot.guesses import Guess, GuessResult
from tightspot.planner.changes import Changes, changes_between
from tightspot.planner.explain import SECONDS
from tightspot.planner.pipeline import known_effort, plan_request, report_of, resolve_or_explain
from tightspot.planner.portfolio import Course, Member
from tightspot.planner.progress import ProgressCallback, unheard
from tightspot.planner.request import Request, resolve
from tightspot.planner.rounds import Round
from tightspot.planner.warm import KeptCore, warm_rounds
from tightspot.scenarios import Obstacle, Scenario, check, load
from tightspot.solvers import Solver
from tightspot.transcription import Objective
from tightspot.vehicles import VehicleModel
from tightspot.verification import Plan

GROWN = 1.5
"""A mesh that was refined to more than this many times the intervals of the last cold plan is given up."""


class Planner:
    """Plans in one scene whose start, goal or obstacles move a little from plan to plan.

    The arguments are those of :func:`tightspot.plan`. The first plan is made as there. Each further one starts from the
    last: its mesh, trajectory, separating lines and multipliers. The judge certifies it like any other; if he does not,
    or if too much has changed, the plan is made anew. ``plan.report["warm"]`` says which, and why.

    A warm plan stays in the last plan's valley: the same way round the obstacles, the same gear changes. What
    ``effort`` says holds for plans that are made anew. One planner serves one thread.

    Attributes:
        scenario: Of the last plan; before the first one the given scenario.

    Raises:
        InputError: If an argument makes no sense. That start or goal are blocked is for :meth:`plan` to say, for they
            may be replaced there.

    >>> planner = Planner("vertical")
    >>> first = planner.plan()
    >>> second = planner.plan(start=first.scenario.start + [0.1, 0.0, 0.03, 0.0, 0.0])
    >>> second.report["warm"]["used"]
    True
    """

    def __init__(
        self,
        scenario: Scenario | str | Path,
        *,
        vehicle: VehicleModel | str | Path | None = None,
        objective: Objective | None = None,
        formulation: Formulation | str | None = None,
        guess: Guess | str | None = None,
        solver: Solver | str | None = None,
        steps: int | None = None,
        margin: float | None = None,
        refinements: int = 8,
        time_limit: float = 60.0,
        effort: str = "balanced",
        seed: int = 0,
        explain: bool = False,
        progress: ProgressCallback | None = None,
    ) -> None:
        self.scenario = scenario if isinstance(scenario, Scenario) else load(scenario)
        self._vehicle = vehicle
        self._arguments = objective, formulation, guess, solver, steps, margin, refinements, time_limit
        self._effort, self._seed = known_effort(effort), seed
        self._seconds = SECONDS if explain else None
        self._tell: ProgressCallback = progress or unheard
        self._last: tuple[Request, Round] | None = None
        self._cold_steps = 0
        self._core = KeptCore()
        with suppress(BlockedError):
            self._resolved(self.scenario)

    def plan(
        self,
        *,
        start: ArrayLike | None = None,
        goal: ArrayLike | None = None,
        obstacles: Sequence[Obstacle] | None = None,
    ) -> Plan:
        """A certified plan with another start, goal or obstacles; what is not given stays as in the last plan.

        Args:
            start: (x, y, theta, v, delta) in the scenario's coordinates, m, rad, m/s; NaN in v or delta: free;
                (x, y, theta) alone: at rest with straight wheels.
            goal: The same at the end.
            obstacles: All obstacles, in place of the present ones; moved ones in the same order.

        Raises:
            BlockedError: See :func:`tightspot.plan`; also below. After any of them the last plan stays the last.
            InputError: See there.
            PlanningError: See there.
        """
        started = time.perf_counter()
        scene = self._changed(start, goal, obstacles)
        made = self._warm(scene, started)
        if isinstance(made, str):
            request = resolve_or_explain(scene, self._vehicle, self._resolved, self._tell, self._seconds)
            made = self._cold(request, started, made)
        plan, request, last = made
        self.scenario, self._last = plan.scenario, (request, last)
        return plan

    @property
    def last_round(self) -> Round | None:
        """What the last plan is of: mesh, solver's report, multipliers; ``None`` before the first one."""
        return self._last[1] if self._last else None

    def _resolved(self, scene: Scenario) -> Request:
        if self._last is None:
            return resolve(scene, self._vehicle, *self._arguments)
        known, _ = self._last
        check(scene, known.vehicle, known.margin)
        return replace(known, scenario=scene)

    def _changed(
        self, start: ArrayLike | None, goal: ArrayLike | None, obstacles: Sequence[Obstacle] | None
    ) -> Scenario:
        changed: dict[str, Any] = {
            name: value for name, value in (("start", start), ("goal", goal)) if value is not None
        }
        if obstacles is not None:
            changed["obstacles"] = _obstacles(obstacles)
        if not changed:
            return self.scenario
        originals = {name: value for name, value in self.scenario.originals.items() if name not in changed}
        return self.scenario.with_(**changed, originals=originals)

    def _warm(self, scene: Scenario, started: float) -> tuple[Plan, Request, Round] | str:
        """From the last plan; or why not. Start and goal are not checked before: a certified plan is free there."""
        if self._last is None:
            return "it is the first plan"
        old, last = self._last
        request = replace(old, scenario=scene)
        changes = changes_between(old, request)
        if isinstance(changes, str):
            return changes
        steps = last.mesh.grid.steps
        if steps > GROWN * self._cold_steps:
            return f"the mesh has grown from {self._cold_steps} to {steps} intervals"
        until = started + request.time_limit
        rounds = warm_rounds(request, last, self._core, self._tell, until)
        final = rounds[-1]
        if not final.solved:
            return f"from the last plan the solver failed ({final.report.status.sentence})"
        if not final.certified:
            return "what came of the last plan was not certified"
        return self._finished(request, rounds, changes, started), request, final

    def _finished(self, request: Request, rounds: list[Round], changes: Changes, started: float) -> Plan:
        seconds = time.perf_counter() - started
        found = GuessResult(rounds[0].step.start, "the last plan's trajectory")
        course = Course(Member("last plan", request.guess), found, rounds, 0.0, seconds)
        final = rounds[-1]
        assert final.certificate is not None
        warm = {"warm": {"used": True, "reason": "started from the last plan", "moved": changes.to_dict()}}
        report = report_of(request, [course], seconds) | warm
        return Plan(request.scenario, request.vehicle, final.trajectory, final.certificate, report)

    def _cold(self, request: Request, started: float, reason: str) -> tuple[Plan, Request, Round]:
        plan, last = plan_request(request, self._effort, self._tell, started, self._seed, self._seconds)
        self._cold_steps = last.mesh.grid.steps
        self._core.keep(last)
        return replace(plan, report=dict(plan.report) | {"warm": {"used": False, "reason": reason}}), request, last


def _obstacles(given: Sequence[Obstacle]) -> tuple[Obstacle, ...]:
    """Raises :class:`InputError` if one of them is none."""
    if not isinstance(given, Sequence):
        raise InputError(Problem("obstacles", f"{type(given).__name__} is not a list of tightspot.scenarios.Obstacle"))
    problems = [
        Problem(f"obstacles[{index}]", f"{type(item).__name__} is not a tightspot.scenarios.Obstacle")
        for index, item in enumerate(given)
        if not isinstance(item, Obstacle)
    ]
    if problems:
        raise InputError(problems)
    return tuple(given)
