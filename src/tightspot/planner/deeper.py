"""The costlier analysis of a failure: other guesses, the largest margin and the largest body width that pass."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from tightspot.errors import VehicleError
from tightspot.formulations import SweptLine
from tightspot.planner.attempts import Attempts, Start, least_penetration
from tightspot.planner.passing import Deeper, Passing, Verdict, largest
from tightspot.planner.penetration import Penetration
from tightspot.planner.progress import Progress, ProgressCallback
from tightspot.planner.request import Request, solvers_for
from tightspot.scenarios.bottleneck import is_closed
from tightspot.scenarios.remedies import NARROWEST, bisected
from tightspot.vehicles import body_width, narrowed

MARGIN_ACCURACY = 0.005
WIDTH_ACCURACY = 0.01
PATIENCE_AS_IT_IS = 12.0
FEW_PAIRS = 4


def deeper_analysis(
    request: Request, starts: list[Start], tell: ProgressCallback, deadline: float
) -> tuple[Deeper, Penetration | None]:
    """First the scene as it is from other starts; if that fails, the least penetration, less margin, less width.

    The attempts are made with the planner's default formulation, solver and number of steps, whatever failed: the
    question is what the scene and the vehicle allow.

    Args:
        request: What failed.
        starts: Trajectories that may collide.
        tell: Told what is tried and what came of it.
        deadline: By the clock of :func:`time.perf_counter`, s. The margin may take half of what is left.
    """
    began = time.perf_counter()
    changes = differences(request)
    request = with_defaults(request)
    attempts = Attempts(request, starts, tell, deadline)
    tell(Progress("explain", "the scene as it is, from other guesses"))
    if attempts.verdict(request, PATIENCE_AS_IT_IS) == "passes" and attempts.found is not None:
        name, trajectory = attempts.found
        spent = time.perf_counter() - began
        return Deeper(other_start=name, changes=changes, trajectory=trajectory, seconds=spent), None
    tell(Progress("explain", "the trajectory that penetrates least"))
    least = least_penetration(request, starts, deadline)
    if least is not None:
        attempts.starts = [Start("minimum penetration", least.trajectory), *starts]
    attempts.deadline = (time.perf_counter() + deadline) / 2
    margin = _largest_margin(request, attempts)
    attempts.found, attempts.deadline = None, deadline
    width = _largest_width(request, attempts)
    return Deeper(margin=margin, width=width, seconds=time.perf_counter() - began), least


def with_defaults(request: Request) -> Request:
    """The request with the planner's own formulation, solvers and number of steps.

    Among many pairs there is no fall-back: the nonlinear program alone would take longer to build than there is time.
    """
    solver, fallbacks = solvers_for(None, request.vehicle, SweptLine())
    if len(request.vehicle.parts) * len(request.scenario.obstacle_parts) > FEW_PAIRS:
        fallbacks = ()
    return replace(request, formulation=SweptLine(), solver=solver, fallbacks=fallbacks, steps=None)


def differences(request: Request) -> tuple[str, ...]:
    """What :func:`with_defaults` changes, for people."""
    usual = with_defaults(request).solver
    found = []
    if request.formulation.name != SweptLine.name:
        found.append(f"the formulation {SweptLine.name} instead of {request.formulation.name}")
    if request.solver.with_time_limit(1.0) != usual.with_time_limit(1.0):
        found.append(f"the solver {usual.name} with its usual limits")
    if request.steps is not None:
        found.append(f"as many steps as suit the guess instead of {request.steps}")
    return tuple(found)


def _largest_margin(request: Request, attempts: Attempts) -> Passing | None:
    """``None`` if none is demanded anyway."""
    if request.margin <= 0:
        return None

    def closed(margin: float) -> bool:
        return is_closed(request.scenario, request.vehicle, margin)

    def attempt(margin: float) -> Verdict:
        return _told(attempts, f"a margin of {margin:g} m", replace(request, margin=margin))

    bound = _smallest_impossible(closed, 0.0, request.margin)
    return largest("margin", request.margin, 0.0, MARGIN_ACCURACY, attempt, bound)


def _largest_width(request: Request, attempts: Attempts) -> Passing | None:
    """``None`` if the vehicle's model has no body that can be made narrower."""
    now = body_width(request.vehicle)
    least = round(NARROWEST * now, 3)

    def of_width(width: float) -> Request:
        return replace(request, vehicle=narrowed(request.vehicle, width / now))

    def closed(width: float) -> bool:
        return is_closed(request.scenario, of_width(width).vehicle, request.margin)

    def attempt(width: float) -> Verdict:
        return _told(attempts, f"a body {width:.3f} m wide", of_width(width))

    try:
        bound = _smallest_impossible(closed, least, now)
    except VehicleError:
        return None
    return largest("width", now, least, WIDTH_ACCURACY, attempt, bound)


def _smallest_impossible(closed: Callable[[float], bool], least: float, now: float) -> float | None:
    """The smallest value in whole mm for which the way is proved closed, m; ``None`` if that is not even ``now``."""
    if not closed(now):
        return None
    if closed(least):
        return least
    low, high = round(1000 * least), int(np.ceil(1000 * now))
    return min(now, (bisected(lambda value: not closed(value / 1000), low, high) + 1) / 1000)


def _told(attempts: Attempts, what: str, request: Request) -> Verdict:
    attempts.tell(Progress("explain", what))
    verdict = attempts.verdict(request)
    words = {"passes": "passes", "fails": "does not pass", "impossible": "cannot pass", "no time": "was not decided"}
    attempts.tell(Progress("explain", f"{what} {words[verdict]}"))
    return verdict
