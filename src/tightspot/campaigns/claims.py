"""What holds of the paper's claims, computed from the rows of one run."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from tightspot.campaigns.methods import METHODS
from tightspot.campaigns.rows import Row
from tightspot.campaigns.settings import GUESS_NAMES, SCENES
from tightspot.campaigns.table import BETTER, KNOWN, PRINTED_FORM, SIZES, TABLE_II, KnownRow

SAME = 2e-3
"""Relative difference below which two optima are the same."""


class Claim(NamedTuple):
    """What the paper says, what these rows say, and whether the two agree (``None``: the rows do not tell)."""

    paper: str
    here: str
    holds: bool | None


def claims(rows: Sequence[Row]) -> list[Claim]:
    """All of them; those of which the rows say nothing are told so."""
    return [*_sizes(rows), *_speed(rows), *_vertex_exclusion(rows), *_guesses(rows), _oblique(rows), _collisions(rows)]


def time_ratio(rows: Sequence[Row], method: str, base: str) -> tuple[float, int] | None:
    """Geometric mean of the times' ratio over the cases that both solved, and the number of those cases."""
    times: dict[tuple[str, str], dict[str, float]] = {}
    for row in rows:
        if row.solved and row.seconds and row.method in (method, base) and row.guess in GUESS_NAMES:
            times.setdefault((row.scene, row.guess), {})[row.method] = row.seconds
    ratios = [pair[method] / pair[base] for pair in times.values() if len(pair) == 2]
    return (math.exp(statistics.fmean(map(math.log, ratios))), len(ratios)) if ratios else None


def matches(row: Row, known: KnownRow) -> bool:
    """Whether the row is that optimum: J and t_f within 0.2 %."""
    if not row.solved or row.scene != known.scene or row.objective is None or row.final_time is None:
        return False
    near_objective = abs(row.objective - known.objective) <= SAME * known.objective
    return near_objective and abs(row.final_time - known.final_time) <= SAME * known.final_time


def reached(rows: Sequence[Row], settings: str = "recovered") -> list[tuple[KnownRow, list[Row]]]:
    """For each known optimum of these settings, the paper's and the better ones, the rows that are it."""
    optima = (*KNOWN, *BETTER) if settings == "recovered" else PRINTED_FORM
    return [(known, [row for row in rows if matches(row, known)]) for known in optima]


def _sizes(rows: Sequence[Row]) -> list[Claim]:
    found = {}
    for row in rows:
        if row.method in METHODS and METHODS[row.method].paper_variant and row.CN is not None and row.VN is not None:
            found[METHODS[row.method].equation] = (row.CN, row.VN)
    text = ", ".join(f"({equation}) {cn} and {vn}" for equation, (cn, vn) in found.items())
    right = {equation: SIZES[equation] == size for equation, size in found.items()}
    told = {equation: size for equation, size in SIZES.items() if equation in found or not found}
    paper = "CN and VN of Table II: " + ", ".join(f"({key}) {cn} and {vn}" for key, (cn, vn) in told.items())
    holds = all(right.values()) if found else None
    return [Claim(paper, f"counted in the built programs: {text}" if found else _SILENT, holds)]


_SILENT = "these rows do not tell"


def _speed(rows: Sequence[Row]) -> list[Claim]:
    out = []
    for line in ("16", "17"):
        for suffix, variant in (("", "with four copies"), ("-single", "with one copy")):
            ratios = {dual: time_ratio(rows, dual + suffix, line) for dual in ("18", "19", "21")}
            known = {dual: ratio for dual, ratio in ratios.items() if ratio}
            text = ", ".join(
                f"({dual}) takes {ratio:.2f} times as long ({n} cases)" for dual, (ratio, n) in known.items()
            )
            holds = all(ratio > 1 for ratio, _ in known.values()) if known else None
            out.append(Claim(f"({line}) is faster than the duals {variant}", text or _SILENT, holds))
    return out


