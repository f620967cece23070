"""The statements about the paper's claims follow from the rows, whatever the rows are."""

import pytest

from tightspot.campaigns import claims
from tightspot.campaigns.claims import reached, time_ratio
from tightspot.campaigns.table import SIZES

GUESSES = ("simplified", "hybrid-astar")


def claim(rows, beginning):
    return next(found for found in claims(rows) if found.paper.startswith(beginning))


def test_ratios_are_geometric_means_over_common_cases(make_row):
    rows = [
        make_row(method="17", seconds=0.1),
        make_row(method="19", seconds=0.2),
        make_row(method="17", guess="simplified", seconds=0.1),
        make_row(method="19", guess="simplified", seconds=0.8),
        make_row(method="19", guess="collision-free", seconds=100.0),
        make_row(method="17", scene="parallel", seconds=1.0),
        make_row(method="19", scene="parallel", seconds=9.0, status="INFEASIBLE"),
    ]
    ratio, cases = time_ratio(rows, "19", "17")
    assert ratio == pytest.approx(4.0)
    assert cases == 2
    assert time_ratio(rows, "18", "17") is None


@pytest.mark.parametrize(("seconds", "holds"), [(0.2, True), (0.05, False)])
def test_speed_is_what_the_rows_say(make_row, seconds, holds):
    rows = [make_row(method="17"), make_row(method="19-single", seconds=seconds)]
    found = claim(rows, "(17) is faster than the duals with one copy")
    assert found.holds is holds
    assert f"{seconds / 0.1:.2f} times as long (1 cases)" in found.here
    assert claim(rows, "(17) is faster than the duals with four copies").holds is None


def test_sizes_are_compared_with_those_of_the_programs(make_row):
    good = [make_row(method=key, CN=cn, VN=vn) for key, (cn, vn) in SIZES.items()]
    assert claim(good, "CN and VN").holds is True
    bad = [*good[1:], make_row(method="17", CN=1166, VN=267)]
    assert claim(bad, "CN and VN").holds is False
    assert "1166 and 267" in claim(bad, "CN and VN").here


def test_collisions_are_counted(make_row):
    rows = [make_row(), make_row(guess="simplified", certified=False, penetration=0.55)]
    found = claim(rows, "the trajectories are collision-free")
    assert found.holds is False
    assert "1 of 2 solutions collide between their samples, by up to 0.55 m" in found.here
    assert claim(rows[:1], "the trajectories are collision-free").holds is True


def test_which_guess_finds_which_optimum(make_row):
    rows = [make_row("parallel", "17", "simplified", objective=1.7)]
    rows += [make_row("parallel", "17", guess, objective=1.2212) for guess in ("collision-free", "hybrid-astar")]
    rows.append(make_row("parallel", "16", "simplified", status="INFEASIBLE", objective=None))
    found = claim(rows, "parallel: guesses that see")
    assert found.holds is True
    assert "simplified: J 1.700, 1 not solved" in found.here
    assert claim(rows, "parallel: the best optimum").holds is True
    better = [*rows, make_row("parallel", "19", "hybrid-astar", objective=1.162)]
    assert claim(better, "parallel: the best optimum").holds is False


def test_no_rows_tell_nothing():
    assert {found.holds for found in claims([])} == {None}


def test_known_optima_need_objective_and_time(make_row):
    right = make_row("parallel", objective=1.2211, final_time=93.99)
    late = make_row("parallel", guess="simplified", objective=1.2211, final_time=97.0)
    other = make_row("vertical", objective=1.2211, final_time=93.99)
    found = {known.printed: rows for known, rows in reached([right, late, other]) if known.scene == "parallel"}
    assert found[1.221] == [right]
    assert found[1.344] == []


@pytest.mark.parametrize(
    ("values", "holds"), [([0.856, 0.8561], True), ([0.856, 0.87], False), ([22.75, 22.75], False)]
)
def test_the_oblique_optimum_is_one_and_the_paper_s(make_row, values, holds):
    rows = [make_row("oblique", guess=guess, objective=J) for guess, J in zip(GUESSES, values, strict=True)]
    assert claim(rows, "oblique: every formulation").holds is holds
