"""Where the solver stopped: which constraint of its last iterate is violated most, by what, when."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tightspot.planner.request import Request
from tightspot.planner.rounds import Round
from tightspot.scenarios.labels import labels
from tightspot.solvers import SolveStatus, StageReport
from tightspot.solvers.stage_order import order_of
from tightspot.verification.certificate import WORKSPACE, Witness
from tightspot.verification.sampled import sampled_clearance

Array = NDArray[np.float64]


@dataclass(frozen=True)
class WorstConstraint:
    """A constraint that the last iterate violates.

    Attributes:
        kind: ``dynamics``, ``workspace`` or ``separation``.
        part: Name of the body part; empty for the dynamics.
        obstacle: Name of the obstacle part; ``workspace`` for its border; empty for the dynamics.
        label: What people call it: the name of the obstacle.
        start: Beginning of the time in which it shall hold, s.
        end: End of that time, s; the same for constraints at one moment.
        violation: By how much, in the constraint's own unit.
    """

    kind: str
    part: str
    obstacle: str
    label: str
    start: float
    end: float
    violation: float

    def __str__(self) -> str:
        when = f"at {self.end:.2f} s" if self.start == self.end else f"from {self.start:.2f} s to {self.end:.2f} s"
        if self.kind == "dynamics":
            return f"the vehicle's dynamics {when} (violated by {self.violation:.2g})"
        what = "the workspace's border" if self.obstacle == WORKSPACE else f"obstacle {self.label!r}"
        return f"the separation of {self.part} from {what} {when} (violated by {self.violation:.2g})"


@dataclass(frozen=True, eq=False)
class SolverStop:
    """How the last solve ended.

    Attributes:
        status: Of the solver.
        iterations: Of the last solve.
        rounds: Number of solves.
        violation: Largest violation of anything at the last iterate.
        worst: The constraint that is violated most, or ``None`` if only bounds are.
        tightest: The constraint on clearance of an obstacle or on W that is violated most, or ``None``.
        pose: (x m, y m, theta rad) of the last iterate at the end of the time of ``worst``, in the scenario's
            coordinates; ``None`` without ``worst``.
        nearest: Where the last iterate's knots come nearest to an obstacle; ``None`` without obstacles.
        margin: Demanded clearance, m.
    """

    status: SolveStatus
    iterations: int
    rounds: int
    violation: float
    worst: WorstConstraint | None
    tightest: WorstConstraint | None
    pose: tuple[float, float, float] | None
    nearest: Witness | None
    margin: float

    @property
    def witness(self) -> Witness | None:
        """:attr:`nearest`, if it is nearer than the margin."""
        return self.nearest if self.nearest is not None and self.nearest.clearance < self.margin else None

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "status": self.status.name,
            "sentence": self.status.sentence,
            "iterations": self.iterations,
            "rounds": self.rounds,
            "violation": self.violation if np.isfinite(self.violation) else None,
            "worst_constraint": None if self.worst is None else vars(self.worst),
            "worst_separation": None if self.tightest is None else vars(self.tightest),
        }


class _Violated(NamedTuple):
    """Rows of one meaning, at the end of interval ``knot - 1``: ``key`` is (part,) or (part, obstacle part)."""

    kind: str
    knot: int
    key: tuple[int, ...]
    amount: float


def solver_stop(request: Request, rounds: list[Round]) -> SolverStop:
    """Of the last round, which is one that was not solved."""
    last = rounds[-1]
    report = last.report
    violated = _of_stages(report) if isinstance(report, StageReport) else _of_program(last)
    worst = _worst(request, last, violated)
    knot = None if worst is None else int(np.argmin(np.abs(last.trajectory.t - worst.end)))
    return SolverStop(
        status=report.status,
        iterations=report.iterations,
        rounds=len(rounds),
        violation=report.violation,
        worst=worst,
        tightest=_worst(request, last, [each for each in violated if each.kind != "dynamics"]),
        pose=None if knot is None else _pose(last.trajectory.states[knot]),
        nearest=_nearest(request, last),
        margin=request.margin,
    )


def _of_program(last: Round) -> list[_Violated]:
    """How much each block of the nonlinear program's rows is violated."""
    nlp = last.transcription.nlp
    rows = np.nan_to_num(nlp.violation(last.report.g), nan=np.inf)
    blocks = [block for block in nlp.blocks if block.rows.stop > block.rows.start]
    return [_Violated(block.kind, block.knot, block.key, float(rows[block.rows].max())) for block in blocks]


def _of_stages(report: StageReport) -> list[_Violated]:
    """The most violated row of each kind, from the stagewise solver's arrays: no symbols are needed for that."""
    problem = report.problem
    assert problem is not None
    order = order_of(problem)
    parts = problem.part_radii.size
    defects = np.nan_to_num(np.abs(report.g[order.dynamics]).max(axis=1), nan=np.inf)
    found = [_Violated("dynamics", int(defects.argmax()) + 1, (), float(defects.max()))]
    rows = np.nan_to_num(-order.signs * report.g[order.rows], nan=np.inf)
    for kind, mine in (("workspace", order.pair_of_row < 0), ("separation", order.pair_of_row >= 0)):
        if not mine.any():
            continue
        row = int(np.flatnonzero(mine)[rows[mine].argmax()])
        interval, part = divmod(int(order.place_of_row[row]), parts)
        key = (part,) if kind == "workspace" else (part, int(problem.pairs[order.pair_of_row[row], 2]))
        found.append(_Violated(kind, interval + 1, key, float(rows[row])))
    return found


def _worst(request: Request, last: Round, violated: list[_Violated]) -> WorstConstraint | None:
    """The most violated, if any is violated."""
    if not violated:
        return None
    kind, k, key, amount = max(violated, key=lambda each: each.amount)
    if amount <= 0:
        return None
    names, obstacle, part = request.scenario.obstacle_parts, "", ""
    if kind in ("workspace", "separation"):
        part = request.vehicle.parts[key[0]].name
        obstacle = WORKSPACE if kind == "workspace" else names[key[1]][0]
    t = last.trajectory.t
    throughout = kind == "dynamics" or last.mesh.formulation.holds == "interval"
    start = float(t[k - 1] if throughout and k > 0 else t[k])
    label = labels(request.scenario).get(obstacle, obstacle)
    return WorstConstraint(kind, part, obstacle, label, start, float(t[k]), amount)


def _nearest(request: Request, last: Round) -> Witness | None:
    """The last iterate's worst knot, as the solver sees it: its knots need not be what its inputs lead to."""
    states = last.trajectory.states
    clear = sampled_clearance(states, request.scenario, request.vehicle)
    if not clear.size:
        return None
    k, i, j = (int(index) for index in np.unravel_index(int(clear.argmin()), clear.shape))
    value = float(clear[k, i, j])
    obstacle = request.scenario.obstacle_parts[j][0]
    kind = "collision" if value < 0 else "margin"
    return Witness(float(last.trajectory.t[k]), request.vehicle.parts[i].name, obstacle, value, _pose(states[k]), kind)


def _pose(state: Array) -> tuple[float, float, float]:
    x, y, theta = (float(value) for value in state[:3])
    return x, y, theta
