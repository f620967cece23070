"""Many problems at once: each as if it were alone."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from tests.solvers.test_stagewise_robustness import problem

from tightspot.errors import InputError
from tightspot.solvers import SolveStatus, Stagewise, solve_many

EXACT = ("x", "g", "lam_x", "lam_g", "log")


def _mixture():
    boxes = [(4, 7, -6, -1.5 - 0.1 * i) for i in range(3)]
    return [*(problem(box) for box in boxes), problem(), *(problem(box, steps=7) for box in boxes)]


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_each_report_is_that_of_the_problem_alone(threads):
    given = _mixture()
    for one, report in zip(given, solve_many(given, threads=threads), strict=True):
        alone = Stagewise().solve_stages(one)
        assert report.problem is one
        assert (report.status, report.iterations, report.attempts) == (alone.status, alone.iterations, alone.attempts)
        assert report.objective == alone.objective
        assert report.violation == alone.violation
        assert report.worst == alone.worst
        for name in EXACT:
            np.testing.assert_array_equal(getattr(report, name), getattr(alone, name))


def test_a_problem_that_cannot_be_used_spoils_no_other():
    good = problem((4, 7, -6, -1.5))
    bad = [
        good.replaced(widths=good.widths[:-1]),
        good.replaced(lines=good.lines[:-1]),
        good.replaced(model="boat"),
        good.replaced(part_vertices=np.full_like(good.part_vertices, np.nan)),
    ]
    reports = solve_many([good, *bad, good], threads=2)
    assert reports[0].status.success
    np.testing.assert_array_equal(reports[0].x, reports[-1].x)
    for one, report in zip(bad, reports[1:-1], strict=True):
        assert report.status is SolveStatus.FAILED
        assert report.problem is one
        assert report.note.startswith("The problem cannot be solved: ")
        assert report.x.size == 0
        assert report.to_dict()["status"] == "FAILED"


def test_none_and_wrong_arguments():
    assert solve_many([]) == []
    given = [problem()]
    for wrong in (
        {"threads": 0},
        {"threads": 1.5},
        {"threads": True},
        {"time_limit": 0.0},
        {"time_limit": float("nan")},
    ):
        with pytest.raises(InputError, match=next(iter(wrong))):
            solve_many(given, **wrong)
    with pytest.raises(InputError, match=r"problems\[1\]"):
        solve_many([given[0], "a problem"])


def test_what_the_time_limit_leaves_out_says_so():
    given = [problem((4, 7, -6, -1.5))] * 300
    reports = solve_many(given, time_limit=1e-9)
    assert [report.status for report in reports] == [SolveStatus.TIME_LIMIT] * 300
    assert all(report.iterations == 0 and report.violation > 0 for report in reports)


def test_other_starts_are_tried_for_those_that_need_them():
    rough, hasty = problem((4, 7, -1, 1)), Stagewise(max_iterations=30)
    alone = hasty.solve_stages(rough)
    together = solve_many([problem(), rough], threads=2, solver=hasty)[1]
    assert len(alone.attempts) > 1
    assert together.attempts == alone.attempts
    np.testing.assert_array_equal(together.x, alone.x)
    only = solve_many([rough], solver=replace(hasty, robust=False))[0]
    assert len(only.attempts) == 1


def test_reports_survive_pickling_before_and_after_their_vectors_were_asked_for():
    report = Stagewise().solve_stages(problem((4, 7, -6, -1.5)))
    before = pickle.loads(pickle.dumps(report))
    for name in (*EXACT, "worst"):
        np.testing.assert_array_equal(getattr(before, name), getattr(report, name))
    after = pickle.loads(pickle.dumps(report))
    np.testing.assert_array_equal(after.x, report.x)
    assert after.to_dict() == report.to_dict()
    assert "StageReport(" in repr(report)
    with pytest.raises(AttributeError, match="y"):
        _ = report.y