def _vertex_exclusion(rows: Sequence[Row]) -> list[Claim]:
    ratios = {dual: time_ratio(rows, "14", dual) for dual in ("18", "19", "21")}
    known = {dual: ratio for dual, ratio in ratios.items() if ratio}
    text = ", ".join(f"{ratio:.2f} times the time of ({dual}) ({n} cases)" for dual, (ratio, n) in known.items())
    holds = all(0.5 <= ratio <= 2 for ratio, _ in known.values()) if known else None
    return [Claim("(14) takes about the time of the duals (read as: between half and twice)", text or _SILENT, holds)]


def _guesses(rows: Sequence[Row]) -> list[Claim]:
    """Which guess finds which optimum, and whether the paper's best ones are the best."""
    out = []
    for scene in SCENES:
        here = [row for row in rows if row.scene == scene and row.guess in GUESS_NAMES]
        values = {guess: sorted(_objectives(row for row in here if row.guess == guess)) for guess in GUESS_NAMES}
        if not any(values.values()):
            continue
        found = []
        for guess in GUESS_NAMES:
            failed = sum(row.guess == guess and not row.solved for row in here)
            lost = f", {failed} not solved" if failed else ""
            found.append(f"{guess}: J {_distinct(values[guess]) or '-'}{lost}")
        out.append(Claim(f"{scene}: {_GUESS_CLAIM[scene]}", "; ".join(found), _seeing_helps(scene, values)))
        best, printed = min(map(min, filter(None, values.values()))), _PRINTED_BEST[scene]
        text = f"the best of the table's cases has J = {best:.4f}"
        out.append(Claim(f"{scene}: the best optimum has J = {printed:g}", text, abs(best - printed) <= SAME * printed))
    return out


_GUESS_CLAIM = {
    "vertical": "which guess finds which optimum (no claim)",
    "parallel": "guesses that see the obstacles lead to better optima than the simplified model",
    "oblique": "which guess finds which optimum (no claim)",
}
_PRINTED_BEST = {
    scene: min(cell.objective for (where, _, _), cell in TABLE_II.items() if where == scene) for scene in SCENES
}


def _objectives(rows: Iterable[Row]) -> list[float]:
    return [row.objective for row in rows if row.solved and row.objective is not None]


def _seeing_helps(scene: str, values: dict[str, list[float]]) -> bool | None:
    """Whether each guess that sees the obstacles has a better median than the simplified model's."""
    if "(no claim)" in _GUESS_CLAIM[scene] or not all(values.values()):
        return None
    blind = statistics.median(values["simplified"])
    return all(statistics.median(values[guess]) < blind for guess in GUESS_NAMES if guess != "simplified")


def _distinct(values: Sequence[float]) -> str:
    """Distinct optima with how often they were found: ``1.012 (3), 1.190``."""
    groups: list[list[float]] = []
    for value in values:
        if groups and value <= groups[-1][0] * (1 + SAME):
            groups[-1].append(value)
        else:
            groups.append([value])
    return ", ".join(f"{group[0]:.3f}" + (f" ({len(group)})" if len(group) > 1 else "") for group in groups)


def _oblique(rows: Sequence[Row]) -> Claim:
    values = sorted(row.objective for row in rows if row.scene == "oblique" and row.objective is not None)
    printed = _PRINTED_BEST["oblique"]
    holds = max(abs(values[0] - printed), abs(values[-1] - printed)) <= SAME * printed if values else None
    paper = f"oblique: every formulation and guess gives the same optimum, J = {printed:g}"
    return Claim(paper, f"J {_distinct(values)}" if values else _SILENT, holds)


def _collisions(rows: Sequence[Row]) -> Claim:
    solved = [row for row in rows if row.solved]
    bad = [row for row in solved if row.penetration]
    deepest = max((row.penetration or 0.0 for row in bad), default=0.0)
    text = f"{len(bad)} of {len(solved)} solutions collide between their samples, by up to {deepest:.2f} m"
    holds = not bad if solved else None
    return Claim("the trajectories are collision-free", text if solved else _SILENT, holds)
