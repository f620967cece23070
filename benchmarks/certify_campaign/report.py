"""A campaign's summary as a Markdown page."""

from __future__ import annotations

from typing import Any

from benchmarks.certify_campaign.judged import BESIDE, SLACK


def as_markdown(summary: dict[str, Any], where: dict[str, Any]) -> str:
    """The page."""
    lines = ["# Random scenes", "", "Written by `python -m benchmarks.certify_campaign`.", ""]
    lines.append("- " + ", ".join(f"{key} {value}" for key, value in where.items()))
    lines.append("- default settings; seconds are processor time of planning, all rounds and judgements included")
    lines.append("- the replay: every plan file's inputs integrated in steps of 1 ms, every frame against every")
    lines.append("  obstacle and the workspace with shapely (`benchmarks/replay.py`)")
    lines += ["", "## Verdict", "", *_verdict(summary), "", "## Plans", ""]
    for title, key in (("family", "by_family"), ("tightness", "by_tightness"), ("vehicle", "by_vehicle")):
        lines += [*_table(title, summary[key]), ""]
    lines += [f"Rounds of the plans: {_counts(summary['rounds'])}.", ""]
    lines += [f"Seconds of the plans: {_spread(summary['seconds'])}; of the failures: ", ""]
    lines[-2] += f"{_spread(summary['seconds_of_failures'])}."
    lines += ["## Scenes without a plan", "", f"By kind: {_counts(summary['failures'])}.", ""]
    lines += [_failure(row) for row in summary["failed_scenes"]] or ["None."]
    return "\n".join(lines) + "\n"


def _verdict(summary: dict[str, Any]) -> list[str]:
    refuted, alarms = summary["refuted"], summary["false_alarms"]
    lines = [f"- {summary['scenes']} scenes, {summary['plans']} plans"]
    lines.append(f"- plans refuted by the replay or by `tightspot verify`: {len(refuted)}")
    lines += [f"  - {row['name']}: {'; '.join(row['problems']) or 'not upheld'}" for row in refuted]
    asked = (
        ("refusals", f"of the judge's refusals for want of room, those with {1000 * SLACK:g} mm more than demanded"),
        (
            "judged_again",
            f"of trajectories judged again at {1000 * BESIDE:g} mm below the replay's clearance, those refused",
        ),
    )
    for key, words in asked:
        part = alarms[key]
        scenes = f" ({', '.join(part['scenes'])})" if part["scenes"] else ""
        lines.append(f"- false alarms, {words}: {part['false']} of {part['asked']}{scenes}")
    below = summary["proved_below_replay"]
    if below:
        lines.append(
            f"- the replay's clearance exceeds the proved one by {1000 * below['median']:.2f} mm (median), "
            f"{1000 * below['least']:.2f} to {1000 * below['most']:.2f} mm"
        )
    return lines


def _table(title: str, groups: dict[str, Any]) -> list[str]:
    lines = [f"| {title} | scenes | plans | failures | median s | most s |", "|---|---|---|---|---|---|"]
    for name, group in groups.items():
        failures = {key: value for key, value in group["outcomes"].items() if key != "plan"}
        seconds = group["seconds"]
        times = [f"{seconds[key]:.1f}" if seconds else "-" for key in ("median", "most")]
        cells = [name, str(group["scenes"]), str(group["outcomes"].get("plan", 0)), _counts(failures), *times]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def _counts(counts: dict[Any, int]) -> str:
    return ", ".join(f"{key}: {value}" for key, value in counts.items()) or "-"


def _spread(values: dict[str, float] | None) -> str:
    if values is None:
        return "-"
    return f"median {values['median']:.1f}, 90 % below {values['p90']:.1f}, most {values['most']:.1f}"


def _failure(row: dict[str, Any]) -> str:
    ratio = "-" if row["ratio"] is None else f"{row['ratio']:.3f}"
    return (
        f"- `{row['name']}` ({row['kind']}; {row['vehicle']}, ratio {ratio}, margin {row['margin']:g} m): "
        f"{row['outcome']}: {row['reason']}"
    )
