"""The swept line against the paper's (17) on the same mesh: what safety between the samples costs.

Run as ``python -m benchmarks.side_by_side``; ``--runs N`` solves each program N times (default 9), ``--margin`` sets
the demanded clearance (default 0.02 m), ``--no-write`` prints only.

For each of the paper's scenes the planner's own course gives the final mesh: (17) at the knots on the guess's mesh,
replay, intervals added where it comes near. On that mesh, with the same pairs and edges of W, from the same hybrid A*
guess, both programs are solved with the same options, alternately. Clearances are those of the independent
judge: the replayed motion, all times.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.plan_scenes import RESULTS, machine
from tightspot.formulations import SeparatingLine
from tightspot.planner.request import Request, resolve
from tightspot.planner.rounds import Mesh, Round, Step, run_round
from tightspot.planner.strategy import first_step, next_step
from tightspot.solvers import Ipopt
from tightspot.trajectory import Trajectory

SCENES = ("oblique", "vertical", "parallel")
SECONDS = 60.0


@dataclass(frozen=True)
class Row:
    """One formulation on one scene's final mesh.

    Attributes:
        scene: Its name.
        method: What was solved.
        intervals: Of the mesh.
        rows: Of the program.
        iterations: Of IPOPT.
        seconds: Solver time of each run, without set-up.
        objective: J.
        clearance: The judge's: proved, or seen at worst, m.
        certified: Whether the judge certifies the margin.
    """

    scene: str
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


def measure(scene: str, margin: float, runs: int) -> list[Row]:
    """(17) and the swept line from the planner's start, the swept line as the planner solves it, and from the guess."""
    request = resolve(scene, None, None, None, None, None, None, margin, 8, SECONDS)
    guess = request.guess.make(request.scenario, request.vehicle, margin=margin).trajectory
    if guess is None:
        raise RuntimeError(f"no guess for {scene}")
    first = _run(request, first_step(request, guess))
    if first.replay is None:
        raise RuntimeError(f"{scene} is not solved at the knots")
    planned = next_step(request, [first], guess)
    if planned is not None and planned.kind == "again":
        planned = next_step(request, [first, _run(request, planned)], guess)
    if planned is None or planned.kind != "between":
        raise RuntimeError(f"{scene} is not planned in the usual course")
    mesh = replace(planned.mesh, active=np.ones_like(planned.mesh.active), walls=np.ones_like(planned.mesh.walls))
    knots = replace(mesh, formulation=SeparatingLine(), poses=(1,) * mesh.grid.steps)
    methods = {
        "(17)": (request, replace(planned, mesh=knots, before=None)),
        "swept line": (request, replace(planned, mesh=mesh, before=None)),
        "swept line, in the plan": (request, planned),
        "(17), from the guess": (request, _cold(knots, guess)),
        "swept line, from the guess": (request, _cold(mesh, guess)),
        "(17), from the guess, IPOPT": (replace(request, solver=Ipopt(), fallbacks=()), _cold(knots, guess)),
    }
    rounds: dict[str, list[Round]] = {method: [] for method in methods}
    for _ in range(runs):
        for method, (asked, step) in methods.items():
            rounds[method].append(_run(asked, step))
    return [_row(scene, method, found) for method, found in rounds.items()]


def _cold(mesh: Mesh, guess: Trajectory) -> Step:
    return Step(mesh, guess, "guess", "from the guess")


def _run(request: Request, step: Step) -> Round:
    return run_round(request, step, 0, lambda news: None, SECONDS)


def _row(scene: str, method: str, rounds: Sequence[Round]) -> Row:
    last = rounds[-1]
    judged = last.certificate
    if judged is None:
        raise RuntimeError(f"{scene}, {method}: {last.report.status.sentence}")
    seen = judged.clearance
    if not judged.certified and judged.witness is not None:
        seen = judged.witness.clearance
    return Row(
        scene,
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
    """A Markdown table; ratios are to (17) on the same scene in the same run."""
    lines = [
        "| scene | method | intervals | rows | iterations | solver time, ms | × (17) | J | J over (17) "
        "| clearance for all times, m | certified |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        base = next(other for other in rows if other.scene == row.scene)
        more = 100 * (row.objective / base.objective - 1)
        cells = [row.scene, row.method, str(row.intervals), str(row.rows), str(row.iterations)]
        cells += [f"{1000 * row.fastest:.1f}", f"{row.fastest / base.fastest:.2f}", f"{row.objective:.4f}"]
        cells += [f"{more:+.2f} %", f"{row.clearance:+.4f}", "yes" if row.certified else "no"]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def main() -> int:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description="The swept line against (17) on the same mesh.")
    parser.add_argument("--runs", type=int, default=9, metavar="N", help="solves of each program (default 9)")
    parser.add_argument("--margin", type=float, default=0.02, metavar="M", help="demanded clearance (default 0.02)")
    parser.add_argument("--no-write", action="store_true", help="do not touch benchmarks/results")
    options = parser.parse_args()
    rows = []
    for scene in SCENES:
        sys.stderr.write(f"{scene} ...\n")
        rows += measure(scene, options.margin, options.runs)
    lines = table(rows)
    where = ", ".join(f"{key} {value}" for key, value in machine().items())
    head = ["# The swept line beside (17)", "", "Written by `python -m benchmarks.side_by_side`.", "", f"- {where}"]
    head.append(f"- margin {options.margin:g} m; the fastest of {options.runs} solves each, alternating in one process")
    report = "\n".join([*head, "", *lines]) + "\n"
    sys.stdout.write(report)
    if not options.no_write:
        RESULTS.mkdir(exist_ok=True)
        (RESULTS / "side_by_side.md").write_text(report, encoding="utf-8")
        (RESULTS / "side_by_side_table.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
