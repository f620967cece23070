"""The report of the speed benchmark, as Markdown. Every number comes from the result."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from tightspot.campaigns.speed.headline import ASKED, ASKED_OF_SCENES
from tightspot.campaigns.speed.plans import PARTS
from tightspot.campaigns.speed.solves import GUESSES


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
    parts += ["", *_infeasible(result["infeasible"])]
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
        f"- {plan['starts']} starts a scene for solves, {plan['straight']} of them from straight lines, too; "
        f"{plan['plans']} for plans; {plan['infeasible']} made infeasible; seed {plan['seed']}; "
        f"{result['seconds']:.0f} s in all",
    ]


def _headline(result: Mapping[str, Any]) -> list[str]:
    rows = [(what, _number(result[key]), asked or "-") for key, (what, asked) in ASKED.items()]
    for key, (what, asked) in ASKED_OF_SCENES.items():
        rows += [(what.format(scene), _number(value), asked) for scene, value in result[key].items()]
    note = "Ratios are medians over all starts of the cases that both sides solve, shares are of all cases."
    return ["## In one table", "", note, "", *table(("figure", "here", "wanted"), rows)]


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
                _spread(ratio, 0) if ratio else "-",
                f"{times['median']:.2f}", f"{figures['set_up_milliseconds']:.2f}",
                f"{figures['ipopt_milliseconds']['median']:.1f}", f"{figures['iterations']:.0f}",
                f"{figures['ipopt_iterations']:.0f}", _percent(figures["success"]),
                _percent(figures["ipopt_success"]), _percent(figures["near_best"]),
                _percent(figures["ipopt_near_best"]), "-" if residual is None else f"{residual:.0e}",
            )
        )  # fmt: skip
    note = (
        'Ratios of the cases that both solve. "Near the best": J within 1 % of the best known, which is the best of '
        f'both and of what {GUESSES} other guesses lead the stagewise solver to. "Largest residual" of our solutions: '
        "violation, stationarity and complementarity, computed with the functions IPOPT is given."
    )
    return [*table(header, rows), "", note]


def _infeasible(summaries: Mapping[str, Mapping[str, Any]]) -> list[str]:
    header = ["what is wrong", "cases", "ratio", "10 % to 90 %", "ms", "of it, from the given start", "IPOPT ms"]
    header += ["iterations", "IPOPT's", "ends as", "IPOPT's"]
    rows = []
    for kind, figures in summaries.items():
        rows.append(
            (
                kind, str(figures["cases"]), f"{figures['ratio']['median']:.0f}", _spread(figures["ratio"], 0),
                f"{figures['milliseconds']['median']:.1f}", f"{figures['first_milliseconds']['median']:.1f}",
                f"{figures['ipopt_milliseconds']['median']:.0f}", f"{figures['iterations']:.0f}",
                f"{figures['ipopt_iterations']:.0f}", _counts(figures["statuses"]),
                _counts(figures["ipopt_statuses"]),
            )
        )  # fmt: skip
    note = (
        "Programs that no trajectory satisfies, r = 0.01, from the hybrid A* guess of the scene as it was. Ours does "
        "not believe the first verdict and tries other starts before it says so; its ms and iterations are of all of "
        "them together. IPOPT solves once."
    )
    return ["## Infeasible programs", "", note, "", *table(header, rows)]


def _plans(summaries: Mapping[str, Mapping[str, Any]]) -> list[str]:
    header = ["scene", "ratio", "10 % to 90 %", "with building", "10 % to 90 %", "IPOPT over hybrid A*", "10 % to 90 %"]
    header += ["certified", "solved by IPOPT"]
    rows, times = [], []
    for scene, figures in summaries.items():
        if "ratio" not in figures:
            rows.append((scene, *["-"] * 6, _percent(figures["success"]), "-"))
            continue
        ratio, built, search = (figures[name] for name in ("ratio", "ratio_with_building", "search_ratio"))
        rows.append(
            (
                scene, f"{ratio['median']:.1f}", _spread(ratio), f"{built['median']:.0f}", _spread(built, 0),
                f"{search['median']:.0f}", _spread(search, 0), _percent(figures["success"]),
                _percent(figures["ipopt_success"]),
            )
        )  # fmt: skip
        times.append(
            (
                scene, f"{figures['milliseconds']['median']:.1f}", _spread(figures["milliseconds"]),
                *(f"{figures['parts_milliseconds'][part]:.1f}" for part in PARTS), f"{figures['rounds']:.0f}",
                f"{figures['steps']:.0f}", f"{figures['search_milliseconds']['median']:.1f}",
                f"{figures['ipopt_milliseconds']['median']:.0f}", f"{figures['ipopt_set_up_milliseconds']:.0f}",
            )
        )  # fmt: skip
    note = (
        "Scene in memory to certified plan, default settings, in a warm process, against hybrid A* and IPOPT (17) at "
        'the knots of that plan. The ratio leaves the building of IPOPT\'s program out; "with building" has it in, as '
        "our time has ours in: the program of a mesh that is found by planning cannot be built before."
    )
    split = "Medians, so that parts need not add up to the plan; of each plan they do. Parts in ms."
    columns = ["scene", "plan ms", "10 % to 90 %", *(part.replace("_", "-") for part in PARTS), "rounds", "steps"]
    columns += ["hybrid A* ms", "IPOPT ms", "its building ms"]
    return ["## Whole plans", "", note, "", *table(header, rows), "", split, "", *table(columns, times)]


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
            if what == "obstacles":
                cells += [f"{1e3 * row['plan_seconds']:.1f}", f"{row['plan_megabytes']:.2f}"]
                cells += [f"{1e3 * row['scene_seconds']:.1f}"]
            rows.append(cells)
        slopes = scaling[what]["slopes"]
        told = [f"{name.replace('_', ' ')} {_number(value)}" for name, value in slopes.items()]
        header += ["whole plan ms", "its MB", "scene ms"] if what == "obstacles" else []
        lines += [*table(header, rows), ""]
        lines += [f"Slopes over {what} on logarithmic scales (1 is linear): {', '.join(told)}.", ""]
    growth = scaling["obstacles"]["plan_growth"]
    lines.append(
        f"A whole plan takes {growth['times']:.2f} times as long with {growth['to']} obstacles as with "
        f"{growth['from']}, and {growth['times_memory']:.2f} times the memory. The solves of that table have every "
        "obstacle in the program on every interval; MB is the memory of one solver, that of a plan the largest that "
        "Python and NumPy have in use beyond the scene. Making the scene from its corners is told beside it."
    )
    return lines


def _throughput(result: Mapping[str, Any]) -> list[str]:
    batch = result["batch"]
    lines = [
        "## Batch, warm re-solve, best of many",
        "",
        f"`solve_many` on one thread: {batch['solves_per_second']:.0f} solves a second ({batch['problems']} starts of "
        f"vertical, {_percent(batch['success'])} solved); {batch['solves_per_second_built']:.0f} with every problem "
        f"built from scene and guess first; {batch['plans_per_second']:.0f} certified plans a second.",
        "",
    ]
    rows: list[tuple[str, ...]] = []
    for scene, row in result["warm_plans"].items():
        if "ratio" in row:
            spread = _spread(row["ratio"])
            rows.append((scene, f"{row['ratio']['median']:.1f}", spread, _percent(row["used"]), str(row["cases"])))
    lines += table(("warm plan", "ratio", "10 % to 90 %", "from the last plan", "cases"), rows)
    lines.append("")
    rows = []
    for scene, row in result["warm"].items():
        if "ratio" in row:
            spread = _spread(row["ratio"])
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


def _spread(quantiles: Mapping[str, float], digits: int = 1) -> str:
    """From the tenth to the ninetieth percentile."""
    return f"{quantiles['p10']:.{digits}f} to {quantiles['p90']:.{digits}f}"


def _counts(statuses: Mapping[str, int]) -> str:
    return ", ".join(f"{count} {status.lower().replace('_', ' ')}" for status, count in statuses.items())


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %"


def _number(value: float | None) -> str:
    if value is None:
        return "-"
    if 0 < abs(value) < 0.005:
        return f"{value:.0e}"
    return f"{value:.0f}" if abs(value) >= 20 else f"{value:.2f}"
