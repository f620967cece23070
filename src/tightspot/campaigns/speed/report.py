"""The report of the speed benchmark, as Markdown. Every number comes from the result."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

ASKED = {
    "solve_ratio": ("solve, energy and time (r = 0.01), against IPOPT (17)", ">= 100"),
    "solve_ratio_time_optimal": ("solve, time-optimal (r = 1), against IPOPT (17)", ""),
    "success": ("solved before any fall-back, r = 0.01", ">= 0.97"),
    "success_time_optimal": ("solved before any fall-back, r = 1", ">= 0.97"),
    "success_ipopt": ("solved by IPOPT (17), r = 0.01", ""),
    "straight_line_ratio": ("solve from straight-line guesses, against IPOPT (17)", ">= 10"),
    "straight_line_success": ("solved from straight-line guesses", ">= 0.9"),
    "plan_ratio": ("hybrid A* + IPOPT (17) on the certified mesh, over scene in memory to certified plan", ">= 20"),
    "search_ratio": ("IPOPT (17) on the certified mesh, over hybrid A*", ">= 3"),
    "success_plans": ("certified plans", ""),
    "solves_per_second": ("solves a second and core, scene vertical", ">= 1000"),
    "warm_ratio": ("plan made anew over warm plan, start moved by 10 cm and 2 degrees", ">= 3"),
    "warm_solve_ratio": ("solve from a new guess over warm re-solve, the same move", ""),
    "slope_steps": ("slope of time an iteration over steps (1 is linear)", "0.8 to 1.2"),
    "slope_steps_solve": ("slope of the time of a whole solve over steps", "0.8 to 1.2"),
    "slope_obstacles": ("slope of time an iteration over obstacles in the program", "0.8 to 1.2"),
    "plan_growth_obstacles": ("whole plan, most obstacles over ten", "< 2"),
}


def speed_report(result: Mapping[str, Any], pictures: Mapping[str, str] | None = None) -> str:
    """The whole report.

    Args:
        result: From :func:`tightspot.campaigns.speed.run_speed`.
        pictures: Caption to file name, relative to the report.
    """
    parts = [
        "# How much faster than the paper's method",
        "",
        "Written by `tightspot bench speed`. The paper's method: formulation (17), CasADi, IPOPT with MUMPS and its",
        "default options, to 1e-8; arXiv 2308.09103. Ratios are of processor times in one process, in turns: above 1,",
        "tightspot is faster. Neither side's time includes building the program unless a column says so.",
        "",
        "<!-- --8<-- [start:figures] -->",
        *_conditions(result),
        "",
        *_headline(result),
    ]
    for name, title in (("energy and time", "r = 0.01"), ("time-optimal", "r = 1")):
        parts += ["", f"## Solves from hybrid A* guesses, {name} ({title})", "", *solves_table(result["solves"][name])]
    parts += ["", "## Solves from straight-line guesses (r = 0.01)", "", *solves_table(result["straight_lines"])]
    parts += ["", *_plans(result["plans"])]
    parts += ["", *_scaling(result["scaling"])]
    parts += ["", *_throughput(result), "", "<!-- --8<-- [end:figures] -->"]
    if pictures:
        parts += ["", "## Pictures", ""]
        for caption, file in pictures.items():
            parts += [f"![{caption}]({file})", "", caption, ""]
    return "\n".join(parts).rstrip() + "\n"


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """A Markdown table."""
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return lines + ["| " + " | ".join(cell.replace("|", r"\|") for cell in row) + " |" for row in rows]


def _conditions(result: Mapping[str, Any]) -> list[str]:
    machine, plan = result["machine"], result["plan"]
    versions = ", ".join(f"{name} {version}" for name, version in machine["versions"].items())
    return [
        f"- machine: {machine['processor']}, {machine['cores']} cores, {machine['system']}; one thread",
        f"- versions: {versions}",
        f"- {plan['starts']} starts a scene for solves, {plan['plans']} for plans, seed {plan['seed']}; "
        f"{result['seconds']:.0f} s in all",
    ]


def _headline(result: Mapping[str, Any]) -> list[str]:
    rows = [(what, _number(result[key]), asked or "-") for key, (what, asked) in ASKED.items()]
    for scene, share in result["best_of_many_found"].items():
        rows.append((f"best known optimum of {scene} found by the best of many", _number(share), ">= 0.95"))
    return ["## In one table", "", "Medians.", "", *table(("figure", "here", "wanted"), rows)]


def solves_table(summaries: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """The comparison of solves, one line a scene."""
    header = ["scene", "ratio", "10 % to 90 %", "ms", "set-up ms", "IPOPT ms", "iterations", "IPOPT's", "solved"]
    header += ["IPOPT's", "near the best", "IPOPT's", "largest residual"]
    rows = []
    for scene, figures in summaries.items():
        ratio, times = figures["ratio"] or {}, figures["milliseconds"]
        residual = figures["largest_residual"]
        rows.append(
            (
                scene, f"{ratio['median']:.0f}" if ratio else "-",
                f"{ratio['p10']:.0f} to {ratio['p90']:.0f}" if ratio else "-",
                f"{times['median']:.2f}", f"{figures['set_up_milliseconds']:.2f}",
                f"{figures['ipopt_milliseconds']['median']:.1f}", f"{figures['iterations']:.0f}",
                f"{figures['ipopt_iterations']:.0f}", _percent(figures["success"]),
                _percent(figures["ipopt_success"]), _percent(figures["near_best"]),
                _percent(figures["ipopt_near_best"]), "-" if residual is None else f"{residual:.0e}",
            )
        )  # fmt: skip
    note = (
        'Ratios of the cases that we solve. "Near the best": J within 1 % of the better of the two. "Largest residual" '
        "of our solutions: violation, stationarity and complementarity, computed with the functions IPOPT is given."
    )
    return [*table(header, rows), "", note]


def _plans(summaries: Mapping[str, Mapping[str, Any]]) -> list[str]:
    header = ["scene", "ratio", "10 % to 90 %", "with building", "plan ms", "search", "set-up", "solve", "judge"]
    header += ["hybrid A* ms", "IPOPT ms", "its building ms", "steps", "rounds", "certified"]
    rows = []
    for scene, figures in summaries.items():
        if "ratio" not in figures:
            rows.append((scene, *["-"] * 13, _percent(figures["success"])))
            continue
        ratio, parts = figures["ratio"], figures["parts_milliseconds"]
        rows.append(
            (
                scene, f"{ratio['median']:.1f}", f"{ratio['p10']:.1f} to {ratio['p90']:.1f}",
                f"{figures['ratio_with_building']['median']:.0f}", f"{figures['milliseconds']['median']:.0f}",
                *(f"{parts[part]:.1f}" for part in ("search", "set_up", "solve", "judge")),
                f"{figures['search_milliseconds']['median']:.1f}", f"{figures['ipopt_milliseconds']['median']:.0f}",
                f"{figures['ipopt_set_up_milliseconds']:.0f}", f"{figures['steps']:.0f}", f"{figures['rounds']:.0f}",
                _percent(figures["success"]),
            )
        )  # fmt: skip
    note = (
        "Scene in memory to certified plan, default settings, in a warm process, against hybrid A* and IPOPT (17) at "
        "the knots of that plan. Parts in ms."
    )
    return ["## Whole plans", "", note, "", *table(header, rows)]


def _scaling(scaling: Mapping[str, Any]) -> list[str]:
    lines = ["## Scaling, scene vertical", ""]
    for what in ("steps", "obstacles", "vertices"):
        header = [what, "ms", "iterations", "us an iteration", "IPOPT ms", "ratio", "MB", "solved"]
        rows = []
        for row in scaling[what]["rows"]:
            cells = [str(row[what]), f"{1e3 * row['seconds']:.2f}", str(row["iterations"])]
            cells += [f"{1e6 * row['seconds_per_iteration']:.1f}"]
            cells += [f"{1e3 * row['ipopt_seconds']:.0f}" if "ipopt_seconds" in row else "-"]
            cells += [f"{row['ratio']:.0f}" if "ratio" in row else "-"]
            cells += ["-" if row["megabytes"] is None else f"{row['megabytes']:.2f}", "yes" if row["success"] else "no"]
            cells += [f"{1e3 * row['plan_seconds']:.0f}"] if what == "obstacles" else []
            rows.append(cells)
        slopes = scaling[what]["slopes"]
        told = [f"{name.replace('_', ' ')} {_number(value)}" for name, value in slopes.items()]
        lines += [*table([*header, *(["whole plan ms"] if what == "obstacles" else [])], rows), ""]
        lines += [f"Slopes over {what} on logarithmic scales (1 is linear): {', '.join(told)}.", ""]
    growth = scaling["obstacles"]["plan_growth"]
    lines.append(
        f"A whole plan takes {growth['times']:.2f} times as long with {growth['to']} obstacles as with "
        f"{growth['from']}. The solves of that table have every obstacle in the program on every interval; MB is the "
        "memory of one solver."
    )
    return lines


def _throughput(result: Mapping[str, Any]) -> list[str]:
    batch = result["batch"]
    lines = [
        "## Batch, warm re-solve, best of many",
        "",
        f"`solve_many` on one thread: {batch['solves_per_second']:.0f} solves a second ({batch['problems']} starts of "
        f"vertical, {_percent(batch['success'])} solved).",
        "",
    ]
    rows: list[tuple[str, ...]] = []
    for scene, row in result["warm_plans"].items():
        if "ratio" in row:
            spread = f"{row['ratio']['p10']:.1f} to {row['ratio']['p90']:.1f}"
            rows.append((scene, f"{row['ratio']['median']:.1f}", spread, _percent(row["used"]), str(row["cases"])))
    lines += table(("warm plan", "ratio", "10 % to 90 %", "from the last plan", "cases"), rows)
    lines.append("")
    rows = []
    for scene, row in result["warm"].items():
        if "ratio" in row:
            spread = f"{row['ratio']['p10']:.1f} to {row['ratio']['p90']:.1f}"
            counts = f"{row['iterations_cold']:.0f} and {row['iterations_warm']:.0f}"
            rows.append(
                (scene, f"{row['ratio']['median']:.1f}", spread, counts, _percent(row["success"]), str(row["cases"]))
            )
    lines += table(("warm re-solve", "ratio", "10 % to 90 %", "iterations cold and warm", "solved", "cases"), rows)
    rows = [
        (
            scene, f"{row['objective']:g}", f"{row['found']} of {row['runs']}", f"{row['milliseconds']['median']:.0f}",
            f"{row['ipopt_milliseconds']:.0f}", f"{row['ratio']:.1f}",
        )
        for scene, row in result["best_of_many"].items()
    ]  # fmt: skip
    return [*lines, "", *table(("best of many", "J", "found", "ms", "one IPOPT solve, ms", "ratio"), rows)]


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %"


def _number(value: float | None) -> str:
    if value is None:
        return "-"
    return f"{value:.0f}" if abs(value) >= 20 else f"{value:.2f}"
