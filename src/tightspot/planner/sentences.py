"""The sentences of an explanation: what was found, and what to change."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np

from tightspot.guesses import GuessResult
from tightspot.planner.passing import Deeper
from tightspot.planner.penetration import Contact, Penetration
from tightspot.planner.reach import Reach
from tightspot.planner.request import Request
from tightspot.planner.rounds import Round
from tightspot.planner.solver_stop import SolverStop
from tightspot.scenarios import Blocked
from tightspot.scenarios.bottleneck import Bottleneck
from tightspot.scenarios.clearances import clearances
from tightspot.scenarios.labels import labels
from tightspot.solvers import SolveStatus
from tightspot.verification import verify
from tightspot.verification.certificate import WORKSPACE

ASK = "--explain (in Python explain=True) finds the largest margin and the widest body that pass."

FAR = 1000.0
"""Between start and goal, m: where no path is found over more than this, the scene may be in other units."""

_AFTER_STATUS = {
    SolveStatus.ITERATION_LIMIT: "Allow the solver more iterations, or take another guess",
    SolveStatus.TIME_LIMIT: "Allow more time (--time-limit, time_limit), take fewer steps or another guess",
    SolveStatus.STOPPED: "Let the solver run on",
}


_WHOSE = re.compile(r"the vehicle's .+? (?=overlaps |is )")


def blocked_words(ends: Sequence[Blocked]) -> tuple[str, str]:
    """(what was found, what to change) when the vehicle cannot stand at the start or the goal."""
    found = [f"The vehicle cannot stand at the {end.end}: {_in_a_row(end.faults)}." for end in ends]
    remedies = [f"At the {end.end} {end.remedy}." for end in ends]
    return " ".join(found), " ".join(remedies)


def _in_a_row(faults: list[str]) -> str:
    """One after the other; who is meant is said once as long as it is the same."""
    told, before = [], ""
    for fault in faults:
        body = _WHOSE.match(fault)
        who = body[0] if body else ""
        told.append(fault[len(who) :] if who and who == before else fault)
        before = who
    return " and ".join(told)


def path_words(
    request: Request, narrow: Bottleneck | None, reach: Reach | None, deeper: Deeper | None
) -> tuple[str, str]:
    """When there is no path."""
    offset = request.scenario.offset
    came = "" if reach is None else f"; {reach.describe(offset)}"
    if narrow is not None:
        return f"There is no path: {narrow.describe(offset)}{came}.", _widen(request, narrow, deeper)
    where, found = "", "There is no path"
    if reach is not None:
        found = _search_words(reach)
        where = f"around the {reach.enclosed}" if reach.enclosed else "ahead of that pose"
    if reach is not None and reach.refused:
        end = reach.refused.split(",")[0]
        return f"{found}.", _asked(f"Move {end} some millimetres away from it.", deeper)
    other = "--guess linear, which needs no path" if request.guess.name != "linear" else "another guess"
    longer = "" if reach is None or reach.is_exhaustive else ", let the search run longer (its HybridAStarOptions)"
    apart = float(np.hypot(*(request.scenario.goal - request.scenario.start)[:2]))
    if apart > FAR and reach is not None and not reach.is_exhaustive:
        return (
            f"{found}{came}. The goal is {apart:.0f} m from the start.",
            f"Check that the scene is in metres. If it is, plan in shorter stages{longer}.",
        )
    return f"{found}{came}.", _asked(f"Make room {where}, ask for a smaller margin{longer}, or try {other}.", deeper)


def _search_words(reach: Reach) -> str:
    """How the search ended."""
    clear = f"{reach.margin:g} m of clearance"
    if reach.refused:
        return f"The search did not begin with {clear}: it has no room to spare at {reach.refused}"
    if reach.is_proof:
        return f"There is no path with {clear}: not even a disc about the rear axle gets through"
    if reach.is_exhaustive:
        at = f"at the search's {reach.resolution} resolution, at which it looked at all that can be reached"
        return f"There is no path with {clear} {at}"
    tried = f"{reach.expansions} expansions and {reach.seconds:.1f} s"
    return f"The search found no path with {clear} in {tried}, then {reach.limit} ended it, which is no proof"


def guess_words(request: Request, found: GuessResult, deeper: Deeper | None) -> tuple[str, str]:
    """When the guess is itself a failed optimisation."""
    others = "hybrid-astar or linear" if request.guess.name not in ("hybrid-astar", "linear") else "another"
    return f"There is no guess to begin with: {found.reason}", _asked(f"Take the guess {others}.", deeper)


def solver_words(
    request: Request, stop: SolverStop, narrow: Bottleneck | None, least: Penetration | None, deeper: Deeper | None
) -> tuple[str, str]:
    """When the solver stopped."""
    offset = request.scenario.offset
    found = f"The solver found no trajectory with {request.margin:g} m of clearance: {stop.status.sentence}"
    if stop.worst is not None:
        found += f" The worst constraint is {stop.worst}"
        if stop.worst.kind == "dynamics" and stop.tightest is not None:
            found += f"; after it, {stop.tightest}"
        elif stop.worst.kind == "dynamics" and stop.nearest is not None:
            name, near = labels(request.scenario)[stop.nearest.obstacle], stop.nearest
            found += f"; the nearest obstacle is {name!r}, {near.clearance:.3f} m away at {near.time:.2f} s"
    blamed = _blamed(request, stop)
    if stop.worst is not None:
        closest = stop.witness
        if (
            blamed is not None
            and closest is not None
            and stop.worst.kind == "separation"
            and blamed != stop.worst.label
        ):
            how = (
                f"overlaps it by {-closest.clearance:.3f} m"
                if closest.clearance < 0
                else f"is {closest.clearance:.3f} m away"
            )
            found += f"; of the obstacles {blamed!r} is nearest: {closest.part} {how} at {closest.time:.2f} s"
        found += "."
    if narrow is not None:
        return f"{found} There can be none: {narrow.describe(offset)}.", _widen(request, narrow, deeper)
    remedy = _AFTER_STATUS.get(stop.status, "Take another guess (--guess) or a smaller margin")
    if blamed is not None:
        remedy += f", or make room at obstacle {blamed!r}"
    if least is not None:
        remedy += ". A trajectory that keeps the margin at all samples was found afterwards, which is worth a guess"
    return found, _asked(f"{remedy}.", deeper)


def _blamed(request: Request, stop: SolverStop) -> str | None:
    """The obstacle to make room at: a violated row may be that of a line that stands wrong, far from the body."""
    tight = stop.tightest
    if tight is None or tight.obstacle in ("", WORKSPACE):
        return None
    if stop.worst != tight or stop.witness is None or stop.pose is None:
        return tight.label
    state = np.array([*stop.pose, 0.0, 0.0])
    near = clearances(request.scenario, request.vehicle, state, reach=request.margin)
    if any(found.obstacle == tight.label and found.value < request.margin for found in near):
        return tight.label
    return labels(request.scenario)[stop.witness.obstacle]


def penetration_words(
    request: Request, stop: SolverStop, near: Contact, narrow: Bottleneck | None, deeper: Deeper | None
) -> tuple[str, str]:
    """When only trajectories that come too near were found."""
    x, y = near.place + request.scenario.offset
    name = labels(request.scenario)[near.obstacle]
    where = f"{name!r} at {near.time:.2f} s near ({x:.2f}, {y:.2f})"
    if near.depth > 0:
        found = f"Only trajectories that collide were found: at the least, {near.part} penetrates obstacle {where}"
        found += f" by {near.depth:.3f} m"
        remedy = f"Move or shorten obstacle {name!r} by at least {near.depth + request.margin:.2f} m there, or take a "
        remedy += "narrower vehicle"
    else:
        found = (
            f"Only trajectories nearer than the margin of {request.margin:g} m were found: {near.part} comes within "
        )
        found += f"{-near.depth:.3f} m of obstacle {where}"
        least = math.floor(-1000 * near.depth) / 1000
        remedy = f"Ask for a margin of {least:g} m or less, or make room at obstacle {name!r}"
    found += "." if stop.status.success else f". {stop.status.sentence}"
    if stop.status in _AFTER_STATUS:
        remedy = f"{_AFTER_STATUS[stop.status]}; or {remedy[0].lower()}{remedy[1:]}"
    if narrow is not None:
        found += f" There can be none: {narrow.describe(request.scenario.offset)}."
        return found, _widen(request, narrow, deeper)
    other = "" if stop.status in _AFTER_STATUS else ", or take another guess (--guess)"
    return found, _asked(f"{remedy}{other}.", deeper)


def certificate_words(request: Request, rounds: list[Round], deeper: Deeper | None) -> tuple[str, str]:
    """When there is a trajectory, but the judge did not certify it."""
    last = rounds[-1]
    certificate = last.certificate
    if certificate is None:
        return "No certified plan.", "Take another guess (--guess)."
    count = f"{len(rounds)} rounds" if len(rounds) > 1 else "one round"
    if certificate.witness is not None:
        why = f": {certificate.witness}."
    else:
        why = ". " + " ".join(f"{check.sentence}." for check in certificate.failed)
    ways = []
    if request.formulation.holds == "knots":
        ways.append("take the swept-line formulation, which holds between the knots, too")
    if len(rounds) <= request.refinements:
        ways.append("allow more time (--time-limit, time_limit)")
    else:
        ways.append("allow more refinements or begin with more steps (--steps)")
    kept = _margin_kept(request, last)
    if kept is not None:
        ways.append(f"ask for a margin of {kept:g} m, which this very trajectory keeps at all times")
    remedy = "; or ".join(ways)
    return f"No certified plan after {count}{why}", _asked(f"{remedy[0].upper()}{remedy[1:]}.", deeper)


def _margin_kept(request: Request, last: Round) -> float | None:
    """The margin in whole mm with which the judge certifies the last trajectory as it is, if there is one, m."""
    certificate = last.certificate
    if certificate is None or not np.isfinite(certificate.clearance):
        return None
    clearance = min([certificate.clearance, *(witness.clearance for witness in certificate.witnesses)])
    kept = math.floor(1000 * clearance) / 1000
    if not 0 <= kept < request.margin:
        return None
    again = verify(request.scenario, request.vehicle, last.trajectory, margin=kept)
    return kept if again.certified else None


def _widen(request: Request, narrow: Bottleneck, deeper: Deeper | None) -> str:
    """What to do about a place that is too narrow."""
    if not narrow.room and narrow.margin is not None:
        return _asked(f"Ask for a margin of {narrow.margin:g} m or less, or make room there.", deeper)
    if not narrow.room:
        names = " and ".join(repr(name) for name in narrow.between if name != WORKSPACE)
        return f"Open a way{f' through obstacle {names}' if names else ''}: no margin and no narrower body helps."
    missing = narrow.needed - narrow.room
    remedy = f"Widen it by at least {missing:.3f} m, or take a narrower vehicle"
    if narrow.margin is not None:
        remedy += f", or a margin of {narrow.margin:g} m or less"
    return _asked(f"{remedy}.", deeper)


def _asked(remedy: str, deeper: Deeper | None) -> str:
    """The remedy, and that more can be asked for if it was not."""
    return remedy if deeper is not None else f"{remedy} {ASK}"
