"""The swept line against the paper's (17) on the same mesh: what safety between the samples costs.

Run as ``python -m benchmarks.side_by_side``; ``--runs N`` solves each program N times (default 9), ``--margin`` sets
the demanded clearance (default 0.02 m), ``--no-write`` prints only, ``--no-ipopt`` leaves IPOPT out.

For each of the paper's scenes the planner's own course gives the final mesh: (17) at the knots on the guess's mesh,
replay, intervals added where it comes near. On that mesh both are solved alternately in one process, with the same
margin, tolerance (1e-8) and solver, from the same start:

- ``plan``: as the planner solves its last round, from its solution at the knots of the coarser mesh, whose lines are
  carried over, with the pairs and edges of W that are near, and rows between the knots where it asks for them;
- ``all pairs``: the same with every pair and every edge of W on every interval;
- ``guess``: from the hybrid A* guess, with every pair and edge, and rows between the knots on every interval;
- ``plan, IPOPT`` and ``guess, IPOPT``: by IPOPT.

Times are the fastest of the runs. Clearances are the independent judge's: the replayed motion, all times.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.report import tell
from tightspot.formulations import SeparatingLine
from tightspot.planner.request import Request, resolve
from tightspot.planner.rounds import Mesh, Round, Step, run_round
from tightspot.planner.strategy import first_step, next_step
from tightspot.solvers import Ipopt
from tightspot.trajectory import Trajectory

SCENES = ("oblique", "vertical", "parallel")
SECONDS = 60.0
SLOW_RUNS = 3


@dataclass(frozen=True)
class Row:
    """One formulation on one scene's final mesh.

    Attributes:
        scene: Its name.
        start: From where, with which pairs and by which solver, see the module's words.
        method: ``(17)`` or ``swept line``.
        intervals: Of the mesh.
        rows: Of the program.
        iterations: Of the solver.
        seconds: Solver time of each run, without set-up.
        objective: J.
        clearance: The judge's: proved, or seen at worst, m.
        certified: Whether the judge certifies the margin.
    """

    scene: str
    start: str
    method: str
    intervals: int
    rows: int
    iterations: int
    seconds: tuple[float, ...]
    objective: float
    clearance: float
    certified: bool

    @property
    def fastest(self) -> float:
        return min(self.seconds)


def measure(scene: str, margin: float, runs: int, ipopt: bool = True) -> list[Row]:
    """Both formulations from every start."""
    request = resolve(scene, None, None, None, None, None, None, margin, 8, SECONDS)
    request = replace(request, fallbacks=())
    guess = request.guess.make(request.scenario, request.vehicle, margin=margin).trajectory
    if guess is None:
        raise RuntimeError(f"no guess for {scene}")
    planned = _last_step(request, guess)
    full = replace(planned.mesh, active=np.ones_like(planned.mesh.active), walls=np.ones_like(planned.mesh.walls))
    whole = replace(full, poses=tuple(max(count, 1) for count in full.poses))
    starts = {"plan": planned, "all pairs": replace(planned, mesh=full), "guess": _cold(whole, guess)}
    asked = dict.fromkeys(starts, request)
    counts = dict.fromkeys(starts, runs)
    if ipopt:
        slow = replace(request, solver=Ipopt())
        for start in ("plan", "guess"):
            name = f"{start}, IPOPT"
            asked[name], counts[name] = slow, min(runs, SLOW_RUNS)
            starts[name] = replace(starts[start], before=None)
    rows = []
    for start, step in starts.items():
        knots = replace(step.mesh, formulation=SeparatingLine(), poses=(1,) * step.mesh.grid.steps)
        both = {"(17)": replace(step, mesh=knots), "swept line": step}
        found: dict[str, list[Round]] = {method: [] for method in both}
        for _ in range(counts[start]):
            for method, each in both.items():
                found[method].append(_run(asked[start], each))
        rows += [_row(scene, start, method, rounds) for method, rounds in found.items()]
    return rows


def _last_step(request: Request, guess: Trajectory) -> Step:
    """The planner's own first step on whole intervals, with the rounds before it solved."""
    rounds = [_run(request, first_step(request, guess))]
    while True:
        if rounds[-1].replay is None:
            raise RuntimeError(f"{request.scenario.name} is not solved at the knots")
        step = _next(request, rounds, guess)
        if step.kind == "between":
            return step
        rounds.append(_run(request, step))


def _next(request: Request, rounds: list[Round], guess: Trajectory) -> Step:
    """The step after the last round, also if that happens to be certified at the knots."""
    last = rounds[-1]
    step = next_step(request, rounds, guess)
    if step is None or last.replay is None:
        raise RuntimeError(f"{request.scenario.name} is not planned in the usual course")
    return step


def _cold(mesh: Mesh, guess: Trajectory) -> Step:
    return Step(mesh, guess, "guess", "from the guess")


def _run(request: Request, step: Step) -> Round:
    return run_round(request, step, 0, lambda news: None, SECONDS)


def _row(scene: str, start: str, method: str, rounds: Sequence[Round]) -> Row:
    last = rounds[-1]
    judged = last.certificate
    if judged is None:
        raise RuntimeError(f"{scene}, {start}, {method}: {last.report.status.sentence}")
    seen = judged.clearance
    if not judged.certified and judged.witness is not None:
        seen = judged.witness.clearance
    return Row(
        scene,
        start,
        method,
        last.mesh.grid.steps,
        last.report.g.size,
        last.report.iterations,
        tuple(outcome.timings["solve"] for outcome in rounds),
        last.report.objective,
        seen,
        judged.certified,
    )


def table(rows: Sequence[Row]) -> list[str]:
    """A Markdown table; ratios are to (17) on the same scene from the same start in the same run."""
    lines = [
        "| scene | start | method | intervals | rows | iterations | solver time, ms | × (17) | J | J over (17) "
        "| clearance for all times, m | certified |",
        "|---|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        base = next(other for other in rows if (other.scene, other.start) == (row.scene, row.start))
        more = 100 * (row.objective / base.objective - 1)
        cells = [row.scene, row.start, row.method, str(row.intervals), str(row.rows), str(row.iterations)]
        cells += [f"{1000 * row.fastest:.2f}", f"{row.fastest / base.fastest:.2f}", f"{row.objective:.4f}"]
        cells += [f"{more:+.2f} %", f"{row.clearance:+.4f}", "yes" if row.certified else "no"]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def main() -> int:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description="The swept line against (17) on the same mesh.")
    parser.add_argument("--runs", type=int, default=9, metavar="N", help="solves of each program (default 9)")
    parser.add_argument("--margin", type=float, default=0.02, metavar="M", help="demanded clearance (default 0.02)")
    parser.add_argument("--no-ipopt", action="store_true", help="by the stagewise solver only")
    parser.add_argument("--no-write", action="store_true", help="do not touch benchmarks/results")
    options = parser.parse_args()
    rows = []
    for scene in SCENES:
        sys.stderr.write(f"{scene} ...\n")
        rows += measure(scene, options.margin, options.runs, not options.no_ipopt)
    lines = table(rows)
    note = f"margin {options.margin:g} m; the fastest of {options.runs} solves each, alternating in one process"
    tell("side_by_side", "The swept line beside (17)", note, lines, write=not options.no_write)
    return 0


if __name__ == "__main__":
    sys.exit(main())
