"""The rows of the paper's table that the recovered settings reproduce, each by some formulation and guess."""

from functools import cache

import pytest

from tightspot.campaigns import paper_settings
from tightspot.campaigns.claims import SAME
from tightspot.campaigns.paper import solve_case
from tightspot.campaigns.solve import Bench, Case
from tightspot.campaigns.table import BETTER, KNOWN, PRINTED_FORM

LEADS_TO = {
    ("oblique", 0.8561): [("17", "hybrid-astar")],
    ("vertical", 1.0117): [("19-single", "start 7"), ("17", "start 11"), ("17", "start 1")],
    ("parallel", 1.2208): [("17", "collision-free"), ("19-single", "start 1"), ("19-single", "start 3")],
    ("parallel", 1.162): [("19-single", "start 0"), ("17", "hybrid-astar")],
}
"""(scene, J) to methods and guesses of which one at least ends there. In which optimum a guess ends is a matter of
rounding: the other rows are in benchmarks/results/paper, found by many starts."""


@cache
def bench():
    return Bench(paper_settings(), runs=1, time_limit=30.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    "known",
    [known for known in (*KNOWN, *BETTER) if (known.scene, known.objective) in LEADS_TO],
    ids=lambda known: f"{known.scene} {known.objective:g}",
)
def test_the_optimum_is_reached_within_two_thousandths(known):
    found = []
    for method, guess in LEADS_TO[known.scene, known.objective]:
        row = solve_case(bench(), Case(known.scene, method, guess))
        found.append((row.status, row.objective))
        if row.status == "SOLVED" and row.objective == pytest.approx(known.objective, rel=SAME):
            break
    else:
        pytest.fail(f"none of them ends there: {found}")
    assert row.final_time == pytest.approx(known.final_time, rel=SAME)
    if known.effort:
        assert row.effort == pytest.approx(known.effort, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("known", PRINTED_FORM, ids=lambda known: known.scene)
def test_the_printed_settings_give_other_optima_than_the_paper_s(known):
    bench = Bench(paper_settings("printed"), runs=1, time_limit=30.0)
    row = solve_case(bench, Case(known.scene, "17", "hybrid-astar"))
    assert row.status == "SOLVED"
    assert row.objective >= (1 - SAME) * known.objective, "which optimum it ends in is a matter of rounding"
    assert row.objective > 10 * row.paper_objective
