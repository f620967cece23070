"""The report of the paper's campaign, as Markdown. Every number comes from the rows."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

import tightspot
from tightspot.campaigns.claims import reached
from tightspot.campaigns.methods import METHODS
from tightspot.campaigns.paper import REPORT, ROWS, TABLE, Outcome
from tightspot.campaigns.rows import Row
from tightspot.campaigns.settings import GUESS_NAMES
from tightspot.campaigns.table import SIZES, TABLE_V

_WORD = {True: "holds", False: "does not hold", None: "-"}


@dataclass(frozen=True)
class Machine:
    """Where the numbers are from."""

    processor: str
    cores: int
    system: str
    versions: Mapping[str, str]

    @classmethod
    def here(cls) -> Machine:
        """This one."""
        versions = {"tightspot": tightspot.__version__, "python": platform.python_version()}
        versions |= {name: metadata.version(name) for name in ("casadi", "numpy", "shapely")}
        return cls(_processor(), os.cpu_count() or 1, f"{platform.system()} {platform.machine()}", versions)


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or "unknown"


def report_markdown(outcome: Outcome, machine: Machine, pictures: Mapping[str, str] | None = None) -> str:
    """The whole report.

    Args:
        outcome: A finished campaign.
        machine: Where it ran.
        pictures: Caption to file name, relative to the report.
    """
    parts = [
        "# The paper's Table II, solved again",
        "",
        "Written by `tightspot bench paper`. The paper: arXiv 2308.09103.",
        "",
        *_conditions(outcome, machine),
        "",
        *_claims(outcome),
        "",
        *_optima(outcome),
        "",
        *_sizes(outcome.rows),
    ]
    for scene in outcome.plan.scenes:
        parts += ["", *_scene(scene, outcome.rows)]
    parts += ["", *_starts(outcome.rows)]
    if pictures:
        parts += ["", "## Pictures", ""]
        for caption, name in pictures.items():
            parts += [f"![{caption}]({name})", "", caption, ""]
    return "\n".join(parts).rstrip() + "\n"


def _conditions(outcome: Outcome, machine: Machine) -> list[str]:
    settings, plan = outcome.settings, outcome.plan
    lines = ["## Conditions", ""]
    lines.append(f"- machine: {machine.processor}, {machine.cores} cores, {machine.system}")
    lines.append("- versions: " + ", ".join(f"{name} {version}" for name, version in machine.versions.items()))
    lines.append(
        f"- settings `{settings.name}`: vehicle `{settings.vehicle}`, {settings.steps} intervals, RK4 with "
        f"{settings.substeps} step(s) an interval, separation of {settings.gap:g} m at the knots, "
        f"objective {settings.objective}"
    )
    lines.append(
        f"- IPOPT's default barrier strategy; times are the solver's, medians of up to {plan.runs} solves, without "
        f"building; at most {plan.time_limit:g} s a solve"
    )
    lines.append(
        f"- the judge: margin 0 at all times; TS = sum of a^2 + omega^2; all rows: `{TABLE}`, with trajectories: "
        f"`{ROWS}`"
    )
    lines += ["", "Where the settings come from:", ""]
    return lines + _table(("value", "evidence"), settings.evidence.items())


def _claims(outcome: Outcome) -> list[str]:
    rows = [(claim.paper, claim.here, _WORD[claim.holds]) for claim in outcome.claims]
    intro = "Ratios are geometric means over the cases that both solved, in this run and on this machine."
    return ["## What holds of the paper's claims", "", intro, "", *_table(("the paper", "these rows", ""), rows)]


def _optima(outcome: Outcome) -> list[str]:
    lines = []
    for known, found in reached(outcome.rows, outcome.settings.name):
        printed = "not in the paper" if known.printed is None else f"{known.printed:g}"
        who = ", ".join(f"{row.method} from {row.guess}" for row in found[:4]) + (" ..." if len(found) > 4 else "")
        lines.append((known.scene, printed, f"{known.objective:g} / {known.final_time:g}", who or "not reached"))
    header = ("scene", "paper's J", "J / t_f s as reproduced", "reached within 0.2 % by")
    return ["## Known optima", "", *_table(header, lines)]


def _sizes(rows: Sequence[Row]) -> list[str]:
    lines = []
    for key, method in METHODS.items():
        mine = next((row for row in rows if row.method == key and row.VN is not None), None)
        if mine is None:
            continue
        paper = "{} / {}".format(*SIZES[method.equation]) if method.paper_variant else "-"
        lines.append((method.title, f"{mine.CN} / {mine.VN}", paper, TABLE_V[method.equation]))
    header = ("formulation", "CN / VN", "paper's CN / VN", "auxiliary variables a pair in Table V as printed")
    note = "Table V as printed swaps (16) and (17): (16) has four auxiliary variables a pair, (17) has three."
    return ["## Sizes, Tables II and V", "", *_table(header, lines), "", note]


def _scene(scene: str, rows: Sequence[Row]) -> list[str]:
    header = ["formulation", "guess", "status", "J", "paper", "t_f s", "paper", "TS", "paper", "iterations"]
    header += ["time s", "paper", "judge"]
    lines = []
    for row in rows:
        if row.scene != scene or row.guess not in GUESS_NAMES:
            continue
        title = METHODS[row.method].title
        numbers = [_number(row.objective, "{:.4f}"), _number(row.paper_objective, "{:g}")]
        numbers += [_number(row.final_time, "{:.2f}"), _number(row.paper_final_time, "{:g}")]
        numbers += [_number(row.effort, "{:.4f}"), _number(row.paper_effort, "{:g}"), _number(row.iterations, "{}")]
        numbers += [_number(row.seconds, "{:.3f}"), _number(row.paper_seconds, "{:g}")]
        lines.append((title, row.guess, row.status, *numbers, row.verdict))
    note = "The paper's times are from its own machine (AMD R7-5800H, MATLAB) and not comparable one by one."
    return [f"## Scene {scene}", "", *_table(header, lines), "", note]


def _starts(rows: Sequence[Row]) -> list[str]:
    random = [row for row in rows if row.guess not in GUESS_NAMES]
    if not random:
        return []
    lines = []
    for scene in dict.fromkeys(row.scene for row in random):
        solved = [row for row in random if row.scene == scene and row.solved and row.objective is not None]
        count = sum(row.scene == scene for row in random)
        best = min(solved, key=lambda row: row.objective or 0.0, default=None)
        text = f"{best.objective:.4f} at t_f = {best.final_time:.2f} s ({best.guess})" if best else "-"
        lines.append((scene, f"{len(solved)} of {count}", text, best.verdict if best else "-"))
    return ["## Random starts", "", *_table(("scene", "solved", "best J", "judge"), lines)]


def _number(value: float | None, form: str) -> str:
    return "-" if value is None else form.format(value)


def _table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return lines + ["| " + " | ".join(str(cell).replace("|", r"\|") for cell in row) + " |" for row in rows]


__all__ = ["REPORT", "Machine", "report_markdown"]
