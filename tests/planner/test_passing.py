"""Bisection for the largest value that passes, against thresholds that are known."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tightspot.planner import Deeper, Passing
from tightspot.planner.passing import Verdict, largest


@given(threshold=st.floats(0.3, 2.0), now=st.floats(2.001, 3.0), accuracy=st.sampled_from([0.002, 0.01]))
def test_the_bracket_holds_the_threshold(threshold: float, now: float, accuracy: float) -> None:
    tried = []

    def attempt(value: float) -> Verdict:
        tried.append(value)
        return "passes" if value <= threshold else "fails"

    found = largest("width", now, 0.25, accuracy, attempt)
    assert found.passes is not None
    assert found.passes <= threshold < found.fails
    assert found.accuracy is not None
    assert found.accuracy <= accuracy + 1e-9
    assert found.passes in tried
    assert found.fails in tried or found.fails == now
    assert found.attempts == len(tried) <= 14
    assert found.in_time
    assert not found.is_proof


@given(threshold=st.floats(0.3, 1.9), slack=st.floats(0.0, 0.1))
def test_a_proved_bound_is_used_and_told(threshold: float, slack: float) -> None:
    bound = round(threshold + slack, 3)
    found = largest("width", 2.0, 0.2, 0.01, lambda value: "passes" if value <= threshold else "impossible", bound)
    assert found.passes is not None
    assert found.passes <= threshold
    assert found.fails <= bound
    assert found.is_proof
    assert found.fails - found.passes <= 0.0105
    if slack == 0:
        assert found.attempts == 1, "just below a proved bound is tried first"


def test_nothing_passes() -> None:
    found = largest("margin", 0.05, 0.0, 0.005, lambda value: "fails")
    assert (found.passes, found.fails, found.attempts, found.in_time) == (None, 0.0, 1, True)
    assert str(found) == "No plan was found even with a margin of 0 m (0.05 m demanded)."
    closed = largest("margin", 0.05, 0.0, 0.005, lambda value: "passes", impossible=0.0)
    assert (closed.passes, closed.attempts, closed.is_proof) == (None, 0, True)
    assert str(closed) == "No plan can exist even with a margin of 0 m (0.05 m demanded)."


def test_time_that_runs_out_is_told() -> None:
    verdicts = iter(["passes", "fails", "no time"])
    found = largest("width", 2.0, 1.0, 0.01, lambda value: next(verdicts))  # type: ignore[return-value]
    assert (found.passes, found.fails, found.in_time) == (1.0, 1.5, False)
    assert "time ran out before this was closer" in str(found)
    nothing = largest("width", 2.0, 1.0, 0.01, lambda value: "no time")
    assert (nothing.passes, nothing.fails, nothing.attempts) == (None, 2.0, 0)
    assert str(nothing).startswith("Time ran out before anything less than a body 2.000 m wide was found to pass")


def test_sentences_name_both_ends_of_the_bracket() -> None:
    width = Passing("width", 2.097, 2.03, 2.05, False, 1.049, 5, True)
    assert str(width) == (
        "It passes with a body 2.030 m wide (2.097 m now); with a body 2.050 m wide no plan was found."
    )
    margin = Passing("margin", 0.05, 0.022, 0.027, True, 0.0, 1, True)
    assert str(margin) == (
        "It passes with a margin of 0.022 m (0.05 m demanded); with a margin of 0.027 m no plan can exist."
    )
    deeper = Deeper(margin=margin, width=width)
    assert deeper.sentences == [str(margin), str(width)]
    assert deeper.to_dict()["largest_width"]["passes"] == 2.03
    other = Deeper(other_start="linear", changes=("the solver ipopt with its usual limits",))
    assert other.sentences == [
        "A certified plan of this very scene was found from the guess linear, "
        "with the solver ipopt with its usual limits."
    ]
    assert Deeper(cured=False).sentences[0].startswith("Moved so, no plan was found either")


@pytest.mark.parametrize("verdict", ["fails", "impossible"])
def test_least_is_tried_before_giving_up(verdict: Verdict) -> None:
    tried = []

    def attempt(value: float) -> Verdict:
        tried.append(value)
        return verdict

    largest("width", 2.0, 1.0, 0.01, attempt, impossible=1.8)
    assert tried == [1.79, 1.0]
