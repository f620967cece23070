"""What the rows of a campaign add up to, as plain data."""

from __future__ import annotations

import statistics
from collections import Counter
from collections.abc import Callable, Iterable
from typing import Any

RARE = 0.01
"""False alarms are rare if they are less than this part of the questions."""

Row = dict[str, Any]
_EDGES = (1.06, 1.15, 1.3, 1.6)


def summarise(rows: list[Row]) -> dict[str, Any]:
    """Counts, false alarms, times and rounds; ``passed`` is whether no plan was refuted and false alarms are rare."""
    plans = [row for row in rows if row["outcome"] == "plan"]
    failed = [row for row in rows if row["outcome"] != "plan"]
    refuted = [row for row in plans if row["problems"] or not row["upheld"]]
    alarms = false_alarms(rows)
    rare = all(part["false"] < RARE * max(1, part["asked"]) for part in alarms.values())
    return {
        "scenes": len(rows),
        "plans": len(plans),
        "refuted": [{"name": row["name"], "problems": row["problems"], "upheld": row["upheld"]} for row in refuted],
        "false_alarms": alarms,
        "failures": dict(Counter(row["outcome"] for row in failed)),
        "by_family": _groups(rows, lambda row: row["family"]),
        "by_tightness": _groups(rows, _tightness),
        "by_vehicle": _groups(rows, lambda row: row["vehicle"]),
        "seconds": _distribution([row["processor_seconds"] for row in plans]),
        "seconds_of_failures": _distribution(
            [row["processor_seconds"] for row in failed if "processor_seconds" in row]
        ),
        "rounds": dict(sorted(Counter(row["rounds"] for row in plans).items())),
        "proved_below_replay": _distribution(
            [row["replay"]["clearance"] - row["certified_clearance"] for row in plans if row["replay"]["clearance"]]
        ),
        "failed_scenes": [
            {key: row.get(key) for key in ("name", "kind", "ratio", "vehicle", "margin", "outcome", "reason")}
            for row in failed
        ],
        "passed": not refuted and rare,
    }


def false_alarms(rows: Iterable[Row]) -> dict[str, dict[str, Any]]:
    """Refusals in the rounds of planning, and trajectories judged again; each with the false ones' scenes.

    What the planner asked twice, from two guesses that led to the same trajectory, counts once.
    """
    refusals, again = [], []
    for row in rows:
        for judged in {str(question): question for question in row["judged"]}.values():
            refusals += [(row["name"], refusal["false_alarm"]) for refusal in judged["refusals"]]
            if judged["again"] is not None:
                again.append((row["name"], not judged["again"]["certified"]))
    parts = {"refusals": refusals, "judged_again": again}
    return {
        key: {
            "asked": len(part),
            "false": sum(wrong for _, wrong in part),
            "scenes": sorted({name for name, wrong in part if wrong}),
        }
        for key, part in parts.items()
    }


def _groups(rows: list[Row], key: Callable[[Row], str]) -> dict[str, dict[str, Any]]:
    found: dict[str, list[Row]] = {}
    for row in rows:
        found.setdefault(key(row), []).append(row)
    return {
        name: {
            "scenes": len(group),
            "outcomes": dict(Counter(row["outcome"] for row in group).most_common()),
            "seconds": _distribution([row["processor_seconds"] for row in group if row["outcome"] == "plan"]),
        }
        for name, group in sorted(found.items())
    }


def _tightness(row: Row) -> str:
    """Bin of the ratio; parallel slots by themselves, for theirs is one of lengths."""
    ratio = row["ratio"]
    if "parallel" in row["kind"]:
        return "parallel, length up to 1.3" if ratio <= 1.3 else "parallel, length up to 1.6"
    if ratio is None:
        return "yard"
    for edge in _EDGES:
        if ratio <= edge:
            return f"width up to {edge:g}"
    return f"width above {_EDGES[-1]:g}"


def _distribution(values: list[float]) -> dict[str, float] | None:
    if not values:
        return None
    ordered = sorted(values)
    return {
        "least": ordered[0],
        "median": statistics.median(ordered),
        "p90": ordered[min(len(ordered) - 1, int(0.9 * len(ordered)))],
        "most": ordered[-1],
    }
