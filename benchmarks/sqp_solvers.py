"""Which SQP solvers and QP solvers of CasADi's wheel can be used here?

Run as ``python -m benchmarks.sqp_solvers``; ``--scenes NAME ...`` for others than ``oblique``, ``--limit SECONDS`` for
one solve, ``--no-write`` to print only. Each candidate solves the same programs, formulation (17) with a unit normal
and 14 steps from the hybrid A* guess, in a process of its own, so that one that hangs or crashes stops nobody.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.report import keep, page, table

STEPS = 14
QP_SOLVERS = ("qrqp", "osqp", "proxqp", "piqp", "qpoases", "highs", "daqp", "ipqp", "hpipm", "clp", "superscs")
MARK = "measured: "


def _quiet_qp(name: str) -> dict[str, Any]:
    """Options that keep a QP solver from printing and from raising when it fails."""
    options: dict[str, Any] = {"print_time": False, "error_on_fail": False}
    extra: dict[str, dict[str, Any]] = {
        "qrqp": {"print_iter": False, "print_header": False, "print_info": False},
        "ipqp": {"print_iter": False, "print_header": False, "print_info": False},
        "osqp": {"osqp": {"verbose": False}},
        "qpoases": {"printLevel": "none", "sparse": True},
        "highs": {"highs": {"output_flag": False}},
    }
    return options | extra.get(name, {})


def candidates() -> dict[str, tuple[str, dict[str, Any]]]:
    """Plug-in and options by the name in the table."""
    quiet = {"print_header": False, "print_iteration": False, "print_status": False}
    found: dict[str, tuple[str, dict[str, Any]]] = {
        "ipopt (for comparison)": ("ipopt", {"ipopt": {"print_level": 0, "sb": "yes"}}),
    }
    for preset in ("filtersqp", "funnelsqp", "filterslp"):
        found[f"uno, preset {preset}"] = ("uno", {"uno": {"preset": preset, "logger": "SILENT"}})
    for qp in QP_SOLVERS:
        options = {
            "qpsol": qp,
            "qpsol_options": _quiet_qp(qp),
            "convexify_strategy": "regularize",
            "max_iter": 1000,
            **quiet,
        }
        found[f"sqpmethod + {qp}"] = ("sqpmethod", options)
    for qp in ("qrqp", "osqp", "highs"):
        options = {"qpsol": qp, "qpsol_options": _quiet_qp(qp), **quiet}
        found[f"feasiblesqpmethod + {qp}"] = ("feasiblesqpmethod", options)
    found["blocksqp"] = ("blocksqp", {"print_header": False, "print_iteration": False})
    found["qrsqp"] = ("qrsqp", {})
    found["scpgen + qrqp"] = ("scpgen", {"qpsol": "qrqp", "qpsol_options": _quiet_qp("qrqp")})
    found["sleqp"] = ("sleqp", {})
    return found


def measure(candidate: str, scene: str) -> dict[str, Any]:
    """One solve in this process."""
    import casadi as ca

    from tightspot.formulations import UnitNormalLine
    from tightspot.guesses import HybridAStar
    from tightspot.scenarios import load
    from tightspot.transcription import Objective, Settings, TimeGrid, transcribe
    from tightspot.vehicles import vehicle

    scenario = load(scene)
    car = vehicle(scenario.vehicle)
    guess = HybridAStar().make(scenario, car, margin=scenario.margin).trajectory
    settings = Settings(Objective(0.1), UnitNormalLine(), margin=scenario.margin)
    nlp = transcribe(scenario, car, guess, settings, grid=TimeGrid.uniform(STEPS)).nlp
    plugin, options = candidates()[candidate]
    options = {"print_time": False, "error_on_fail": False, **options}
    solver = ca.nlpsol("nlp", plugin, {"x": nlp.x, "p": nlp.p, "f": nlp.f, "g": nlp.g}, options)
    started = time.perf_counter()
    result = solver(x0=nlp.x0, p=nlp.p0, lbx=nlp.lbx, ubx=nlp.ubx, lbg=nlp.lbg, ubg=nlp.ubg)
    seconds = time.perf_counter() - started
    stats = solver.stats()
    return {
        "status": str(stats.get("return_status", stats.get("unified_return_status"))),
        "iterations": stats.get("iter_count"),
        "seconds": seconds,
        "objective": float(result["f"]),
        "violation": float(nlp.violation(np.array(result["g"]).ravel()).max()),
    }


def attempt(candidate: str, scene: str, limit: float) -> dict[str, Any]:
    """The measurement in another process, or what became of it."""
    row: dict[str, Any] = {"candidate": candidate, "scene": scene}
    command = [sys.executable, "-m", "benchmarks.sqp_solvers", "--one", candidate, scene]
    root = Path(__file__).resolve().parents[1]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=limit, cwd=root, check=False)
    except subprocess.TimeoutExpired:
        return row | {"status": f"not done after {limit:g} s"}
    lines = [line for line in done.stdout.splitlines() if line.startswith(MARK)]
    if lines:
        return row | json.loads(lines[-1].removeprefix(MARK))
    said = [line.strip() for line in done.stderr.splitlines() if line.strip()]
    return row | {"status": f"failed: {_last_words(said)}" if said else f"ended with code {done.returncode}"}


def _last_words(said: list[str]) -> str:
    """The last line of an error without the place in the library's source."""
    return re.sub(r"^.*?[.][ch]pp:\d+: ", "", said[-1])[:100]


COLUMNS = (
    ("solver", "candidate", "{}"),
    ("scene", "scene", "{}"),
    ("J", "objective", "{:.6g}"),
    ("violation", "violation", "{:.1e}"),
    ("iterations", "iterations", "{}"),
    ("seconds", "seconds", "{:.3f}"),
    ("its own word", "status", "{}"),
)


def as_markdown(rows: list[dict[str, Any]], limit: float) -> str:
    """The table, with the machine it is of."""
    note = f"formulation (17) with a unit normal, {STEPS} steps, hybrid A* guess, {limit:g} s a solve at most"
    return page("python -m benchmarks.sqp_solvers", "SQP solvers of CasADi's wheel", [note], table(rows, COLUMNS))


def main() -> int:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description="Try the SQP solvers of CasADi's wheel.")
    parser.add_argument("--scenes", nargs="+", metavar="NAME", default=["oblique"])
    parser.add_argument("--limit", type=float, default=20.0, metavar="SECONDS")
    parser.add_argument("--no-write", action="store_true", help="do not touch benchmarks/results")
    parser.add_argument("--one", nargs=2, metavar=("CANDIDATE", "SCENE"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        sys.stdout.write("\n" + MARK + json.dumps(measure(*options.one)) + "\n")
        return 0
    rows = []
    for scene in options.scenes:
        for candidate in candidates():
            sys.stderr.write(f"{scene}: {candidate} ...\n")
            rows.append(attempt(candidate, scene, options.limit))
    report = as_markdown(rows, options.limit)
    sys.stdout.write(report)
    if not options.no_write:
        keep("sqp_solvers.md", report)
    return 0


if __name__ == "__main__":
    sys.exit(main())
