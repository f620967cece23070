"""The figures that one looks at first: what each is, what is wanted of it, and where in the result it comes from."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

ASKED = {
    "solve_ratio": ("solve, energy and time (r = 0.01), against IPOPT (17)", ">= 100"),
    "solve_ratio_time_optimal": ("solve, time-optimal (r = 1), against IPOPT (17)", ">= 100"),
    "success": ("solved before any fall-back, r = 0.01", ">= 0.97"),
    "success_ipopt": ("the same by IPOPT (17)", ""),
    "success_time_optimal": ("solved before any fall-back, r = 1", ">= 0.97"),
    "success_ipopt_time_optimal": ("the same by IPOPT (17)", ""),
    "near_best": ("J within 1 % of the best known, r = 0.01", ">= IPOPT's"),
    "near_best_ipopt": ("the same by IPOPT (17)", ""),
    "near_best_time_optimal": ("J within 1 % of the best known, r = 1", ">= IPOPT's"),
    "near_best_ipopt_time_optimal": ("the same by IPOPT (17)", ""),
    "largest_residual": ("largest residual of all solutions, by the functions IPOPT is given", "<= 1e-6"),
    "straight_line_ratio": ("solve from straight-line guesses, against IPOPT (17)", ">= 10"),
    "straight_line_success": ("solved from straight-line guesses", ">= 0.9"),
    "infeasible_ratio": ("infeasible programs: IPOPT (17) until it gives up, over ours", ""),
    "infeasible_told": ("infeasible programs that end as infeasible", ""),
    "plan_ratio": ("hybrid A* + IPOPT (17) on the certified mesh, over scene in memory to certified plan", ">= 20"),
    "plan_ratio_with_building": ("the same, building the program of (17) counted", ">= 20"),
    "search_ratio": ("IPOPT (17) on the certified mesh, over hybrid A*", ">= 3"),
    "success_plans": ("certified plans", ""),
    "solves_per_second": ("solves a second and core, scene vertical", ">= 1000"),
    "warm_ratio": ("plan made anew over warm plan, start moved by 10 cm and 2 degrees", ">= 3"),
    "warm_solve_ratio": ("solve from a new guess over warm re-solve, the same move", ""),
    "slope_steps": ("slope of time an iteration over steps (1 is linear)", "0.8 to 1.2"),
    "slope_steps_solve": ("slope of the time of a whole solve over steps", "0.8 to 1.2"),
    "slope_obstacles": ("slope of time an iteration over obstacles in the program", "0.8 to 1.2"),
    "plan_growth_obstacles": ("whole plan, most obstacles over ten", "< 2"),
    "plan_memory_growth_obstacles": ("memory of a whole plan, most obstacles over ten", "< 2"),
}
"""Key to what it is and what is wanted of it."""

ASKED_OF_SCENES = {
    "best_of_many_found": ("best known optimum of {} found by the best of many", ">= 0.95"),
    "best_of_many_ratio": ("one IPOPT (17) solve over the best of many, {}", ">= 1"),
}
"""The same for figures that stand for each scene."""


def headline(result: Mapping[str, Any]) -> dict[str, Any]:
    """Each figure of :data:`ASKED` and :data:`ASKED_OF_SCENES`; ``None`` where no case has one."""
    main, fast = (result["solves"][name]["all"] for name in ("energy and time", "time-optimal"))
    lines, plans, scaling = result["straight_lines"]["all"], result["plans"]["all"], result["scaling"]
    impossible = result["infeasible"]["all"]
    residuals = [found["largest_residual"] for found in (main, fast, lines) if found["largest_residual"] is not None]
    figures = {
        "solve_ratio": _median(main),
        "solve_ratio_time_optimal": _median(fast),
        "plan_ratio": _median(plans),
        "plan_ratio_with_building": _median(plans, "ratio_with_building"),
        "search_ratio": _median(plans, "search_ratio"),
        "success": main["success"],
        "success_ipopt": main["ipopt_success"],
        "success_time_optimal": fast["success"],
        "success_ipopt_time_optimal": fast["ipopt_success"],
        "success_plans": plans["success"],
        "near_best": main["near_best"],
        "near_best_ipopt": main["ipopt_near_best"],
        "near_best_time_optimal": fast["near_best"],
        "near_best_ipopt_time_optimal": fast["ipopt_near_best"],
        "largest_residual": max(residuals, default=None),
        "straight_line_ratio": _median(lines),
        "straight_line_success": lines["success"],
        "infeasible_ratio": _median(impossible),
        "infeasible_told": impossible["statuses"].get("INFEASIBLE", 0) / impossible["cases"],
        "solves_per_second": result["batch"]["solves_per_second"],
        "warm_ratio": _of_scenes(result["warm_plans"]),
        "warm_solve_ratio": _of_scenes(result["warm"]),
        "slope_steps": scaling["steps"]["slopes"]["seconds_per_iteration"],
        "slope_steps_solve": scaling["steps"]["slopes"]["seconds"],
        "slope_obstacles": scaling["obstacles"]["slopes"]["seconds_per_iteration"],
        "plan_growth_obstacles": scaling["obstacles"]["plan_growth"]["times"],
        "plan_memory_growth_obstacles": scaling["obstacles"]["plan_growth"]["times_memory"],
    }
    many = result["best_of_many"]
    return figures | {
        "best_of_many_found": {scene: row["found"] / row["runs"] for scene, row in many.items()},
        "best_of_many_ratio": {scene: row["ratio"] for scene, row in many.items()},
    }


def _median(figures: Mapping[str, Any], name: str = "ratio") -> float | None:
    """Of the ratios; ``None`` if there is no case to take one of."""
    return float(figures[name]["median"]) if figures.get(name) else None


def _of_scenes(found: Mapping[str, Mapping[str, Any]]) -> float | None:
    """The median of the scenes' medians."""
    medians = [figures["ratio"]["median"] for figures in found.values() if "ratio" in figures]
    return float(np.median(medians)) if medians else None
